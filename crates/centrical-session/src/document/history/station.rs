//! One centrifuge over its sessions, as a JSON document: schema `centrical-station-history/1`.

use centrical::Group;
use centrical::uncertainty::Level;
use serde::Serialize;

use crate::document::result::Program;
use crate::quantity::Date;

/// Name of the schema's present version.
pub(crate) const STATION_HISTORY_SCHEMA: &str = "centrical-station-history/1";

/// The history of a station.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StationHistoryReport {
    /// `centrical-station-history/1`.
    pub schema: &'static str,
    /// What made it.
    pub program: Program,
    /// The centrifuge, as its sessions call it.
    pub station: String,
    /// Number of sessions.
    pub sessions: usize,
    /// Number of units in them.
    pub units: usize,
    /// First day.
    pub first: Date,
    /// Last day.
    pub last: Date,
    /// Whether no parameter of the machine changed; null where the sessions test none.
    pub is_steady: Option<bool>,
    /// The parameters of the machine.
    pub parameters: Vec<StationParameter>,
}

/// One parameter of the machine, SI. Tests are null below eight sessions that count.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StationParameter {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// tilt, turn, shift, ...
    #[serde(serialize_with = "crate::document::json::serialize")]
    pub group: Group,
    /// Sessions that determine it.
    pub sessions: usize,
    /// Mean over them.
    pub mean: f64,
    /// Standard deviation over them, with what units bring along.
    pub scatter: f64,
    /// Slope per year, what units bring along left out.
    pub slope_per_year: Option<f64>,
    /// Its standard uncertainty.
    pub slope_uncertainty: Option<f64>,
    /// Probability of so large a slope of a steady machine.
    pub slope_probability: Option<f64>,
    /// Day of the session after which the values changed most, if they changed at once.
    pub changed_after: Option<Date>,
    /// Mean after it less mean before.
    pub change: Option<f64>,
    /// Probability of so large a cumulative sum of a steady machine.
    pub change_probability: Option<f64>,
    /// Day of the session farthest from the mean.
    pub farthest: Option<Date>,
    /// How far.
    pub distance: Option<f64>,
    /// Probability of a session as far off on a steady machine.
    pub farthest_probability: Option<f64>,
    /// Probability of sessions that resemble those before them as much on a steady machine.
    pub succession_probability: Option<f64>,
    /// Scatter over the mean stated uncertainty: well above 1 for what mounting brings along.
    pub scatter_ratio: f64,
    /// Whether units came one after another, so that a machine that changes with them does not show it: not tested.
    pub is_confounded: bool,
    /// Probability of any of the four.
    pub probability: Option<f64>,
    /// Whether that is beyond 5 %, all parameters together (Holm).
    pub changes: bool,
}

impl StationParameter {
    /// Whether a single session is less likely than all else that was tested.
    pub fn stands_out(&self) -> bool {
        let others = self.lasting().min(self.succession_probability.unwrap_or(1.0));
        self.farthest_probability.is_some_and(|single| single < others)
    }

    /// Whether sessions resemble those before them, and neither a slope nor a change at once explains it.
    pub fn wanders(&self) -> bool {
        let is_explained = Level::Reported.is_passed_by(4.0 * self.lasting());
        self.succession_probability.is_some_and(|succession| succession < self.farthest_probability.unwrap_or(1.0))
            && !is_explained
    }

    /// Probability of the less likely of slope and change.
    fn lasting(&self) -> f64 {
        self.slope_probability.unwrap_or(1.0).min(self.change_probability.unwrap_or(1.0))
    }
}
