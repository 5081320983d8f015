//! The reasons why a record cannot be reduced, in the user's words.

use std::fmt;
use std::ops::Range;

use nalgebra::Vector3;
use thiserror::Error;

use super::mistake::Mistake;
use crate::progress::Stopped;

/// Why a record could not be reduced.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ReductionError {
    /// Columns of different lengths.
    #[error("columns of different lengths: {times} times, {readings:?} readings")]
    UnequalColumns {
        /// Number of times.
        times: usize,
        /// Number of readings per axis.
        readings: [usize; 3],
    },
    /// Too few samples to find anything in.
    #[error("record too short: found {found} readable samples, expected at least {expected}")]
    TooShort {
        /// Samples found.
        found: usize,
        /// Fewest that make sense.
        expected: usize,
    },
    /// Samples that hardly last.
    #[error(
        "found {samples} samples from {from} s to {to} s, expected times that go on: a clock that stands still, another unit of time than s, or \
         another column"
    )]
    TimeStands {
        /// Samples that can be read.
        samples: usize,
        /// First time [s].
        from: f64,
        /// Last time [s].
        to: f64,
    },
    /// A time that is not a number or earlier than the one before it.
    #[error("sample {sample}: found time {found} s after {before} s, expected times that do not decrease")]
    Time {
        /// Sample, counted from 1.
        sample: usize,
        /// Its time [s].
        found: f64,
        /// The time before it [s].
        before: f64,
    },
    /// A scheduled plateau is not in the record.
    #[error(
        "plateau {} of {count} not found: looked for {} in the order of the schedule, {least:.2} s of it or more; seen: {}",
        index + 1, Sought { omega: *omega, level: level_z }, Seen { stretches: seen, missing: *index }
    )]
    PlateauNotFound {
        /// Index of the plateau in the schedule.
        index: usize,
        /// Plateaus in the schedule.
        count: usize,
        /// Its speed [rad/s].
        omega: f64,
        /// Its nominal reading [m/s^2].
        level_z: Vector3<f64>,
        /// Shortest plateau that can be averaged [s].
        least: f64,
        /// The stationary stretches of the record.
        seen: Vec<Stretch>,
    },
    /// A plateau is too short to be averaged.
    #[error(
        "plateau {} is too short: found from {:.3} s to {:.3} s, expected more than {least:.3} s of steady reading there",
        index + 1, window[0], window[1]
    )]
    PlateauTooShort {
        /// Index of the plateau in the schedule.
        index: usize,
        /// Where it was found [s].
        window: [f64; 2],
        /// Shortest that can be averaged [s].
        least: f64,
    },
    /// A recording mistake explains the record decisively better than the session's description.
    #[error(
        "readings fit {mistake}: on plateau {} at {omega:.3} rad/s found {}, expected about {}",
        index + 1, Level(found_z), Level(level_z)
    )]
    Mistaken {
        /// The mistake that explains the readings.
        mistake: Box<Mistake>,
        /// Index of the plateau in the schedule where it shows most.
        index: usize,
        /// Its speed [rad/s].
        omega: f64,
        /// Its nominal reading [m/s^2].
        level_z: Vector3<f64>,
        /// Its reading [m/s^2].
        found_z: Vector3<f64>,
    },
    /// The ramps fit the other sense of rotation.
    #[error(
        "the {ramps} ramps fit the other sense of rotation: found {part:.2} times the expected pull across the arm, \
         expected 1; the sign of rotation is wrong, that of the newtonometer across the arm, or the order of the columns"
    )]
    Rotation {
        /// Ramps that were compared.
        ramps: usize,
        /// The tangential part of the readings over the expected one.
        part: f64,
    },
    /// The ramps fit time in another unit.
    #[error(
        "the {ramps} ramps fit time in {unit}: found {part:.0} times the expected pull across the arm, expected 1; state the unit beside the \
         column of time, as in time = {{ column = \"t\", unit = \"{unit}\" }}"
    )]
    TimeUnit {
        /// Ramps that were compared.
        ramps: usize,
        /// The tangential part of the readings over the expected one.
        part: f64,
        /// The unit that fits.
        unit: &'static str,
    },
    /// A newtonometer is stuck on a plateau.
    #[error(
        "plateau {} from {:.3} s to {:.3} s: f{} reads exactly {value} m/s^2 in {stuck} of {samples} samples: \
         a stuck newtonometer, one beyond its range, or steps of the reading that are coarser than its noise and not stated; expected noise", index + 1, window[0], window[1], axis + 1
    )]
    Stuck {
        /// Index of the plateau in the schedule.
        index: usize,
        /// Where it was found [s].
        window: [f64; 2],
        /// Newtonometer, 0 to 2.
        axis: usize,
        /// Its most frequent reading [m/s^2].
        value: f64,
        /// Samples in the window.
        samples: usize,
        /// Samples that are stuck.
        stuck: usize,
    },
    /// A newtonometer is at the end of its range on a plateau.
    #[error(
        "plateau {} from {:.3} s to {:.3} s: f{} reads {value} m/s^2 and nothing beyond in {piled_up} of {samples} samples: \
         saturated; expected readings within the range", index + 1, window[0], window[1], axis + 1
    )]
    Saturated {
        /// Index of the plateau in the schedule.
        index: usize,
        /// Where it was found [s].
        window: [f64; 2],
        /// Newtonometer, 0 to 2.
        axis: usize,
        /// The end of the range [m/s^2].
        value: f64,
        /// Samples in the window.
        samples: usize,
        /// Samples at the end of the range.
        piled_up: usize,
    },
    /// No steady reading to average, though the medians of blocks are steady.
    #[error(
        "plateau {} from {:.3} s to {:.3} s: found {good} of {samples} samples near any one reading",
        index + 1, window[0], window[1]
    )]
    Unsteady {
        /// Index of the plateau in the schedule.
        index: usize,
        /// Where it was found [s].
        window: [f64; 2],
        /// Samples in the window.
        samples: usize,
        /// Samples that were not taken for spikes last.
        good: usize,
    },
    /// Most of the time of a plateau has no samples.
    #[error(
        "plateau {} from {:.3} s to {:.3} s: found {samples} samples every {interval:.6} s and nothing between, \
         expected them all the time: the clock jumped, or the record has a gap",
        index + 1, window[0], window[1]
    )]
    Interrupted {
        /// Index of the plateau in the schedule.
        index: usize,
        /// Where it was found [s].
        window: [f64; 2],
        /// Samples in the window.
        samples: usize,
        /// Sampling interval [s].
        interval: f64,
    },
    /// Sampling and rotation in step: a constant and the once-per-revolution term cannot be separated.
    #[error(
        "plateau {}: {omega:.4} rad/s sampled every {interval:.6} s shows the same phase of the revolution each time; \
         its mean cannot be separated from the once-per-revolution term; expected another rate, or time in another unit", index + 1
    )]
    RevolutionAliased {
        /// Index of the plateau in the schedule.
        index: usize,
        /// Its speed [rad/s].
        omega: f64,
        /// Sampling interval [s].
        interval: f64,
    },
    /// The caller stopped the work.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// A stationary stretch of a record.
