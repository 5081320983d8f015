//! How the uncertainties shrink as the session goes on: those of all unknowns after each plateau.
//!
//! Square-root information form: the triangular factor `R` of the whitened design starts from a standard deviation of
//! [`NULL_HOLD`] typical magnitudes for every unknown, and the plateaus of each stage add their whitened rows by a
//! QR factorisation. The uncertainties are the lengths of the rows of `R^-1`.

use nalgebra::{DMatrix, DVector, Matrix3};

use super::calibration::Calibration;
use crate::linalg::least_squares::LeastSquares;
use crate::model::{Linearisation, NULL_HOLD};

/// The uncertainties at some stage of the session.
#[derive(Debug, Clone, PartialEq)]
pub struct Checkpoint {
    /// Plateaus used so far.
    pub plateaus: usize,
    /// Standard uncertainty of every unknown, SI, in the order of the model's parameters.
    pub standard_uncertainty: Vec<f64>,
}

impl Calibration<'_> {
    /// Standard uncertainties at no more than `most` evenly spread stages of the session; the last stage has all plateaus.
    pub fn convergence(&self, most: usize) -> Vec<Checkpoint> {
        let (model, observations, fit) = (self.data().model(), self.data().observations(), self.fit());
        let (parameters, typical) = (model.parameters().len(), self.data().typical());
        let p = typical.len();
        let every = observations.len().div_ceil(most.max(1)).max(1);
        let mut triangle = DMatrix::zeros(p, p);
        triangle.fill_diagonal(1.0 / NULL_HOLD);
        (parameters..p).for_each(|influence| triangle[(influence, influence)] = 1.0);
        let mut checkpoints = Vec::new();
        let mut plateaus = 0;
        let linearisations = self.data().linearised(&fit.unknowns());
        for (linearisations, covariances) in linearisations.chunks(every).zip(fit.observation_covariances.chunks(every))
        {
            let mut stack = triangle.resize_vertically(p + 3 * linearisations.len(), 0.0);
            for (n, (linearisation, covariance)) in linearisations.iter().zip(covariances).enumerate() {
                let rows = whitened_rows(linearisation, covariance, &typical);
                stack.rows_mut(p + 3 * n, 3).copy_from(&rows);
            }
            let equations = LeastSquares::new(stack, typical.clone());
            triangle = equations.triangle().clone();
            plateaus += linearisations.len();
            let mut standard_uncertainty = equations.standard_uncertainties();
            standard_uncertainty.truncate(parameters);
            checkpoints.push(Checkpoint { plateaus, standard_uncertainty });
        }
        checkpoints
    }
}

/// The rows of one plateau at the fit, whitened, in typical units.
fn whitened_rows(linearisation: &Linearisation, covariance: &Matrix3<f64>, typical: &DVector<f64>) -> DMatrix<f64> {
    let mut rows = DMatrix::zeros(3, typical.len());
    // A fit accepts positive definite covariances only.
    let Some(factor) = covariance.cholesky() else { return rows };
    for (column, derivative) in linearisation.by_unknowns() {
        if let Some(whitened) = factor.l_dirty().solve_lower_triangular(derivative) {
            rows.column_mut(column).copy_from(&(whitened * typical[column]));
        }
    }
    rows
}
