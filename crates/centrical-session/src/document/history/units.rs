//! Units of one type beside each other, as a JSON document: schema `centrical-units-history/1`.

use centrical::Group;
use serde::Serialize;

use super::unit::LeftOutSession;
use crate::document::result::Program;
use crate::quantity::Date;

/// Name of the schema's present version.
pub(crate) const UNITS_HISTORY_SCHEMA: &str = "centrical-units-history/1";

/// Units of one type.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UnitsHistoryReport {
    /// `centrical-units-history/1`.
    pub schema: &'static str,
    /// What made it.
    pub program: Program,
    /// Model of the units.
    pub unit_model: String,
    /// Number of units.
    pub units: usize,
    /// Number of their calibrations that are compared.
    pub sessions: usize,
    /// Number of these with an objection.
    pub not_acceptable: usize,
    /// Calibrations that do not determine the same parameters.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub left_out: Vec<LeftOutSession>,
    /// Parameters that some of the calibrations determine and others do not: units are not compared by them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub not_compared: Vec<NotComparedParameter>,
    /// Whether every station has enough units to say which is outlying: ten.
    pub is_tested: bool,
    /// The stations that have fewer, with their units.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub untested: Vec<UntestedStation>,
    /// Whether no unit is outlying, drifts, scatters or is beyond a limit, and batches, where they were given, do not differ: of what was
    /// tested.
    pub is_sound: bool,
    /// Whether batches were given that cannot be compared.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub batches_not_compared: bool,
    /// The station at which batches are compared, of several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub batches_at: Option<String>,
    /// Units beyond a limit of a parameter.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub beyond_limits: Vec<BeyondLimit>,
    /// Outlying units, the farthest first.
    pub outlying: Vec<OutlyingUnit>,
    /// Units that drift, or scatter more than the others.
    pub findings: Vec<UnitFinding>,
    /// Serial numbers with a batch that no unit has.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub without_unit: Vec<BatchWithoutUnit>,
    /// The parameters that all calibrations compared determine.
    pub parameters: Vec<UnitsParameter>,
}

/// A parameter by which units are not compared.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct NotComparedParameter {
    /// Name.
    pub name: String,
    /// Number of the calibrations that determine it.
    pub sessions: usize,
}

/// A station with too few units to say which of them is outlying.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct UntestedStation {
    /// The station.
    pub station: String,
    /// Serial numbers of its units.
    pub units: Vec<String>,
}

/// Units whose mean or last value is beyond a limit of a parameter.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct BeyondLimit {
    /// The parameter.
    pub parameter: String,
    /// Serial numbers of the units.
    pub units: Vec<String>,
}

/// A serial number that has a batch, and no unit.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct BatchWithoutUnit {
    /// The serial number.
    pub unit_serial: String,
    /// Units whose serial numbers differ from it in spaces, hyphens, case, leading zeros, or Cyrillic for Latin letters alone.
    pub near: Vec<String>,
}

/// A unit that is not like the others: family-wise 5 %, together with all other findings.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OutlyingUnit {
    /// Serial number.
    pub unit_serial: String,
    /// Robust distance over all parameters.
    pub distance: f64,
    /// Probability that the farthest of as many sound units is as far off.
    pub probability: f64,
    /// The parameters farthest off, in robust standard deviations from the median.
    pub most: Vec<(String, f64)>,
}

/// What a unit does in the course of its sessions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum UnitFindingKind {
    /// Its values have a slope.
    Drifts,
    /// They scatter about their line by more than those of the other units.
    Scatters,
}

/// A unit that drifts or scatters in one parameter: family-wise over all units and parameters (Holm), 5 % together with all other findings.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UnitFinding {
    /// Which of the two.
    pub kind: UnitFindingKind,
    /// Serial number.
    pub unit_serial: String,
    /// The parameter.
    pub parameter: String,
    /// Its slope per year, SI.
    pub slope_per_year: f64,
    /// Standard uncertainty of the slope.
    pub slope_uncertainty: f64,
    /// Scatter about the line over that of the other units, in squares.
    pub variance_ratio: f64,
    /// The days of two sessions between which a step explains the values better than a line in time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<[Date; 2]>,
    /// Family-wise probability.
    pub probability: f64,
}

/// One parameter over the units, SI; of each unit the mean over its calibrations.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UnitsParameter {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// bias, scale, misalignment, ...
    #[serde(serialize_with = "crate::document::json::serialize")]
    pub group: Group,
    /// Mean over the units.
    pub mean: f64,
    /// Standard deviation over the units; null of one unit.
    pub deviation: Option<f64>,
    /// Least value.
    pub least: f64,
    /// Median.
    pub median: f64,
    /// Largest value.
    pub largest: f64,
    /// Capability, where limits were given.
    pub capability: Option<CapabilitySummary>,
    /// Batches of units, where they were given.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub batches: Vec<BatchSummary>,
    /// Probability of so large a difference of the batches (Welch), where two or more were given.
    pub batch_probability: Option<f64>,
    /// Whether that is beyond chance, all parameters together (Holm): 5 % together with all other findings.
    pub batches_differ: bool,
}

/// A batch of units in one parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BatchSummary {
    /// Name of the batch.
    pub batch: String,
    /// Number of its units.
    pub units: usize,
    /// Mean over them.
    pub mean: f64,
    /// Standard deviation over them; null of one unit.
    pub deviation: Option<f64>,
}

/// Capability against limits, with intervals of 95 %.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CapabilitySummary {
    /// Lower limit.
    pub low: Option<f64>,
    /// Upper limit.
    pub high: Option<f64>,
    /// Cp, with both limits.
    pub cp: Option<f64>,
    /// Its interval.
    pub cp_interval: Option<[f64; 2]>,
    /// Cpk.
    pub cpk: f64,
    /// Its interval.
    pub cpk_interval: [f64; 2],
}
