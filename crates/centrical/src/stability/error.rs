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
    /// BridgedGaps leave too little of the record in one piece.
    #[error("found {missing} of {readings} readings missing, expected stretches of which a tenth is missing at most")]
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
