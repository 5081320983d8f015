//! The tables of `experiment.toml` as they are written. Every key is known here: one that is not is an error.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;

use super::entries::{AttitudeList, ColumnEntry, PriorValue, RecordEntry, TermList, date_as_text, name_or_number};
use super::entry_schemas;
use super::plan_tables::{CandidatesTable, CostTable, PlanTable, RobustTable, TargetTable};
use crate::quantity::Quantity;
use crate::record::MissingReadings;

/// The whole file.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Form {
    /// Path of a table of plateaus already averaged.
    pub plateaus: Option<String>,
    /// What the records showed beside these means, JSON as `centrical reduce` writes it.
    pub record_findings: Option<String>,
    /// What is planned, where nothing is measured yet.
    pub plan: Option<PlanTable>,
    /// What a plan is chosen from.
    pub candidates: Option<CandidatesTable>,
    /// What a plan costs.
    #[serde(default)]
    pub cost: CostTable,
    /// What a plan is for.
    #[serde(default)]
    pub target: TargetTable,
    /// What a plan must be good for.
    #[serde(default)]
    pub robust: RobustTable,
    /// Texts for the report.
    #[serde(default)]
    pub session: SessionTable,
    /// The place.
    pub site: SiteTable,
    /// The unit under calibration.
    pub unit: UnitTable,
    /// The machine; a session of rests alone has none.
    pub centrifuge: Option<CentrifugeTable>,
    /// The error model of the unit.
    pub model: ModelTable,
    /// Standard uncertainties of quantities that the model takes as exact (type B), by name.
    #[serde(default)]
    pub uncertainty: BTreeMap<String, Quantity>,
    /// Columns of the records and of the telemetry.
    #[serde(default)]
    pub columns: ColumnsTable,
    /// Attitudes of the unit on the arm.
    #[serde(default)]
    pub position: Vec<PositionTable>,
    /// The schedule of the mountings that have none of their own.
    #[serde(default)]
    pub schedule: ScheduleTable,
    /// Installations of the unit, in the order of the session.
    #[serde(default)]
    pub mounting: Vec<MountingTable>,
    /// Rests in any attitudes, by hand or on a table, beside the centrifuge or without one.
    #[serde(default)]
    pub tumble: Vec<TumbleTable>,
    /// Standard uncertainties of parameters and groups, by name.
    #[serde(default)]
    pub prior: BTreeMap<String, PriorValue>,
}

/// A plan of a preset experiment: the whole file.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PresetForm {
    /// Texts for the report.
    #[serde(default)]
    pub session: SessionTable,
    /// The preset experiment.
    pub plan: PresetTable,
    /// The machine.
    #[serde(default)]
    pub centrifuge: PresetCentrifugeTable,
    /// The error model of the unit.
    pub model: ModelTable,
    /// Rests in any attitudes beside it.
    #[serde(default)]
    pub tumble: Vec<TumbleTable>,
    /// Standard uncertainties of parameters and groups, by name.
    #[serde(default)]
    pub prior: BTreeMap<String, PriorValue>,
}

/// A plan: the form of a session, or that of a preset experiment.
#[derive(JsonSchema)]
#[schemars(untagged)]
#[expect(dead_code, reason = "it describes the files; each is read by the form that it names")]
pub(crate) enum PlanForm {
    OfSession(Box<Form>),
    OfPreset(Box<PresetForm>),
}

