//! The gain of a fit: how its estimates answer to a change of the readings.
//!
//! With the whitened design `W J = Q R` at the estimate, a change `dy` of the readings moves the estimates by
//! `K dy`, `K = R^-1 Q^T W`. `K` is applied by reflections and back substitution and never formed.

use nalgebra::{DMatrix, DVector, DVectorView, Vector3};

use super::data::Data;
use super::estimates::Fit;
use super::structure::{Assembly, Hold, Structure};
use crate::linalg::least_squares::LeastSquares;
use crate::model::plateau::Whitener;
use crate::model::{FitError, Linearisation};

/// The factored design at the estimate of a fit.
#[derive(Debug, Clone)]
pub struct Gain {
    /// Three equations per observation, one per prior, per influence and per null direction.
    equations: LeastSquares,
    whiteners: Vec<Whitener>,
    /// The observations at the estimate.
    linearisations: Vec<Linearisation>,
    /// Rows of the observations in an orthonormal basis of the fitted columns, `3 n x (p + q)`.
    basis: DMatrix<f64>,
    parameters: usize,
    priors: usize,
    /// Whitened residuals of the observations, without what a linear step from the estimate would take up; of the priors and the influences.
    residuals: DVector<f64>,
}

impl Gain {
    /// Gain of the fit of `data`, whose design has that structure.
    pub(super) fn of(data: &Data, structure: &Structure, fit: &Fit) -> Result<Self, FitError> {
        let at = fit.unknowns();
        let linearisations = data.linearised(at);
        let design = Assembly::Batch.design(data, at, &linearisations)?;
        let pairs = data.observations().iter().zip(&linearisations);
        let whiteners = pairs.map(|(o, l)| Whitener::new(o, l)).collect::<Result<_, _>>()?;
        let hold = Hold { null: fit.null_directions_held, weak: false };
        let (equations, misfit) = structure.held.equations(&design, &DVector::from_column_slice(at), hold);
        let (parameters, priors) = (data.model().parameters().len(), data.model().priors().len());
        let basis = equations.basis(3 * data.observations().len());
        // A remaining step would look like a large part of a column that the unknowns almost reproduce.
        let step = equations.rotated(DMatrix::from_columns(&[misfit])).rows_range(..basis.ncols()).into_owned();
        let (mut residuals, followed) = (design.misfit, &basis * step);
        residuals.rows_range_mut(..followed.nrows()).axpy(-1.0, &followed.column(0), 1.0);
        Ok(Self { equations, whiteners, linearisations, basis, parameters, priors, residuals })
    }

    /// Changes of the estimates, `p x m` [units of the parameters], by `m` changes of one observation each: its index, and the
    /// change of its reading [m/s^2].
    pub fn apply(&self, changes: &[(usize, Vector3<f64>)]) -> DMatrix<f64> {
        let mut followed = DMatrix::zeros(self.basis.ncols(), changes.len());
        for ((n, change), mut column) in changes.iter().zip(followed.column_iter_mut()) {
            let rows = self.basis.rows(3 * n, 3);
            rows.tr_mul_to(&self.whiteners[*n].apply(change), &mut column);
        }
        self.parameters_of(&followed)
    }

    /// Changes of the estimates, `p x m`, that each of the `m` priors makes when it is off by one standard uncertainty.
    pub(crate) fn apply_priors(&self) -> DMatrix<f64> {
        self.apply_rows(3 * self.whiteners.len(), self.priors)
    }

    /// Changes of the estimates, `p x q`, that each influence makes when it is off by one standard uncertainty.
    pub(crate) fn apply_influences(&self) -> DMatrix<f64> {
        let first = 3 * self.whiteners.len() + self.priors;
        self.apply_rows(first, self.residuals.len() - first)
    }

    /// Those that one unit of `count` equations makes, from the row `first`.
    fn apply_rows(&self, first: usize, count: usize) -> DMatrix<f64> {
        let mut units = DMatrix::zeros(self.residuals.len(), count);
        units.rows_mut(first, count).fill_with_identity();
        self.parameters_of(&self.equations.rotated(units))
    }

    fn parameters_of(&self, rotated: &DMatrix<f64>) -> DMatrix<f64> {
        self.equations.unknowns(rotated).rows(0, self.parameters).into_owned()
    }

    /// The observations linearised at the estimate.
    pub(crate) fn linearisations(&self) -> &[Linearisation] {
        &self.linearisations
    }

    /// Whitened residuals, three per observation.
    pub(crate) fn whitened_residuals(&self) -> DVectorView<'_, f64> {
        self.residuals.rows(0, 3 * self.whiteners.len())
    }

    /// `Q`: the rows of the observations in an orthonormal basis of the fitted columns. The share of the readings in their own
    /// fitted values and those of others is `Q Q^T`; its trace is the number of unknowns determined.
    pub(crate) fn basis(&self) -> &DMatrix<f64> {
        &self.basis
    }

    /// How much of the unknowns the equations determine without those that hold null directions: the trace of `Q Q^T` over the others. With the rank
    /// of the design at `X = 0` and the influences taken from it, the combinations remain that second-order traces determine at the estimate.
    pub(crate) fn leverage(&self) -> f64 {
        self.equations.basis(self.residuals.len()).norm_squared()
    }

    /// Changes of the estimates, `p x m`, by changes `dy` of the readings with `Q^T W dy = followed`.
    pub(crate) fn shifts(&self, followed: &DMatrix<f64>) -> DMatrix<f64> {
        self.parameters_of(followed)
    }

    /// What whitens observation `n`.
    pub(crate) fn whitener(&self, n: usize) -> &Whitener {
        &self.whiteners[n]
    }
}
