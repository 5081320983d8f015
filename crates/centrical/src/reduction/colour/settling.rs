//! The time constant of the settling, from the samples of all plateaus of a mounting.
//!
//! The windows take it from block levels. With the noise known, one Gauss-Newton step of generalised least squares
//! improves it, and its uncertainty adds to the covariances of the means.

use nalgebra::{Matrix3, Vector3};

use super::noise_model::NoiseModel;
use crate::reduction::average::{Cells, PlateauFit};

/// `d ln tau`: the correction of the time constant.
pub(super) struct TimeStep {
    value: f64,
    variance: f64,
}

impl TimeStep {
    /// Estimates the step: every plateau's residuals hold `a g'(t) d ln tau`, `a` being the settling at its start and
    /// `g'` the derivative of its law.
    pub fn estimate(plateaus: &[PlateauFit], noise: &NoiseModel) -> Self {
        let (mut information, mut score) = (0.0, 0.0);
        for plateau in plateaus {
            let Some(rate) = plateau.settling_rate() else { continue };
            let (weights, product) = plateau.cells.contrast(&rate);
            let covariance = noise.covariance(&weights, plateau);
            let Some(factor) = covariance.cholesky() else { continue };
            let weighted = factor.solve(&plateau.settling) * weights.squares;
            information += weighted.dot(&plateau.settling) * weights.squares;
            score += weighted.dot(&product);
        }
        if information > 0.0 { Self { value: score / information, variance: 1.0 / information } } else { Self::none() }
    }

    fn none() -> Self {
        Self { value: 0.0, variance: 0.0 }
    }

    /// The correction of a mean, and the covariance that the uncertainty of the step adds.
    pub fn effect(&self, plateau: &PlateauFit) -> (Vector3<f64>, Matrix3<f64>) {
        let Some(rate) = plateau.settling_rate() else { return (Vector3::zeros(), Matrix3::zeros()) };
        let per_step = -plateau.settling * mean_of(&plateau.cells, &rate);
        (per_step * self.value, per_step * per_step.transpose() * self.variance)
    }
}

/// The mean's functional of a slow function of time, one value a cell.
fn mean_of(cells: &Cells, function: &[f64]) -> f64 {
    cells.mean_weights().by_cell.iter().zip(function).map(|(w, v)| w * v).sum()
}
