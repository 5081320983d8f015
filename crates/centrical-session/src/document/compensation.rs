//! What became of a compensated record, as a JSON document: schema `centrical-compensation/1`.

use serde::Serialize;

use super::documents::ObjectionName;
use super::result::Program;

/// Name of the schema's present version.
pub(crate) const COMPENSATION_SCHEMA: &str = "centrical-compensation/1";

/// A compensated record.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CompensationReport {
    /// `centrical-compensation/1`.
    pub schema: &'static str,
    /// What made it.
    pub program: Program,
    /// The result of the calibration, as it was given.
    pub result: String,
    /// The record, as it was given.
    pub record: String,
    /// The file with the specific forces.
    pub out: String,
    /// Whether the calibration is acceptable.
    pub acceptable: bool,
    /// The objections to it.
    pub objections: Vec<ObjectionName>,
    /// Unit in which the readings were taken.
    pub unit: String,
    /// Decimals of the specific forces in m/s^2; null where they are written to the last bit.
    pub decimals: Option<u32>,
    /// Readings.
    pub readings: u64,
    /// Largest specific force on each axis [m/s^2]; the inverse is unique up to there.
    pub range: f64,
    /// The largest range for which the inverse is unique [m/s^2]; null where it is unique anywhere.
    pub largest_range: Option<f64>,
    /// Readings beyond the range, which are written as nan.
    pub outside_range: ReadingsBeyond,
    /// Readings beyond those of the calibration, where the error model is extrapolated.
    pub beyond_calibration: ReadingsBeyond,
}

/// Readings beyond a limit.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct ReadingsBeyond {
    /// Their number.
    pub count: u64,
    /// The first; null without such readings.
    pub first: Option<FirstReading>,
}

impl ReadingsBeyond {
    /// These and later ones.
    pub(crate) fn add(&mut self, later: Self) {
        self.count += later.count;
        self.first = self.first.or(later.first);
    }
}

/// The first reading beyond a limit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FirstReading {
    /// Its time [s].
    pub t: f64,
    /// The reading [m/s^2].
    pub reading: [f64; 3],
}
