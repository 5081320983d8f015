//! The gain of a fit: how its estimates answer to a change of the readings.
//!
//! With the whitened design `W J = Q R` at the estimate, a change `dy` of the readings moves the estimates by
//! `K dy`, `K = R^-1 Q^T W`. `K` is applied by reflections and back substitution and never formed.

use nalgebra::{DMatrix, DVector, Dyn, QR};

use super::{Fit, Structure};
use crate::design::{Design, Observation, Whitener};
use crate::error::FitError;
use crate::measurement::{Linearisation, MeasurementModel};
use crate::parameter::NULL_HOLD;

/// The factored design at the estimate of a fit.
#[derive(Debug, Clone)]
pub struct Gain {
    qr: QR<f64, Dyn, Dyn>,
    whiteners: Vec<Whitener>,
    /// Rows of the factored design: three per observation, one per prior, one per null direction.
    rows: usize,
    /// Whitened residuals of the observations and the priors.
    residuals: DVector<f64>,
    typical: DVector<f64>,
}

impl Gain {
    /// Gain of `fit`, which was made of `observations` of `model`.
    ///
    /// # Errors
    /// [`FitError`] when an observation cannot be one.
    pub fn of(fit: &Fit, model: &MeasurementModel, observations: &[Observation]) -> Result<Self, FitError> {
        let structure = Structure::of(model, observations)?;
        let set_points = &model.experiment().set_points;
        let linearisations: Vec<Linearisation> =
            observations.iter().map(|o| model.linearise(&set_points[o.set_point], fit.state())).collect();
        let design = Design::at(fit.state(), model, observations, &linearisations)?;
        let pairs = observations.iter().zip(&linearisations);
        let whiteners = pairs.map(|(o, l)| Whitener::new(&o.into(), &l.speed_error)).collect::<Result<_, _>>()?;
        let hold = if fit.null_directions_held { 1.0 / NULL_HOLD } else { 0.0 };
        let equations = structure.equations(&design, &DVector::from_column_slice(fit.state()), hold);
        let (rows, qr) = (equations.rows.nrows(), equations.rows.qr());
        Ok(Self { qr, whiteners, rows, residuals: design.misfit, typical: structure.typical })
    }

    /// Changes of the estimates, `p x m` [units of the parameters], that `m` changes of the readings make,
    /// `3 n x m` [m/s^2], three rows per observation.
    pub fn apply(&self, readings: &DMatrix<f64>) -> DMatrix<f64> {
        self.estimates(&self.rotated(readings))
    }

    /// Changes of the estimates, `p x m`, that each of the `m` priors makes when it is off by one standard uncertainty.
    pub(crate) fn apply_priors(&self) -> DMatrix<f64> {
        let (data, all) = (3 * self.whiteners.len(), self.residuals.len());
        let mut rotated = DMatrix::zeros(self.rows, all - data);
        rotated.rows_mut(data, all - data).fill_with_identity();
        self.qr.q_tr_mul(&mut rotated);
        self.estimates(&rotated)
    }

    /// Back substitution, and from typical to physical units.
    fn estimates(&self, rotated: &DMatrix<f64>) -> DMatrix<f64> {
        let mut estimates = rotated.rows(0, self.typical.len()).into_owned();
        // Held null directions leave no zero on the diagonal of `R`.
        let solved = self.qr.r().solve_upper_triangular_mut(&mut estimates);
        debug_assert!(solved, "the held equations are of full rank");
        estimates.row_iter_mut().zip(self.typical.iter()).for_each(|(mut row, typical)| row *= *typical);
        estimates
    }

    /// The part of `m` changes of the readings, `3 n x m` [m/s^2], that no change of the unknowns can follow: whitened,
    /// in `rows - p` independent coordinates of unit variance.
    pub fn redundant(&self, readings: &DMatrix<f64>) -> DMatrix<f64> {
        let p = self.typical.len();
        self.rotated(readings).rows(p, self.rows - p).into_owned()
    }

    /// The residuals in the same coordinates: all that they can tell.
    pub fn redundant_residuals(&self) -> DVector<f64> {
        let p = self.typical.len();
        let mut rotated = self.residuals.clone().resize_vertically(self.rows, 0.0);
        self.qr.q_tr_mul(&mut rotated);
        rotated.rows(p, self.rows - p).into_owned()
    }

    /// Whitened residuals, three per observation.
    pub(crate) fn whitened_residuals(&self) -> DVector<f64> {
        self.residuals.rows(0, 3 * self.whiteners.len()).into_owned()
    }

    /// The share of each whitened reading in its own fitted value and those of the others: `Q Q^T` of the orthonormal
    /// columns, `3 n x 3 n`. Its trace is the number of unknowns determined.
    pub(crate) fn hat(&self) -> DMatrix<f64> {
        let p = self.typical.len();
        let mut rotated = DMatrix::identity(self.rows, 3 * self.whiteners.len());
        self.qr.q_tr_mul(&mut rotated);
        let q = rotated.rows(0, p);
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
        let mut rotated = self.whitened(readings).resize_vertically(self.rows, 0.0);
        self.qr.q_tr_mul(&mut rotated);
        rotated
    }
}
