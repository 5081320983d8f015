//! Reduction of continuous records to plateau means.
//!
//! A record is one stream per mounting: plateaus of constant speed, the ramps between them, and settling after
//! each ramp. Every scheduled plateau is found in the record itself, and its reading is estimated by
//!
//! `f'(t) = mean + a exp(-(t - t_0) / tau) + c cos(Omega (t - t_0)) + s sin(Omega (t - t_0)) + noise`,
//!
//! the second term being what is left of the settling and the next two the once-per-revolution term (tilt of
//! the axis of rotation); at rest only the mean is there. The noise is coloured, and one plateau is too short to tell
//! its colour: it is pooled over all plateaus of the session ([`NoiseModel`]), and then gives every mean its
//! covariance.
//!
//! Samples are taken with equal weight, or not at all: what is off the fit by more than `sqrt(2 ln 20 n)` robust standard
//! deviations of `n` samples, what is stuck, and what is no number. Fewer than one in twenty plateaus loses a good sample
//! on an axis, so the mean has an efficiency above `1 - (2 ln 20 n) / (20 n)` of that of least squares, 0.999 of a thousand
//! samples, and up to half of the samples may be spikes.
//!
//! A record that is decisively better explained by a mistake in taking it down, exchanged axes for one, is refused with
//! that mistake by name ([`Mistake`]).
//!
//! Two passes, so that a record need never be held as a whole: the first makes blocks of it and finds the windows
//! ([`Survey`]); the second takes the samples of one window at a time ([`Located`]). [`reduce`] is both, for a record in
//! memory.

#![allow(
    clippy::inline_always,
    reason = "what is not inlined into the function with the wide vectors is compiled for the narrow ones"
)]

mod alignment;
mod block;
mod block_fit;
mod blocks;
mod cells;
mod clock;
mod elementary;
mod error;
mod evidence;
mod lanes;
mod mistake;
mod noise;
mod path;
mod plateau_fit;
mod record;
mod regression;
mod rotation;
mod rounding;
mod samples;
mod saturation;
mod settling;
mod shape;
mod strips;
mod stuck;
mod survey;
mod triangle;
mod window;

use std::ops::AddAssign;

use nalgebra::{Matrix3, Vector3};

pub use clock::{ClockOffset, SpeedTrace};
pub use error::{ReductionError, Stretch};
pub use mistake::Mistake;
pub use noise::NoiseModel;
pub use plateau_fit::{Plateau, PlateauFit};
pub use record::{Record, RecordSlice};
pub use survey::{Condensed, Extremes, Located, Survey};

pub(crate) use blocks::{MAD, cut, median};
use settling::TimeStep;

/// One plateau of a mounting's schedule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScheduledPlateau {
    /// Set point of the speed [rad/s]; 0 at rest.
    pub omega: f64,
    /// Nominal reading [K5.1], instrument axes [m/s^2].
    pub nominal_z: Vector3<f64>,
}

/// A mounting whose plateaus are found and averaged, before the noise of the session is known.
#[derive(Debug, Clone)]
pub struct ReducedMounting {
    plateaus: Vec<PlateauFit>,
    /// Speed of each plateau by the telemetry [rad/s].
    speeds: Vec<Option<f64>>,
    settling_time: Option<f64>,
    clock_offset: Option<ClockOffset>,
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
    /// What was left out, by kind.
    pub left_out: LeftOut,
    /// Mean reading, instrument axes [m/s^2].
    pub mean: Vector3<f64>,
    /// Covariance of the mean [m^2/s^4].
    pub covariance: Matrix3<f64>,
    /// Once-per-revolution term: column 0 in phase with the start of the window, column 1 a quarter turn later [m/s^2].
    pub once_per_revolution: [Vector3<f64>; 2],
    /// Slope of the reading over the window [m/s^3]. It does not enter the mean.
    pub drift: Vector3<f64>,
    /// Standard uncertainty of the slope [m/s^3].
    pub drift_uncertainty: Vector3<f64>,
    /// Covariance of either quadrature of the once-per-revolution term [m^2/s^4].
    pub once_per_revolution_covariance: Matrix3<f64>,
    /// Median speed by the telemetry [rad/s], the clocks brought together.
    pub measured_speed: Option<f64>,
    /// What was left of the settling at the start of the window [m/s^2].
    pub settling: Vector3<f64>,
}

/// What is not used of a plateau's window, in samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LeftOut {
    /// Samples that stand out of the noise on some axis.
    pub spikes: usize,
    /// Samples in runs that repeat one reading for longer than noise does.
    pub stuck: usize,
    /// Samples that never came, and readings that are not numbers.
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

/// Finds and averages the scheduled plateaus of one mounting.
///
/// The record and the schedule alone tell where the plateaus are. Telemetry adds the offset of its clock and the
/// measured speeds.
///
/// # Errors
/// [`ReductionError`] if the record is not one (lengths, times), or a scheduled plateau is not in it.
pub fn reduce(
    record: &Record,
    telemetry: Option<&SpeedTrace>,
    schedule: &[ScheduledPlateau],
) -> Result<ReducedMounting, ReductionError> {
    record.check()?;
    let mut survey = Survey::new(&record.t);
    survey.append(survey.condense(record.as_slice()));
    survey.finish();
    let located = survey.locate(telemetry, schedule)?;
    let average = |plateau| located.average(plateau, record.as_slice(), 0);
    let plateaus = (0..schedule.len()).map(average).collect::<Result<_, _>>()?;
    Ok(located.into_mounting(plateaus))
}

impl ReducedMounting {
    /// Time constant of the settling after a ramp [s]; none if no settling was seen.
    pub fn settling_time(&self) -> Option<f64> {
        self.settling_time
    }

    /// The centrifuge's clock against the unit's; none without telemetry, or if no ramp is in both.
    pub fn clock_offset(&self) -> Option<ClockOffset> {
        self.clock_offset
    }

    /// The plateau means in the order of the schedule, with their covariances under the session's noise.
    pub fn means(&self, noise: &NoiseModel) -> Vec<PlateauMean> {
        let step = TimeStep::estimate(&self.plateaus, noise);
        // Rounding shows its own spread, not the noise's, where the noise is less than a digit: the quietest plateau
        // tells.
        let variances = self.plateaus.iter().map(PlateauFit::variance);
        let quietest = variances.reduce(|a, b| a.inf(&b)).unwrap_or_default();
        let mean = |(plateau, speed): (&PlateauFit, &Option<f64>)| PlateauMean {
            measured_speed: *speed,
            ..plateau.mean(noise, &step, &quietest)
        };
        self.plateaus.iter().zip(&self.speeds).map(mean).collect()
    }
}
