//! The colour of the noise, and the covariances that it gives the means.

mod alike;
mod contrasts;
mod likelihood;
mod markov;
mod mean;
mod noise_model;
mod posterior;
mod settling;

use rayon::prelude::*;

use super::average::{PlateauFit, ReducedMounting};
use super::plateau::PlateauMean;
use contrasts::fast_cosines;
use mean::mean;
pub use noise_model::NoiseModel;
use settling::TimeStep;

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
