//! The gain of a fit: how its estimates answer to a change of the readings.
//!
//! With the whitened design `W J = Q R` at the estimate, a change `dy` of the readings moves the estimates by
//! `K dy`, `K = R^-1 Q^T W`. `K` is applied by reflections and back substitution and never formed.

use nalgebra::{DMatrix, DVector};

use super::assembly::Assembly;
use super::data::Data;
use super::estimates::Fit;
use super::structure::Structure;
use crate::linalg::least_squares::LeastSquares;
use crate::model::whitening::Whitener;
use crate::model::{FitError, NULL_HOLD};

/// The factored design at the estimate of a fit.
#[derive(Debug, Clone)]
pub struct Gain {
    /// Three equations per observation, one per prior, one per null direction.
    equations: LeastSquares,
    whiteners: Vec<Whitener>,
    /// Whitened residuals of the observations and the priors.
    residuals: DVector<f64>,
}

impl Gain {
    /// Gain of the fit of `data`, whose design has that structure.
    pub(super) fn of(data: &Data, structure: &Structure, fit: &Fit) -> Result<Self, FitError> {
        let linearisations = data.linearised(fit.state());
        let design = Assembly::Batch.design(data, fit.state(), &linearisations)?;
        let pairs = data.observations().iter().zip(&linearisations);
        let whiteners = pairs.map(|(o, l)| Whitener::new(&o.into(), &l.speed_error)).collect::<Result<_, _>>()?;
        let null_weight = if fit.null_directions_held { 1.0 / NULL_HOLD } else { 0.0 };
        let (equations, _) = structure.equations(&design, &DVector::from_column_slice(fit.state()), null_weight);
        Ok(Self { equations, whiteners, residuals: design.misfit })
    }

    /// Changes of the estimates, `p x m` [units of the parameters], that `m` changes of the readings make,
    /// `3 n x m` [m/s^2], three rows per observation.
    pub fn apply(&self, readings: &DMatrix<f64>) -> DMatrix<f64> {
        self.equations.unknowns(&self.rotated(readings))
    }

    /// Changes of the estimates, `p x m`, that each of the `m` priors makes when it is off by one standard uncertainty.
    pub(crate) fn apply_priors(&self) -> DMatrix<f64> {
        let (data, all) = (3 * self.whiteners.len(), self.residuals.len());
        let mut priors = DMatrix::zeros(all, all - data);
        priors.rows_mut(data, all - data).fill_with_identity();
        self.equations.unknowns(&self.equations.rotated(priors))
    }

    /// The part of `m` changes of the readings, `3 n x m` [m/s^2], that no change of the unknowns can follow: whitened,
    /// in `rows - p` independent coordinates of unit variance.
    pub fn redundant(&self, readings: &DMatrix<f64>) -> DMatrix<f64> {
        self.rotated(readings).rows_range(self.equations.columns()..).into_owned()
    }

    /// The residuals in the same coordinates: their testable part.
    pub fn redundant_residuals(&self) -> DVector<f64> {
        self.equations.redundant(&self.residuals)
    }

    /// Whitened residuals, three per observation.
    pub(crate) fn whitened_residuals(&self) -> DVector<f64> {
        self.residuals.rows(0, 3 * self.whiteners.len()).into_owned()
    }

    /// The share of each whitened reading in its own fitted value and those of the others: `Q Q^T` of the orthonormal
    /// columns, `3 n x 3 n`. Its trace is the number of unknowns determined.
    pub(crate) fn hat(&self) -> DMatrix<f64> {
        let data = 3 * self.whiteners.len();
        let rotated = self.equations.rotated(DMatrix::identity(data, data));
        let q = rotated.rows_range(..self.equations.columns());
        q.transpose() * q
    }

    /// Whitened readings, three per observation.
    pub(crate) fn whitened(&self, readings: &DMatrix<f64>) -> DMatrix<f64> {
        let mut whitened = DMatrix::zeros(readings.nrows(), readings.ncols());
        for (n, whitener) in self.whiteners.iter().enumerate() {
            for (column, mut target) in readings.column_iter().zip(whitened.column_iter_mut()) {
                let change = column.fixed_rows::<3>(3 * n).into_owned();
                target.fixed_rows_mut::<3>(3 * n).copy_from(&whitener.apply(&change));
            }
        }
        whitened
    }

    /// `Q^T W` times changes of the readings.
    fn rotated(&self, readings: &DMatrix<f64>) -> DMatrix<f64> {
        self.equations.rotated(self.whitened(readings))
    }
}