#[derive(Debug, Clone, PartialEq)]
pub struct Stretch {
    /// From, to [s].
    pub window: [f64; 2],
    /// Median reading [m/s^2].
    pub level_z: Vector3<f64>,
    /// The scheduled plateau it was taken for.
    pub plateau: Option<usize>,
    /// The scheduled plateaus whose level it has, whatever their order.
    pub resembles: Vec<usize>,
}

struct Sought<'a> {
    omega: f64,
    level: &'a Vector3<f64>,
}

struct Level<'a>(&'a Vector3<f64>);

impl fmt::Display for Level<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let l = self.0;
        write!(out, "({:.2}, {:.2}, {:.2}) m/s^2", l.x, l.y, l.z)
    }
}

/// The steady stretches about a plateau that is missing.
struct Seen<'a> {
    stretches: &'a [Stretch],
    missing: usize,
}

impl fmt::Display for Sought<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let l = self.level;
        write!(out, "{:.3} rad/s, about ({:.2}, {:.2}, {:.2}) m/s^2,", self.omega, l.x, l.y, l.z)
    }
}

impl Seen<'_> {
    /// Most stretches that a message lists to either side of a missing plateau.
    const BESIDE: usize = 6;

    /// The stretches next to where the plateau should be: from the last one that was taken for an earlier plateau on.
    fn nearest(&self) -> Range<usize> {
        let is_earlier = |stretch: &Stretch| stretch.plateau.is_some_and(|plateau| plateau < self.missing);
        let place = self.stretches.iter().rposition(is_earlier).map_or(0, |last| last + 1);
        place.saturating_sub(Self::BESIDE)..(place + Self::BESIDE).min(self.stretches.len())
    }
}

impl fmt::Display for Seen<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown = self.nearest();
        if self.stretches.is_empty() {
            return write!(out, "no steady stretch at all, as where time is in another unit than s");
        }
        if shown.len() < self.stretches.len() {
            let range = format_args!("{} to {} of {}", shown.start + 1, shown.end, self.stretches.len());
            write!(out, "steady stretches {range}: ")?;
        }
        for (i, stretch) in self.stretches[shown].iter().enumerate() {
            let [from, to] = stretch.window;
            let l = stretch.level_z;
            let separator = if i == 0 { "" } else { "; " };
            write!(out, "{separator}{from:.1} to {to:.1} s at ({:.2}, {:.2}, {:.2})", l.x, l.y, l.z)?;
            match (stretch.plateau, stretch.resembles.as_slice()) {
                (Some(plateau), alike) if plateau + 1 == self.missing && alike.contains(&self.missing) => {
                    write!(out, ", plateau {}, and plateau {} would look alike", plateau + 1, self.missing + 1)?;
                }
                (Some(plateau), _) => write!(out, ", plateau {}", plateau + 1)?,
                (None, []) => write!(out, ", no level of the schedule")?,
                (None, [like, ..]) => write!(out, ", as plateau {} should read, repeated or out of order", like + 1)?,
            }
        }
        Ok(())
    }
}
