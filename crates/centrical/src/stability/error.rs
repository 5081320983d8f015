use thiserror::Error;

use crate::progress::Stopped;

/// The reasons why the noise of a record cannot be analysed.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum NoiseError {
    /// No finite sample at all.
    #[error("the record holds {found} samples, none of them a finite number")]
    NoSamples {
        /// Samples found.
        found: usize,
    },
    /// Too few samples.
    #[error("found {found} samples, expected at least {expected}")]
    TooShort {
        /// Samples found.
        found: usize,
        /// Samples needed.
        expected: usize,
    },
    /// The sampling interval is not a positive number.
    #[error("sampling interval: found {found} s, expected a positive number")]
    BadInterval {
        /// Interval found, s.
        found: f64,
    },
    /// The numbers of times and readings differ.
    #[error("found {times} times for {readings} readings, expected as many of each")]
    Unpaired {
        /// Number of times.
        times: usize,
        /// Number of readings.
        readings: usize,
    },
    /// A time is not a number or runs backwards.
    #[error("sample {index}: found time {found} s after {previous} s, expected an increasing time")]
    TimeOrder {
        /// Index of the sample, from 0.
        index: usize,
        /// Time found, s.
        found: f64,
        /// Time of the sample before, s.
        previous: f64,
    },
    /// More grid points are missing than samples are present.
    #[error("found {found} samples in a span of {span} sampling intervals, expected at least half of them")]
    MostlyMissing {
        /// Samples found.
        found: usize,
        /// Grid points spanned.
        span: usize,
    },
    /// A value that is given and cannot be skipped is not finite.
    #[error("value {index}: found {found}, expected a finite number")]
    NotFinite {
        /// Index of the value, from 0.
        index: usize,
        /// Value found.
        found: f64,
    },
    /// A level of confidence outside (0, 1).
    #[error("level of confidence: found {found}, expected a number between 0 and 1")]
    BadConfidence {
        /// Level found.
        found: f64,
    },
    /// A variance of the record vanishes.
    #[error("the record is constant or repeats exactly: it holds no noise to analyse")]
    Constant,
    /// Stamps too coarse for the rate.
    #[error(
        "found {found} of {samples} readings less than half a step after one that they differ from, expected a time of its own for each \
         reading: state the rate in place of a column of time"
    )]
    CoarseStamps {
        /// Such readings.
        found: usize,
        /// Samples in all.
        samples: usize,
    },
    /// The sampling interval changes.
    #[error(
        "found readings every {found:.6} s around {place:.1} s, and every {interval:.6} s on average, expected one rate: choose a stretch"
    )]
    ChangingRate {
        /// The interval of a part of the record [s].
        found: f64,
        /// The middle of the part [s].
        place: f64,
        /// The mean interval [s].
        interval: f64,
    },
    /// Readings that repeat where noise would not.
    #[error(
        "found {repeated} of {readings} readings equal to the one before, {longest} in a row, expected noise in each: something holds them"
    )]
    Held {
        /// Readings equal to the one before.
        repeated: usize,
        /// Readings in all.
        readings: usize,
        /// Readings in the longest run.
        longest: usize,
    },
    /// One reading that repeats, far from all others.
    #[error(
        "found {found} of {readings} readings at {value:?}, far from all others: an error code, or the end of the range; expected noise in \
         each: leave such rows out, or their fields empty"
    )]
    ErrorCode {
        /// Such readings.
        found: usize,
        /// Readings in all.
        readings: usize,
        /// The reading.
        value: f64,
    },
    /// Readings pile up at an end of their range.
    #[error("found {found} readings at {value:?}, an end of their range, expected noise that nothing cuts off")]
    Saturated {
        /// Such readings.
        found: usize,
        /// The value.
        value: f64,
    },
    /// The bias jumps.
    #[error(
        "found a jump by {size:.2e} at {place:.2} s (means over {time:.2} s before and after), expected noise about one level: a jump \
         looks like a random walk; choose a stretch before it or after it"
    )]
    Jump {
        /// By how much the mean changes [unit of the readings].
        size: f64,
        /// When [s].
        place: f64,
        /// Averaging time of the means [s].
        time: f64,
    },
    /// Too many short gaps: means of fewer readings have larger deviations.
    #[error(
        "found {missing} of {readings} readings missing in short gaps, expected a fiftieth at most: means of fewer readings deviate more"
    )]
    ScatteredGaps {
        /// Readings missing in short gaps.
        missing: usize,
        /// Readings in all.
        readings: usize,
    },
    /// No stretch without a gap is long enough.
    #[error("found no {expected} readings in a row without many gaps")]
    Interrupted {
        /// Readings in a row that are needed.
        expected: usize,
    },
    /// BridgedGaps leave too little of the record in one piece.
    #[error("found {missing} of {readings} readings missing, expected at most a tenth missing in each stretch")]
    TooManyGaps {
        /// Readings missing.
        missing: usize,
        /// Readings in all.
        readings: usize,
    },
    /// The variances cannot be described by noise terms.
    #[error("no sum of quantisation, white, flicker and random-walk noise describes the record")]
    Indescribable,
    /// The caller stopped the work.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}