/// A preset experiment. Lengths in units of R* but `arm`, which is R*.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PresetTable {
    /// Name of the experiment: `kozlov-2017`.
    pub preset: String,
    /// Attitude of the first sensitive axis: `up` or `down`.
    pub axis_1: Option<String>,
    /// Radii of the seats over R*.
    pub radii: Option<Vec<f64>>,
    /// Loads over that of the fastest speed.
    pub levels: Option<Vec<f64>>,
    /// Angles of plateaus at rest.
    pub rest_angles: Option<Vec<Quantity>>,
    /// Places of the proof masses over R*.
    pub proof_masses: Option<[[f64; 3]; 3]>,
    /// R*, the length of the arm.
    pub arm: Option<Quantity>,
    /// Acceleration of gravity.
    pub gravity: Option<Quantity>,
    /// Noise density of the readings.
    pub noise: Option<Quantity>,
    /// Noise that does not fall with time.
    pub floor: Option<Quantity>,
    /// Duration of a plateau.
    pub duration: Option<Quantity>,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PresetCentrifugeTable {
    /// Relative standard uncertainty with which the speed of a plateau is set.
    pub speed_uncertainty: Option<Quantity>,
    /// How the speeds of plateaus are measured.
    pub measured: Option<MeasuredTable>,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct SessionTable {
    /// Title of the report.
    pub title: String,
    /// Date of the session.
    #[serde(deserialize_with = "date_as_text")]
    #[schemars(schema_with = "entry_schemas::date_or_text")]
    pub date: String,
    /// Free text for the report.
    pub text: String,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SiteTable {
    /// Acceleration of gravity at the place, such as "9.81523 m/s^2".
    pub gravity: Quantity,
    /// Geographic latitude; with it the Earth-rate term is applied.
    pub latitude: Option<Quantity>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct UnitTable {
    /// Model of the unit.
    #[serde(default)]
    pub model: String,
    /// Serial number.
    #[serde(default)]
    pub serial: String,
    /// Unit of the readings: "m/s^2", "g" (9.80665 m/s^2), "counts" or "V".
    pub output_unit: String,
    /// Nominal scale and bias, where the readings are counts.
    pub counts: Option<RawTable>,
    /// Nominal scale and bias, where the readings are volts.
    pub volts: Option<RawTable>,
    /// Places of the three proof masses in instrument axes; of no meaning where nothing is on an arm.
    pub proof_masses: Option<[[Quantity; 3]; 3]>,
    /// What the places are relative to: "first-proof-mass" (default; the first is zero) or "own-axes".
    pub reference: Option<String>,
}

/// The coarse scale and bias of a raw output, in counts or volts.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawTable {
    /// Counts or volts per m/s^2.
    pub scale: [f64; 3],
    /// Counts or volts at no specific force.
    pub bias: [f64; 3],
    /// Whether both were found in the records of this session, by `centrical tumble`, and are no values of a data sheet.
    #[serde(default)]
    pub found: bool,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct CentrifugeTable {
    /// Relative standard uncertainty with which the speed of a plateau is set, such as "10 ppm".
    pub speed_uncertainty: Quantity,
    /// Sense of positive speeds about the third arm axis: "+3" (right-handed) or "-3".
    pub rotation: String,
    /// Name of the station, the centrifuge with its fixtures, for the history of a unit.
    #[serde(default)]
    pub station: String,
    /// Relative standard uncertainty of the scale of the telemetry, for its comparison with the schedule.
    pub tachometer_uncertainty: Option<Quantity>,
    /// How the speeds of plateaus are measured, where the fit is to use measured speeds.
    pub measured: Option<MeasuredTable>,
}

/// How the speeds of plateaus are measured.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct MeasuredTable {
    /// "telemetry", "pulses", or "plateaus".
    pub from: String,
    /// Relative standard uncertainty of each plateau's speed, independent from plateau to plateau.
    pub uncertainty: Quantity,
    /// Relative standard uncertainty of the scale common to all speeds.
    pub scale: Option<Quantity>,
    /// Pulses in a revolution; 1 if absent.
    pub pulses_per_revolution: Option<f64>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ModelTable {
    /// Name of an error model, or a list of terms.
    pub error_model: TermList,
    /// Errors of place in the two positions of a pair: "common" (of the seat), "opposite" (of the unit) or "free".
    /// Of no meaning where nothing is on an arm.
    pub pair_relation: Option<String>,
    /// Effects beyond the model that are unknowns.
    #[serde(default)]
    pub extensions: Vec<String>,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ColumnsTable {
    /// Time of the records.
    pub time: Option<ColumnEntry>,
    /// The three readings.
    pub f: Option<[ColumnEntry; 3]>,
    /// Time of the telemetry; that of the records if absent.
    pub telemetry_time: Option<ColumnEntry>,
    /// Times of pulses.
    pub pulse: Option<ColumnEntry>,
    /// Speed of the telemetry.
    pub speed: Option<ColumnEntry>,
    /// Unit of the speed.
    pub speed_unit: Option<String>,
    /// Line of a record with the names of its columns, from 1, where it is not recognised.
    pub header_line: Option<u64>,
    /// Line of the first row of a record, where it is not recognised.
    pub first_row: Option<u64>,
    /// Line of the telemetry with the names of its columns.
    pub telemetry_header_line: Option<u64>,
    /// Line of the first row of the telemetry.
    pub telemetry_first_row: Option<u64>,
    /// Rows of records that lack a reading are refused if absent.
    #[serde(default)]
    pub missing_readings: MissingReadings,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PositionTable {
    /// Name of the position.
    #[serde(deserialize_with = "name_or_number")]
    #[schemars(schema_with = "entry_schemas::name_or_number")]
    pub id: String,
    /// Arm axes along which the instrument axes 1, 2, 3 point, such as "+2 -3 +1".
    pub axes: Option<String>,
    /// Direction cosines in place of `axes`: rows are instrument axes in arm axes.
    pub matrix: Option<[[f64; 3]; 3]>,
    /// Positions with the same name here share the errors of place.
    pub pair: Option<String>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct MountingTable {
    /// Name of the position.
    #[serde(deserialize_with = "name_or_number")]
    #[schemars(schema_with = "entry_schemas::name_or_number")]
    pub position: String,
    /// Nominal place of the reference point in arm axes.
    pub arm: [Quantity; 3],
    /// File of the readings, or three files, one for each newtonometer.
    pub record: Option<RecordEntry>,
    /// File of the speed against time.
    pub telemetry: Option<String>,
    /// File of the times of pulses.
    pub pulses: Option<String>,
    /// The schedule in order.
    #[serde(default)]
    pub plateaus: Vec<PlateauEntry>,
}

/// Rests in attitudes of their own, which only gravity shows or which are known. Without `rests` and `record` they are planned.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct TumbleTable {
    /// Path of a table of rests, such as `centrical tumble` writes: the columns of a table of plateaus.
    pub rests: Option<String>,
    /// File of the readings while the unit is turned and left alone again and again, or three files, one for each newtonometer. The
    /// rests are found in it.
    pub record: Option<RecordEntry>,
    /// Largest distance of the proof masses from the axes of a slow rotation, whose arcs count as rests of the record.
    pub turning_radius: Option<Quantity>,
    /// Attitudes of the rests, up in axes of the case: "cube", a list of directions, or the path of a table. Those of a plan, or those
    /// that are known of measured rests.
    pub attitudes: Option<AttitudeList>,
    /// Duration of each planned rest; that of [plan] if absent.
    pub duration: Option<Quantity>,
    /// Durations of the planned rests one by one.
    #[serde(default)]
    pub durations: Vec<Quantity>,
    /// Standard uncertainty of these attitudes about each horizontal axis, such as "0.1 deg".
    pub attitude_uncertainty: Option<Quantity>,
    /// Standard uncertainty of the change of each bias between these rests and the arm, or else the first rests; that of [uncertainty] if
    /// absent.
    pub bias_change: Option<Quantity>,
    /// Name of the time through which the unit was on without a break, if it is that of other rests too.
    pub switch_on: Option<String>,
    /// Variance of the means of the table at most, over the one that it states: the colour of their noise is known poorly. 1 if absent.
    pub noise_at_most: Option<f64>,
    /// Slow rotation among the rests of the table.
    pub turning: Option<TurningTable>,
}

/// Arcs of slow rotation that count as rests, such as `centrical tumble --turning-radius` writes them.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct TurningTable {
    /// Number of arcs among the rests.
    pub arcs: usize,
    /// Their part of all weight along the force, 0 to 1.
    pub share: f64,
    /// Fastest rotation of the force against the unit.
    pub rate: Quantity,
    /// Largest distance of the proof masses from the axes of rotation.
    pub radius: Quantity,
    /// Standard uncertainty of the acceleration along the vertical in the arc where it is largest: it follows from the distance and the
    /// columns `bend_1` to `bend_3` of the table of rests.
    pub acceleration: Quantity,
}

/// The schedule common to mountings.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct ScheduleTable {
    /// Plateaus in order.
    pub plateaus: Vec<PlateauEntry>,
}

impl Form {
    /// Whether the unit is on the arm: it is not where rests alone are stated.
    pub fn has_arm(&self) -> bool {
        let has_rests = self.candidates.as_ref().is_some_and(|candidates| candidates.attitudes.is_some());
        !has_rests && self.tumble.is_empty() || !self.mounting.is_empty() || !self.position.is_empty()
    }

    /// The form with the common schedule in every mounting that has none of its own.
    pub fn with_schedules(mut self) -> Self {
        for mounting in self.mounting.iter_mut().filter(|mounting| mounting.plateaus.is_empty()) {
            mounting.plateaus.clone_from(&self.schedule.plateaus);
        }
        self
    }
}

#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PlateauEntry {
    /// Speed, negative against `rotation`; 0 at rest.
    pub speed: Quantity,
    /// Relative standard uncertainty of a speed that was measured.
    pub speed_uncertainty: Option<Quantity>,
    /// Angle of the arm, at rest.
    pub angle: Option<Quantity>,
    /// Duration, in a plan.
    pub duration: Option<Quantity>,
}
