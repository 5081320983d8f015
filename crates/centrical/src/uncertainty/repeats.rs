//! Plateaus that were run again in the same mounting.

use nalgebra::Vector3;

use crate::model::{MeasurementModel, Observation};
use crate::statistics::Test;

impl MeasurementModel {
    /// Every plateau that repeats a set point in its mounting, against the first one of it. Returns the two set points, the difference of their
    /// means [m/s^2] (second less first) and its test by its covariance, speeds included. The difference is without what a difference of
    /// measured speeds explains.
    ///
    /// `plateaus` are all of the experiment's in their order. Speed errors act as at the unknowns `x`. A pair whose covariance is not positive
    /// definite is left out.
    pub fn repeats(&self, x: &[f64], plateaus: &[Observation]) -> Vec<([usize; 2], Vector3<f64>, Test)> {
        let set_points = &self.experiment().set_points;
        let repeat = |second: usize| {
            let set_point = &set_points[second];
            let first = set_points[..second].iter().position(|other| set_point.repeats(other))?;
            let [one, two] = [first, second].map(|n| &plateaus[n]);
            let [at_one, at_two] = [first, second].map(|n| self.linearise(&set_points[n], x));
            let difference = two.mean - one.mean - (at_two.reading - at_one.reading);
            let [by_one, by_two] = [at_one, at_two].map(|at| at.setting_error * at.setting_error.transpose());
            let covariance = one.covariance + two.covariance + (by_one + by_two);
            let chi_squared = difference.dot(&covariance.cholesky()?.solve(&difference));
            Some(([first, second], difference, Test::chi_squared(chi_squared, 3)))
        };
        (0..set_points.len()).filter_map(repeat).collect()
    }
}
