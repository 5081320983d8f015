//! The unknowns that several plateaus contain. The attitude of a rest is apart: one plateau alone contains it.
//!
//! A rest in an attitude of its own has three equations and two unknowns that no other plateau contains. The two are eliminated as
//! it comes ([`Elimination`]), and the remaining equation is one of the global unknowns. Time and memory for these do not depend on the
//! number of rests.

use std::collections::HashMap;

use nalgebra::{DMatrix, DVector};

use crate::linalg::factor::Factor;
use crate::linalg::least_squares::{Elimination, Own};
use crate::model::plateau::{Design, Readings};
use crate::model::{MeasurementModel, Prior};

/// The unknowns of a model that several plateaus contain.
#[derive(Debug)]
pub(super) struct Global {
    /// Their indices among all, rising: parameters, then influences.
    columns: Vec<usize>,
    /// The place of each unknown in the equations of a plateau: the global ones in their order, then those of its attitude.
    places: Vec<usize>,
    /// Priors of them, by their places.
    priors: Vec<Prior>,
    /// Number of influences.
    influences: usize,
    /// The unknowns of each rest in an attitude of its own, by its set point, and what is known of them beforehand.
    attitudes: HashMap<usize, (Vec<usize>, Vec<Prior>)>,
}

/// The attitude of a rest that has been eliminated from its equations, as it follows the global unknowns.
#[derive(Debug, Clone)]
pub(super) struct Attitude {
    /// Its unknowns among all.
    pub columns: Vec<usize>,
    elimination: Elimination,
    u: DMatrix<f64>,
    /// Lengths of its columns.
    lengths: Vec<f64>,
    /// Number of its unknowns that nothing is known of beforehand.
    pub unknown_before: usize,
}

/// Whitened equations of plateaus for the global unknowns, rotated into a triangle.
#[derive(Debug, Clone)]
pub(super) struct Gathered {
    factor: Factor,
    /// Squared lengths of the columns, in all equations that have come.
    squared_lengths: DVector<f64>,
    /// What was eliminated, in the order of the rests.
    attitudes: Vec<Attitude>,
}

/// The equations of a plateau for the global unknowns, three at most, by their places; and its attitude where it has its own.
#[derive(Debug, Clone)]
pub(super) struct PlateauEquations {
    readings: Readings,
    pub attitude: Option<Attitude>,
    squared_lengths: DVector<f64>,
}

impl Global {
    /// Those of a model.
    pub fn of(model: &MeasurementModel) -> Self {
        let (count, priors) = (model.experiment().set_points.len(), model.priors());
        let all = model.parameters().len() + model.influences().len();
        let of_rests = model.attitudes_of_single_rests(&(0..count).collect::<Vec<_>>(), priors);
        let mut is_global = vec![true; all];
        of_rests.iter().flat_map(|own| &own.columns).for_each(|&column| is_global[column] = false);
        let columns: Vec<usize> = (0..all).filter(|&column| is_global[column]).collect();
        let mut places = vec![0; all];
        columns.iter().enumerate().for_each(|(place, &column)| places[column] = place);
        for own in &of_rests {
            own.columns.iter().enumerate().for_each(|(k, &column)| places[column] = columns.len() + k);
        }
        let in_place =
            |prior: &Prior| is_global[prior.parameter].then(|| Prior { parameter: places[prior.parameter], ..*prior });
        let attitude = |Own { columns, rows }: Own| {
            let known = rows.iter().skip(3).map(|row| priors[row - 3 * count]).collect();
            (rows[0] / 3, (columns, known))
        };
        Self {
            priors: priors.iter().filter_map(in_place).collect(),
            influences: model.influences().len(),
            attitudes: of_rests.into_iter().map(attitude).collect(),
            columns,
            places,
        }
    }

    /// Number of them.
    pub fn len(&self) -> usize {
        self.columns.len()
    }

    /// Their indices among all unknowns, rising.
    pub fn columns(&self) -> &[usize] {
        &self.columns
    }

    /// Number of them that are influences, the last ones.
    pub fn influences(&self) -> usize {
        self.influences
    }

    /// Their part of all unknowns.
    pub fn part(&self, x: &DVector<f64>) -> DVector<f64> {
        x.select_rows(&self.columns)
    }

    /// What is known beforehand of the attitudes of rests.
    pub fn priors_of_attitudes(&self) -> impl Iterator<Item = &Prior> {
        self.attitudes.values().flat_map(|(_, known)| known)
    }

    /// The equations with those of what is known beforehand, at `y`.
    pub fn with_priors(&self, plateaus: Design, y: &DVector<f64>) -> Design {
        plateaus.with_priors(&self.priors, self.influences, y.as_slice())
    }

    /// Squared lengths of the columns of the priors.
    pub fn squared_lengths_of_priors(&self) -> DVector<f64> {
        let mut squares = DVector::zeros(self.len());
        self.priors.iter().for_each(|prior| squares[prior.parameter] += prior.standard_uncertainty.powi(-2));
        squares
    }

    /// The equations of a plateau, linearised at all unknowns `x`.
    pub fn equations_of(&self, set_point: usize, readings: &Readings, x: &[f64]) -> PlateauEquations {
        let columns: Vec<_> = readings.columns.iter().map(|&(column, d)| (self.places[column], d)).collect();
        let mut squared_lengths = DVector::zeros(self.len());
        for (place, derivative) in columns.iter().filter(|(place, _)| *place < self.len()) {
            squared_lengths[*place] = derivative.norm_squared();
        }
        let readings = Readings { columns, ..readings.clone() };
        let Some((own, known)) = self.attitudes.get(&set_point) else {
            return PlateauEquations { readings, attitude: None, squared_lengths };
        };
        let (readings, attitude) = self.eliminated(own, known, &readings, x);
        PlateauEquations { readings, attitude: Some(attitude), squared_lengths }
    }

