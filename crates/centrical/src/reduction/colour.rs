//! The colour of the noise, and the covariances that it gives the means.

mod mean;
mod noise_model;
mod rounding;
mod settling;

use super::average::{PlateauFit, ReducedMounting};
use super::plateau::PlateauMean;
use mean::mean;
pub use noise_model::NoiseModel;
use settling::TimeStep;

/// The plateau means of a mounting in the order of the schedule, with their covariances under the session's noise.
pub fn plateau_means(mounting: &ReducedMounting, noise: &NoiseModel) -> Vec<PlateauMean> {
    let step = TimeStep::estimate(&mounting.plateaus, noise);
    // Where the noise is below a digit, rounding shows its own spread and not that of the noise: the quietest plateau is
    // nearest to the latter.
    let variances = mounting.plateaus.iter().map(|plateau| plateau.variance);
    let quietest = variances.reduce(|a, b| a.inf(&b)).unwrap_or_default();
    let mean = |(plateau, speed): (&PlateauFit, &Option<f64>)| PlateauMean {
        measured_speed: *speed,
        ..mean(plateau, noise, &step, &quietest)
    };
    mounting.plateaus.iter().zip(&mounting.speeds).map(mean).collect()
}
