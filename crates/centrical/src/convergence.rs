//! How the uncertainties shrink as the session goes on: those of all unknowns after each plateau.
//!
//! Square-root information form: the triangular factor `R` of the whitened design starts from a standard deviation of
//! [`NULL_HOLD`] typical magnitudes for every unknown, and each plateau adds its three whitened rows by a
//! QR factorisation. The uncertainties are the lengths of the rows of `R^-1`.

use nalgebra::{DMatrix, Matrix3};

use crate::design::Observation;
use crate::fit::Fit;
use crate::measurement::MeasurementModel;
use crate::parameter::NULL_HOLD;

/// The uncertainties at some stage of the session.
#[derive(Debug, Clone, PartialEq)]
pub struct Checkpoint {
    /// Plateaus used so far.
    pub plateaus: usize,
    /// Standard uncertainty of every unknown, SI, in the order of the model's parameters.
    pub standard_uncertainty: Vec<f64>,
}

/// Standard uncertainties after so many plateaus, at no more than `most` stages evenly spread over the
/// `observations` from which `fit` was made; the last stage has them all.
pub fn convergence(model: &MeasurementModel, observations: &[Observation], fit: &Fit, most: usize) -> Vec<Checkpoint> {
    let typical: Vec<f64> = model.parameters().iter().map(|p| p.typical).collect();
    let p = typical.len();
    let every = observations.len().div_ceil(most.max(1)).max(1);
    let mut stack = DMatrix::zeros(p + 3, p);
    stack.fill_diagonal(1.0 / NULL_HOLD);
    let mut checkpoints = Vec::new();
    for (n, (observation, covariance)) in observations.iter().zip(&fit.observation_covariances).enumerate() {
        stack.rows_mut(p, 3).copy_from(&whitened_rows(model, observation, covariance, fit, &typical));
        let r = stack.clone().qr().unpack_r();
        stack.rows_mut(0, p).copy_from(&r);
        let plateaus = n + 1;
        if plateaus % every == 0 || plateaus == observations.len() {
            checkpoints.push(Checkpoint { plateaus, standard_uncertainty: uncertainties(&r, &typical) });
        }
    }
    checkpoints
}

/// The rows of one plateau at the fit, whitened, in typical units.
fn whitened_rows(
    model: &MeasurementModel,
    observation: &Observation,
    covariance: &Matrix3<f64>,
    fit: &Fit,
    typical: &[f64],
) -> DMatrix<f64> {
    let set_point = &model.experiment().set_points[observation.set_point];
    let mut rows = DMatrix::zeros(3, typical.len());
    // A fit accepts positive definite covariances only.
    let Some(factor) = covariance.cholesky() else { return rows };
    for (column, derivative) in model.linearise(set_point, fit.state()).columns {
        if let Some(whitened) = factor.l_dirty().solve_lower_triangular(&derivative) {
            rows.column_mut(column).copy_from(&(whitened * typical[column]));
        }
    }
    rows
}

fn uncertainties(r: &DMatrix<f64>, typical: &[f64]) -> Vec<f64> {
    let mut inverse = DMatrix::identity(typical.len(), typical.len());
    // The start has full rank, and rows only add to it.
    let solved = r.solve_upper_triangular_mut(&mut inverse);
    debug_assert!(solved, "the start has full rank");
    inverse.row_iter().zip(typical).map(|(row, typical)| row.norm() * typical).collect()
}