    /// What remains of the readings of a rest when its attitude, the unknowns `columns`, is eliminated from them and what is known of it
    /// beforehand: one equation, or as many more as are known.
    fn eliminated(&self, columns: &[usize], known: &[Prior], readings: &Readings, x: &[f64]) -> (Readings, Attitude) {
        let (global, all, count) = (self.len(), self.len() + columns.len(), 3 + known.len());
        let (mut rows, mut misfit) = (DMatrix::zeros(count, all), DMatrix::zeros(count, 1));
        for (place, derivative) in &readings.columns {
            rows.fixed_view_mut::<3, 1>(0, *place).copy_from(derivative);
        }
        misfit.fixed_rows_mut::<3>(0).copy_from(&readings.misfit);
        for (row, prior) in (3..).zip(known) {
            rows[(row, self.places[prior.parameter])] = prior.standard_uncertainty.recip();
            misfit[row] = (prior.mean - x[prior.parameter]) / prior.standard_uncertainty;
        }
        let lengths = rows.columns_range(global..).column_iter().map(|column| column.norm()).collect();
        let own = Own { columns: (global..all).collect(), rows: (0..count).collect() };
        let (elimination, left) = Elimination::of(rows, &[own]);
        let rotated = elimination.rotated(misfit);
        let (left, misfit) = (left.resize_vertically(3, 0.0), rotated.rows_range(columns.len()..));
        let readings = Readings {
            columns: (0..global)
                .map(|place| (place, left.fixed_columns::<1>(place).fixed_rows::<3>(0).into()))
                .collect(),
            misfit: misfit.into_owned().resize_vertically(3, 0.0).fixed_view::<3, 1>(0, 0).into(),
            magnitude: readings.magnitude,
        };
        let u = rotated.rows_range(..columns.len()).into_owned();
        let unknown_before = columns.len().saturating_sub(known.len());
        (readings, Attitude { columns: columns.to_vec(), elimination, u, lengths, unknown_before })
    }
}

impl PlateauEquations {
    /// Writes the derivatives into three rows.
    pub fn fill(&self, rows: &mut DMatrix<f64>, first: usize) {
        for (place, derivative) in &self.readings.columns {
            rows.fixed_view_mut::<3, 1>(first, *place).copy_from(derivative);
        }
    }
}

impl Attitude {
    /// Its change from where the rest is linearised, for that of the global unknowns.
    pub fn change(&self, dy: &DVector<f64>) -> Vec<f64> {
        self.own(&self.u, DMatrix::from_columns(std::slice::from_ref(dy))).column(0).iter().copied().collect()
    }

    /// Lengths of the rows in which it follows the columns of `global`, its unknowns in units of one over the lengths of their columns.
    pub fn followed(&self, global: &DMatrix<f64>) -> Vec<f64> {
        let following = self.own(&DMatrix::zeros(self.columns.len(), global.ncols()), global.clone());
        following.row_iter().zip(&self.lengths).map(|(row, length)| row.norm() * length).collect()
    }

    /// Standard uncertainties where the global unknowns have the covariance `root root^T`.
    pub fn standard_uncertainties(&self, root: &DMatrix<f64>) -> Vec<f64> {
        let own = self.columns.len();
        let mut u = DMatrix::zeros(own, own + root.ncols());
        u.fill_with_identity();
        self.own(&u, root.clone().insert_columns(0, own, 0.0)).row_iter().map(|row| row.norm()).collect()
    }

    fn own(&self, u: &DMatrix<f64>, global: DMatrix<f64>) -> DMatrix<f64> {
        let count = global.nrows();
        self.elimination.completed(u, global).rows_range(count..).into_owned()
    }
}

impl Gathered {
    /// Nothing has come yet.
    pub fn none(global: &Global) -> Self {
        let count = global.len();
        Self { factor: Factor::new(count), squared_lengths: DVector::zeros(count), attitudes: Vec::new() }
    }

    /// Takes up the equations of a plateau.
    pub fn take(&mut self, plateau: PlateauEquations) {
        self.factor.update(&plateau.readings.columns, &plateau.readings.misfit);
        self.squared_lengths += plateau.squared_lengths;
        self.attitudes.extend(plateau.attitude);
    }

    /// What was eliminated, in the order of the rests.
    pub fn attitudes(&self) -> &[Attitude] {
        &self.attitudes
    }

    /// The equations, perhaps with those of a plateau more. A follower has no use for the magnitude of the readings.
    pub fn design(&self, newcomer: Option<&PlateauEquations>) -> Design {
        let (mut rows, mut misfit) = (self.factor.triangle(), self.factor.right_side());
        if let Some(plateau) = newcomer {
            let n = rows.nrows();
            rows = rows.resize_vertically(n + 3, 0.0);
            misfit = misfit.resize_vertically(n + 3, 0.0);
            plateau.fill(&mut rows, n);
            misfit.fixed_rows_mut::<3>(n).copy_from(&plateau.readings.misfit);
        }
        Design { rows, misfit, rest: self.factor.rest().sqrt(), magnitude: 0.0 }
    }

    /// Squared lengths of the columns in all equations, perhaps with those of a plateau more.
    pub fn squared_lengths(&self, newcomer: Option<&PlateauEquations>) -> DVector<f64> {
        let of_newcomer = newcomer.map(|plateau| &plateau.squared_lengths);
        of_newcomer.map_or_else(|| self.squared_lengths.clone(), |lengths| &self.squared_lengths + lengths)
    }
}
