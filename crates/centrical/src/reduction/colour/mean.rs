//! The mean of one plateau, with its covariance under the session's noise.

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Vector3};

use super::noise_model::NoiseModel;
use super::rounding::bias_variance;
use super::settling::TimeStep;
use crate::reduction::average::PlateauFit;
use crate::reduction::plateau::PlateauMean;

/// The mean of a plateau; `quietest` is the least variance of a sample on any plateau of the mounting.
pub(super) fn mean(plateau: &PlateauFit, noise: &NoiseModel, step: &TimeStep, quietest: &Vector3<f64>) -> PlateauMean {
    let rounding = plateau.digit.zip_map(quietest, bias_variance);
    let (weights, drift) = plateau.cells.slope();
    let (correction, of_correction) = step.effect(plateau);
    let of_noise = noise.covariance(&plateau.cells.mean_weights(), &plateau.cells);
    PlateauMean {
        window: plateau.window,
        samples: plateau.samples,
        rejected: plateau.rejected,
        left_out: plateau.left_out,
        mean: plateau.mean + correction,
        covariance: of_noise + of_correction + Matrix3::from_diagonal(&rounding),
        once_per_revolution: plateau.once_per_revolution,
        once_per_revolution_covariance: covariance_of_harmonic(plateau, noise),
        drift,
        measured_speed: None,
        drift_uncertainty: noise.covariance(&weights, &plateau.cells).diagonal().map(f64::sqrt),
        settling: plateau.settling,
    }
}

/// Covariance of either quadrature of the once-per-revolution term: `2 S(Omega / 2 pi) / T`, with the two-sided
/// density `S` of the noise at the frequency of rotation and the time `T` that was sampled; for whole revolutions.
fn covariance_of_harmonic(plateau: &PlateauFit, noise: &NoiseModel) -> Matrix3<f64> {
    if plateau.shape.omega == 0.0 {
        return Matrix3::zeros();
    }
    noise.density(plateau.shape.omega / TAU) * (2.0 / (plateau.samples as f64 * plateau.cells.interval))
}
