//! A plateau as scheduled, and as measured.

use std::ops::AddAssign;

use nalgebra::{Matrix3, Vector3};

use crate::model::{Experiment, Observation};

/// One plateau of a mounting's schedule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScheduledPlateau {
    /// Set point of the speed [rad/s]; 0 at rest.
    pub omega: f64,
    /// Nominal reading [K5.1], instrument axes [m/s^2].
    pub nominal_z: Vector3<f64>,
}

impl ScheduledPlateau {
    /// The plateaus of a mounting in their order.
    pub fn of_mounting(experiment: &Experiment, mounting: usize) -> Vec<Self> {
        let set_points = experiment.set_points.iter().filter(|set_point| set_point.mounting == mounting);
        set_points.map(|s| Self { omega: s.omega, nominal_z: experiment.nominal(s) }).collect()
    }
}

/// The mean reading of one plateau.
#[derive(Debug, Clone, PartialEq)]
pub struct PlateauMean {
    /// From, to, the record's clock [s].
    pub window: [f64; 2],
    /// Samples used.
    pub samples: usize,
    /// Samples of the window left out: spikes, missing and stuck readings.
    pub rejected: usize,
    /// The rejected samples, by kind.
    pub left_out: LeftOut,
    /// Mean reading, instrument axes [m/s^2].
    pub mean: Vector3<f64>,
    /// Covariance of the mean [m^2/s^4].
    pub covariance: Matrix3<f64>,
    /// Variance of the mean if its noise were white [m^2/s^4]; zero where the readings show rounding alone.
    pub white_variance: Vector3<f64>,
    /// Once-per-revolution term: column 0 in phase with the start of the window, column 1 a quarter turn later [m/s^2].
    pub once_per_revolution: [Vector3<f64>; 2],
    /// How the unit turns, where it does so slowly: the mean reading is then that of a rest in the attitude of the arc.
    pub arc: Option<Arc>,
    /// Slope of the reading over the window [m/s^3]; zero where the unit turns. It does not enter the mean.
    pub drift: Vector3<f64>,
    /// Standard uncertainty of the slope by the noise of all plateaus together [m/s^3].
    pub drift_uncertainty: Vector3<f64>,
    /// Covariance of either quadrature of the once-per-revolution term [m^2/s^4].
    pub once_per_revolution_covariance: Matrix3<f64>,
    /// Median speed by the telemetry [rad/s], corrected for the offset of its clock.
    pub measured_speed: Option<f64>,
    /// Remaining settling at the start of the window [m/s^2].
    pub settling: Vector3<f64>,
}

impl PlateauMean {
    /// The mean as data of a fit, of that set point.
    pub fn observation(&self, set_point: usize) -> Observation {
        Observation { set_point, mean: self.mean, covariance: self.covariance }
    }
}

/// An arc of slow rotation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arc {
    /// Rate of the specific force against the unit in the middle [rad/s]; rotation about the vertical does not show.
    pub rate: f64,
    /// Second derivative of the vertical in axes of the instrument, its mean over the window [1/s^2].
    pub bend_z: Vector3<f64>,
}

/// Rejected samples of a plateau's window, by kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LeftOut {
    /// Samples outside the noise on some axis.
    pub spikes: usize,
    /// Samples in runs that repeat one reading for longer than noise does.
    pub stuck: usize,
    /// Samples missing from the record, and readings that are not numbers.
    pub missing: usize,
    /// Samples with the stamp of the one before.
    pub repeated: usize,
}

impl AddAssign for LeftOut {
    fn add_assign(&mut self, other: Self) {
        self.spikes += other.spikes;
        self.stuck += other.stuck;
        self.missing += other.missing;
        self.repeated += other.repeated;
    }
}
