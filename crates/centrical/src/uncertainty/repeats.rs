//! Plateaus that were run again in the same mounting.

use nalgebra::Vector3;

use crate::model::{MeasurementModel, Observation};
use crate::statistics::chi_squared_tail;

/// A plateau against the first one of the same set point in the same mounting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Repeat {
    /// Set points of the first and the second plateau.
    pub set_points: [usize; 2],
    /// Second mean less the first, and less what a difference of measured speeds explains [m/s^2].
    pub difference: Vector3<f64>,
    /// Square of the difference over its covariance, speeds included: chi^2 of three degrees of freedom.
    pub chi_squared: f64,
    /// Probability of so large a chi^2 by chance.
    pub probability: f64,
}

impl Repeat {
    /// Every repeated plateau of `plateaus`, which are all of the experiment's in their order. Speed errors act as in `model` at
    /// the unknowns `x`. A pair whose covariance is not positive definite is left out.
    pub fn all(model: &MeasurementModel, x: &[f64], plateaus: &[Observation]) -> Vec<Repeat> {
        let set_points = &model.experiment().set_points;
        let repeat = |second: usize| {
            let set_point = &set_points[second];
            let first = set_points[..second].iter().position(|other| set_point.repeats(other))?;
            let [one, two] = [first, second].map(|n| &plateaus[n]);
            let [at_one, at_two] = [first, second].map(|n| model.linearise(&set_points[n], x));
            let difference = two.mean - one.mean - (at_two.reading - at_one.reading);
            let [by_one, by_two] = [at_one, at_two].map(|at| at.setting_error * at.setting_error.transpose());
            let covariance = one.covariance + two.covariance + (by_one + by_two);
            let chi_squared = difference.dot(&covariance.cholesky()?.solve(&difference));
            let probability = chi_squared_tail(chi_squared, 3);
            Some(Repeat { set_points: [first, second], difference, chi_squared, probability })
        };
        (0..set_points.len()).filter_map(repeat).collect()
    }
}
