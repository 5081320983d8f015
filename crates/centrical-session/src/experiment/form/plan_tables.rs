//! The tables of `experiment.toml` that a plan has besides.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;

use super::entries::{AttitudeList, Steps};
use crate::quantity::Quantity;

/// The noise that a plan assumes.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct PlanTable {
    /// Noise density of the readings, such as "20 ug/sqrt(Hz)".
    pub noise: Option<Quantity>,
    /// Noise of a plateau mean that does not fall with time.
    pub floor: Option<Quantity>,
    /// Duration of a plateau.
    pub duration: Option<Quantity>,
    /// The result.json of an earlier calibration of the unit.
    pub nominal: Option<std::path::PathBuf>,
}

/// What a plan is chosen from.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct CandidatesTable {
    /// Radii of the seats, R0_1.
    #[serde(default)]
    pub radii: Vec<Quantity>,
    /// Ids of positions; all if absent.
    #[serde(default)]
    pub positions: Vec<String>,
    /// Speeds of plateaus: a list, or equal steps.
    pub speeds: Option<Steps>,
    /// Loads at the largest radius, in place of speeds or beside them.
    pub loads: Option<Steps>,
    /// Angles of plateaus at rest.
    #[serde(default)]
    pub rest_angles: Vec<Quantity>,
    /// Attitudes of rests beside the arm, up in axes of the case: "cube", a list of directions, or the path of a table.
    pub attitudes: Option<AttitudeList>,
    /// Standard uncertainty of these attitudes about each horizontal axis; without it only gravity shows them.
    pub attitude_uncertainty: Option<Quantity>,
    /// Durations of a plateau.
    pub durations: Vec<Quantity>,
    /// Visits of one plateau at most; 1 if absent.
    pub repeats: Option<usize>,
    /// The fastest speed that the machine bears.
    pub max_speed: Option<Quantity>,
    /// The largest load that the unit bears.
    pub max_load: Option<Quantity>,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct CostTable {
    /// Time of a change of position with the first seating in it.
    pub position: Option<Quantity>,
    /// Time of a change to another radius in the same position.
    pub seat: Option<Quantity>,
    /// Time to a speed, with its settling, for each visit.
    pub ramp: Option<Quantity>,
    /// Time to an angle at rest, for each visit.
    pub turn: Option<Quantity>,
    /// Time from rest to the fastest speed and back, for each mounting.
    pub run_up: Option<Quantity>,
    /// Time to move the unit from the arm to the table, once for all rests beside the arm.
    pub table: Option<Quantity>,
    /// Time to lay the unit down in another attitude, for each rest beside the arm.
    pub attitude: Option<Quantity>,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct TargetTable {
    /// `I` (mean variance of the compensated reading), `A`, `D`, or `worst`; `I` if absent.
    pub criterion: Option<String>,
    /// Largest magnitude of specific force for the compensated reading; 200 g if absent.
    pub range: Option<Quantity>,
    /// Time available; without it the shortest plan that reaches the goals is sought.
    pub time: Option<Quantity>,
    /// Wanted standard uncertainties by parameter, group or "reading".
    pub uncertainty: BTreeMap<String, Quantity>,
}

/// States of affairs besides the expected one.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct RobustTable {
    /// "mean" or "worst".
    pub against: Option<String>,
    /// Noise densities of further scenarios.
    pub noise: Vec<Quantity>,
    /// Noise floors of further scenarios.
    pub floor: Vec<Quantity>,
    /// Extensions that are unknowns in one further scenario.
    pub extensions: Vec<String>,
}
