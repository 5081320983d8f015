//! The tables of `experiment.toml` as they are written. Every key is known here: one that is not is an error.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::entries::{ColumnEntry, PriorValue, RecordEntry, Steps, TermList, date_as_text, name_or_number};
use crate::quantity::Quantity;

/// The whole file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Form {
    /// Path of a table of plateaus already averaged.
    pub plateaus: Option<String>,
    /// What is planned, where nothing is measured yet.
    pub plan: Option<PlanTable>,
    /// What a plan is chosen from, what it costs, what it is for, and what it must be good for.
    pub candidates: Option<CandidatesTable>,
    #[serde(default)]
    pub cost: CostTable,
    #[serde(default)]
    pub target: TargetTable,
    #[serde(default)]
    pub robust: RobustTable,
    #[serde(default)]
    pub session: SessionTable,
    pub site: SiteTable,
    pub unit: UnitTable,
    pub centrifuge: CentrifugeTable,
    pub model: ModelTable,
    #[serde(default)]
    pub uncertainty: BTreeMap<String, Quantity>,
    #[serde(default)]
    pub columns: ColumnsTable,
    #[serde(default)]
    pub position: Vec<PositionTable>,
    #[serde(default)]
    pub mounting: Vec<MountingTable>,
    /// Standard uncertainties of parameters and groups, by name.
    #[serde(default)]
    pub prior: BTreeMap<String, PriorValue>,
}

/// The noise that a plan reckons with.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct PlanTable {
    pub noise: Option<Quantity>,
    pub floor: Option<Quantity>,
    pub duration: Option<Quantity>,
    /// The result.json of an earlier calibration of the unit.
    pub nominal: Option<std::path::PathBuf>,
}

/// What a plan is chosen from.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CandidatesTable {
    /// Radii of the seats, R0_1.
    pub radii: Vec<Quantity>,
    /// Ids of positions; all if there is none.
    #[serde(default)]
    pub positions: Vec<String>,
    pub speeds: Option<Steps>,
    /// Loads at the largest radius, in place of speeds or beside them.
    pub loads: Option<Steps>,
    #[serde(default)]
    pub rest_angles: Vec<Quantity>,
    pub durations: Vec<Quantity>,
    pub repeats: Option<usize>,
    pub max_speed: Option<Quantity>,
    pub max_load: Option<Quantity>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct CostTable {
    pub position: Option<Quantity>,
    pub seat: Option<Quantity>,
    pub ramp: Option<Quantity>,
    pub turn: Option<Quantity>,
    pub run_up: Option<Quantity>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct TargetTable {
    pub criterion: Option<String>,
    pub range: Option<Quantity>,
    pub time: Option<Quantity>,
    /// Wanted standard uncertainties by parameter, group or "reading".
    pub uncertainty: BTreeMap<String, Quantity>,
}

/// States of affairs besides the expected one.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct RobustTable {
    /// "mean" or "worst".
    pub against: Option<String>,
    pub noise: Vec<Quantity>,
    pub floor: Vec<Quantity>,
    pub extensions: Vec<String>,
}

/// A plan of a preset experiment: the whole file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PresetForm {
    #[serde(default)]
    pub session: SessionTable,
    pub plan: PresetTable,
    #[serde(default)]
    pub centrifuge: PresetCentrifugeTable,
    pub model: ModelTable,
    #[serde(default)]
    pub prior: BTreeMap<String, PriorValue>,
}

/// A preset experiment. Lengths in units of R* but `arm`, which is R*.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PresetTable {
    pub preset: String,
    pub axis_1: Option<String>,
    pub radii: Option<Vec<f64>>,
    pub levels: Option<Vec<f64>>,
    pub rest_angles: Option<Vec<Quantity>>,
    pub proof_masses: Option<[[f64; 3]; 3]>,
    pub arm: Option<Quantity>,
    pub gravity: Option<Quantity>,
    pub noise: Option<Quantity>,
    pub floor: Option<Quantity>,
    pub duration: Option<Quantity>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PresetCentrifugeTable {
    pub speed_uncertainty: Option<Quantity>,
    pub measured: Option<MeasuredTable>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct SessionTable {
    pub title: String,
    #[serde(deserialize_with = "date_as_text")]
    pub date: String,
    pub text: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SiteTable {
    pub gravity: Quantity,
    pub latitude: Option<Quantity>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct UnitTable {
    #[serde(default)]
    pub model: String,
    #[serde(default)]
    pub serial: String,
    pub output_unit: String,
    pub counts: Option<RawTable>,
    pub volts: Option<RawTable>,
    pub proof_masses: [[Quantity; 3]; 3],
    pub reference: Option<String>,
}

/// The coarse scale and bias of a raw output, in counts or volts.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawTable {
    /// Counts or volts per m/s^2.
    pub scale: [f64; 3],
    /// Counts or volts at no specific force.
    pub bias: [f64; 3],
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CentrifugeTable {
    pub speed_uncertainty: Quantity,
    pub rotation: String,
    pub tachometer_uncertainty: Option<Quantity>,
    pub measured: Option<MeasuredTable>,
}

/// How the speeds of plateaus are measured.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct MeasuredTable {
    pub from: String,
    pub uncertainty: Quantity,
    pub scale: Option<Quantity>,
    pub pulses_per_revolution: Option<f64>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ModelTable {
    pub error_model: TermList,
    pub pair_relation: String,
    #[serde(default)]
    pub extensions: Vec<String>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ColumnsTable {
    pub time: Option<ColumnEntry>,
    pub f: Option<[ColumnEntry; 3]>,
    pub telemetry_time: Option<ColumnEntry>,
    pub pulse: Option<ColumnEntry>,
    pub speed: Option<ColumnEntry>,
    pub speed_unit: Option<String>,
    /// Lines of the records, from 1, where they are not recognised; and of the telemetry.
    pub header_line: Option<u64>,
    pub first_row: Option<u64>,
    pub telemetry_header_line: Option<u64>,
    pub telemetry_first_row: Option<u64>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PositionTable {
    #[serde(deserialize_with = "name_or_number")]
    pub id: String,
    pub axes: Option<String>,
    pub matrix: Option<[[f64; 3]; 3]>,
    pub pair: Option<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct MountingTable {
    #[serde(deserialize_with = "name_or_number")]
    pub position: String,
    pub arm: [Quantity; 3],
    pub record: Option<RecordEntry>,
    pub telemetry: Option<String>,
    pub pulses: Option<String>,
    #[serde(default)]
    pub plateaus: Vec<PlateauEntry>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PlateauEntry {
    pub speed: Quantity,
    pub speed_uncertainty: Option<Quantity>,
    pub angle: Option<Quantity>,
    pub duration: Option<Quantity>,
}
