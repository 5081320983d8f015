//! The colour of the noise, and the covariances that it gives the means.

mod contrasts;
mod noise_model;
mod posterior;

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use super::average::{Cells, PlateauFit, ReducedMounting, Weights};
use super::plateau::PlateauMean;
use crate::statistics::bias_variance;
use contrasts::fast_cosines;
pub use noise_model::NoiseModel;

impl ReducedMounting {
    /// The plateau means of a mounting in the order of the schedule, with their covariances under the session's noise.
    pub fn means(&self, noise: &NoiseModel) -> Vec<PlateauMean> {
        let step = TimeStep::estimate(&self.plateaus, noise);
        let cosines = fast_cosines();
        let mean = |(plateau, speed): (&PlateauFit, &Option<f64>)| PlateauMean {
            measured_speed: *speed,
            ..mean(plateau, noise, &step, &noise.own_scale(plateau, &cosines))
        };
        self.plateaus.par_iter().zip(&self.timing.speeds).map(mean).collect()
    }
}

/// The mean of a plateau whose noise has a scale of its `own` on each axis.
fn mean(plateau: &PlateauFit, noise: &NoiseModel, step: &TimeStep, own: &Vector3<f64>) -> PlateauMean {
    let [cosine, sine] = plateau.once_per_revolution;
    let amplitude = cosine.zip_map(&sine, f64::hypot);
    let rounding = plateau.digit.zip_zip_map(&noise.quietest(), &amplitude, bias_variance);
    // The error of the settling's time constant is common to the mounting: it is not a drift of each of its plateaus.
    let (weights, drift) = plateau.cells.slope(plateau.settling_rate().as_deref());
    let drift = if plateau.turns() { Vector3::zeros() } else { drift };
    let (correction, of_correction) = step.effect(plateau);
    let own = Matrix3::from_diagonal(own);
    let of_slope = (own * plateau.in_readings(&noise.covariance_by_all(&weights, plateau)) * own).diagonal();
    let of_noise = own * plateau.in_readings(&noise.covariance(&plateau.cells.mean_weights(), plateau)) * own;
    PlateauMean {
        window: plateau.window,
        samples: plateau.samples,
        rejected: plateau.rejected,
        left_out: plateau.left_out,
        mean: plateau.mean + correction,
        covariance: of_noise + of_correction + Matrix3::from_diagonal(&rounding),
        white_variance: plateau.variance / plateau.samples.max(1) as f64,
        once_per_revolution: plateau.once_per_revolution,
        once_per_revolution_covariance: covariance_of_harmonic(plateau, noise),
        drift,
        measured_speed: None,
        drift_uncertainty: (of_slope + rounding * largest_gain(&weights).powi(2)).map(f64::sqrt),
        settling: plateau.settling,
        arc: plateau.arc(),
    }
}

/// What a functional makes of a unit error at most, whose sign may change with time as that of rounding does.
fn largest_gain(weights: &Weights) -> f64 {
    weights.by_cell.iter().map(|weight| weight.abs()).sum()
}

/// Covariance of either quadrature of the once-per-revolution term: `2 S(Omega / 2 pi) / T`, with the two-sided
/// density `S` of the noise at the frequency of rotation and the time `T` that was sampled; for whole revolutions.
fn covariance_of_harmonic(plateau: &PlateauFit, noise: &NoiseModel) -> Matrix3<f64> {
    if plateau.shape.omega == 0.0 {
        return Matrix3::zeros();
    }
    noise.density_on(plateau, plateau.shape.omega / TAU) * (2.0 / (plateau.samples as f64 * plateau.cells.interval))
}

/// `d ln tau`: the correction of the time constant of the settling, from the samples of all plateaus of a mounting.
///
/// The windows take the constant from block levels. With the noise known, one Gauss-Newton step of generalised least squares
/// improves it, and its uncertainty adds to the covariances of the means.
struct TimeStep {
    value: f64,
    variance: f64,
}

impl TimeStep {
    /// Estimates the step: every plateau's residuals hold `a g'(t) d ln tau`, `a` being the settling at its start and
    /// `g'` the derivative of its law.
    fn estimate(plateaus: &[PlateauFit], noise: &NoiseModel) -> Self {
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
    fn effect(&self, plateau: &PlateauFit) -> (Vector3<f64>, Matrix3<f64>) {
        let Some(rate) = plateau.settling_rate() else { return (Vector3::zeros(), Matrix3::zeros()) };
        let per_step = -plateau.settling * mean_of(&plateau.cells, &rate);
        (per_step * self.value, per_step * per_step.transpose() * self.variance)
    }
}

/// The mean's functional of a slow function of time, one value a cell.
fn mean_of(cells: &Cells, function: &[f64]) -> f64 {
    cells.mean_weights().by_cell.iter().zip(function).map(|(w, v)| w * v).sum()
}
