//! One unit over its calibrations, as a JSON document: schema `centrical-unit-history/1`.

use std::collections::BTreeMap;

use centrical::Group;
use centrical::uncertainty::Level;
use serde::Serialize;

use crate::document::result::Program;
use crate::quantity::Date;

/// Name of the schema's present version.
pub(crate) const UNIT_HISTORY_SCHEMA: &str = "centrical-unit-history/1";

/// A calibration in a history.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PastSession {
    /// Its file, or its key in a store.
    pub source: String,
    /// Model of the unit.
    pub unit_model: String,
    /// Serial number of the unit.
    pub unit_serial: String,
    /// The centrifuge.
    pub station: String,
    /// Day.
    pub date: Date,
    /// The same as the session states it, where that says more than the day.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stamp: Option<String>,
    /// Gravity at the place, as stated [m/s^2], where it is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gravity: Option<f64>,
    /// Whether no check raised an objection.
    pub acceptable: bool,
}

/// A calibration that lacks parameters of others.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LeftOutSession {
    /// The calibration.
    #[serde(flatten)]
    pub session: PastSession,
    /// Parameters of the others that it does not determine.
    pub lacks: Vec<String>,
}

/// The history of a unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UnitHistoryReport {
    /// `centrical-unit-history/1`.
    pub schema: &'static str,
    /// What made it.
    pub program: Program,
    /// Model of the unit.
    pub unit_model: String,
    /// Serial number of the unit.
    pub unit_serial: String,
    /// Its calibrations that are compared, in the order of time.
    pub sessions: Vec<PastSession>,
    /// Those among them that do not determine all parameters: the others are compared.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub incomplete: Vec<LeftOutSession>,
    /// Those that determine no parameter that another one does.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub left_out: Vec<LeftOutSession>,
    /// Parameters of the last calibration that the others do not determine.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub not_compared: Vec<String>,
    /// Parameters that earlier calibrations determine and the last one does not.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub not_in_last: Vec<String>,
    /// Whether parameters may drift.
    pub trend: bool,
    /// Probability of all intervals.
    pub coverage: f64,
    /// Units whose sessions give the component between sessions.
    pub units_together: usize,
    /// Day of the forecasts.
    pub until: Date,
    /// All parameters together.
    pub sameness: Option<SamenessSummary>,
    /// The parameters that two calibrations or more determine.
    pub parameters: Vec<UnitParameter>,
    /// Largest specific force of the readings below [m/s^2].
    pub range: f64,
    /// Largest error of a compensated reading [m/s^2], if one was given.
    pub limit: Option<f64>,
    /// The day that the next is of: that of the last calibration or a later one.
    pub on: Date,
    /// Whether the last date is later than tomorrow: a wrong clock, or day and month exchanged.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub ahead: bool,
    /// Whether a reading compensated by the last calibration is within the limit after a switch-on that day; null without a limit, where
    /// some readings are not determined and none is beyond, and on a day after calibrations that show no drift.
    pub is_within: Option<bool>,
    /// The first due date of all readings; null where some are not determined, or the calibrations show no drift, unless one is overdue.
    pub due: Option<DueDate>,
    /// The day at which the search for a due date ended; null where some readings are not determined, or the
    /// calibrations show no drift: two, or those of one day.
    pub due_after: Option<Date>,
    /// Compensated readings, those that two calibrations or more determine.
    pub readings: Vec<ReadingHistory>,
}

/// Whether the unit was the same in all sessions: all parameters together, with their full covariances.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SamenessSummary {
    /// chi^2 of the differences from one common unit.
    pub chi_squared: f64,
    /// Its degrees of freedom.
    pub degrees_of_freedom: usize,
    /// Probability of so large a chi^2 if only the stated errors differ.
    pub probability: f64,
    /// The session that deviates most from the others; null of two sessions.
    pub farthest: Option<DeviatingSession>,
}

/// The session that deviates most from the others of its unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DeviatingSession {
    /// The file, or the key in a store.
    pub source: String,
    /// Day.
    pub date: Date,
    /// Probability that by the stated errors any session deviates as much.
    pub probability: f64,
    /// Probability of so large a chi^2 of the others without it.
    pub probability_of_others: f64,
    /// Probability that by the scatter of the others any session deviates as much.
    pub probability_by_scatter: f64,
}

/// One parameter over the sessions, SI.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UnitParameter {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// bias, scale, misalignment, ...
    #[serde(serialize_with = "crate::document::json::serialize")]
    pub group: Group,
    /// Value in each session; null where the session does not determine it.
    pub values: Vec<Option<f64>>,
    /// Combined standard uncertainty in each session.
    pub standard_uncertainties: Vec<Option<f64>>,
    /// Standard deviation between sessions beside the stated uncertainties; null where the sessions do not determine it.
    pub between: Option<f64>,
    /// Its interval.
    pub between_interval: Option<[f64; 2]>,
    /// Scatter over the one that the stated uncertainties explain, in squares: F.
    pub variance_ratio: Option<f64>,
    /// Degrees of freedom of F.
    pub degrees_of_freedom: Option<usize>,
    /// Probability of so large an F without a component between sessions.
    pub probability: Option<f64>,
    /// Whether that is beyond 5 %, all parameters together (Holm).
    pub scatters: bool,
    /// Slope per year.
    pub slope_per_year: Option<f64>,
    /// Its standard uncertainty.
    pub slope_uncertainty: Option<f64>,
    /// Its interval.
    pub slope_interval: Option<[f64; 2]>,
    /// Probability of so large a slope without drift.
    pub slope_probability: Option<f64>,
    /// Whether that is beyond 5 %, all parameters together (Holm).
    pub drifts: bool,
    /// Where it drifts or scatters: the days of two sessions between which a step explains the values better than a line in time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<[Date; 2]>,
    /// Interval of the true value after a switch-on on the day of the forecasts.
    pub forecast: Option<[f64; 2]>,
    /// Last less previous calibration that determines it over the expanded uncertainty (k = 2), without what both share.
    pub e_n_previous: f64,
    /// The same against the first.
    pub e_n_first: f64,
}

/// A reading that the last calibration compensates.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReadingHistory {
    /// Specific force [m/s^2].
    pub force: [f64; 3],
    /// Newtonometer, 1 to 3.
    pub axis: usize,
    /// Standard uncertainty by the last calibration [m/s^2].
    pub stated: f64,
    /// Standard deviation between sessions [m/s^2].
    pub between: f64,
    /// Its interval [m/s^2].
    pub between_interval: [f64; 2],
    /// Standard uncertainty after a switch-on, `sqrt(stated^2 + 2 between^2)`: the session of the calibration and the next one deviate
    /// from their mean independently [m/s^2].
    pub after_switch_on: f64,
    /// Its expanded uncertainty for the coverage of the report, all likely components between sessions considered [m/s^2]; null but of the
    /// readings that are shown.
    pub expanded_after_switch_on: Option<f64>,
    /// When the reading leaves its limit.
    pub due: Option<DueDate>,
}

/// The last day on which a compensated reading is within its limit with the probability asked for.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DueDate {
    /// The day.
    pub date: Date,
    /// Newtonometer, 1 to 3.
    pub axis: usize,
    /// Specific force [m/s^2].
    pub force: [f64; 3],
}

/// Probability of so small a chi^2 below which sessions are not independent, or state too much.
const TOO_WELL: f64 = 1e-4;

impl UnitHistoryReport {
    /// Whether the calibrations differ by more than their stated uncertainties.
    pub fn differs(&self) -> bool {
        self.sameness.as_ref().is_some_and(|test| Level::Disagreement.is_passed_by(test.probability))
    }

    /// The session that differs from the others, where the others are the same without it, or it is too far off for their scatter.
    pub fn deviating(&self) -> Option<&DeviatingSession> {
        let farthest = self.sameness.as_ref()?.farthest.as_ref()?;
        let is_alone = Level::Disagreement.is_passed_by(farthest.probability)
            && (!Level::Disagreement.is_passed_by(farthest.probability_of_others)
                || Level::Disagreement.is_passed_by(farthest.probability_by_scatter));
        is_alone.then_some(farthest)
    }

    /// Whether the calibrations agree better than what they state allows.
    pub fn agrees_too_well(&self) -> bool {
        self.sameness.as_ref().is_some_and(|test| 1.0 - test.probability < TOO_WELL)
    }

    /// Pairs of sessions of one station, one after the other, that state gravities farther apart than tides and rounding. Sessions that
    /// name no station count as of one.
    pub fn gravities(&self) -> Vec<[&PastSession; 2]> {
        let mut last: BTreeMap<&str, &PastSession> = BTreeMap::new();
        let mut pairs = Vec::new();
        for session in self.sessions.iter().filter(|session| session.gravity.is_some()) {
            let before = last.insert(&session.station, session);
            pairs.extend(
                before.filter(|before| are_apart(before.gravity, session.gravity)).map(|before| [before, session]),
            );
        }
        pairs
    }

    /// Pairs of sessions with the same values to the last digit: one session that counts twice.
    pub fn twice(&self) -> Vec<[&PastSession; 2]> {
        let values = |n: usize| self.parameters.iter().map(move |p| p.values.get(n));
        let pairs = (0..self.sessions.len()).flat_map(|n| (0..n).map(move |m| [m, n]));
        let same = pairs.filter(|[m, n]| !self.parameters.is_empty() && values(*m).eq(values(*n)));
        same.map(|pair| pair.map(|n| &self.sessions[n])).collect()
    }

    /// Whether they differ, and are too few to say of any parameter that it scatters or drifts.
    pub fn is_unexplained(&self) -> bool {
        self.differs() && self.parameters.iter().all(|p| !p.scatters && !p.drifts)
    }

    /// The readings to show.
    pub fn shown_readings(&self) -> Vec<&ReadingHistory> {
        shown_readings(&self.readings).into_iter().map(|n| &self.readings[n]).collect()
    }

    /// Whether every reading is shown to be within its limit, where one was given, and the calibration that compensates it has no objection and
    /// no date to come.
    pub fn is_acceptable(&self) -> bool {
        (self.limit.is_none() || self.is_within == Some(true)) && self.has_acceptable_last() && !self.ahead
    }

    /// Pairs of sessions of one day, one after the other.
    pub fn same_days(&self) -> Vec<[&PastSession; 2]> {
        let pairs = self.sessions.windows(2).filter(|pair| pair[0].date == pair[1].date);
        pairs.map(|pair| [&pair[0], &pair[1]]).collect()
    }

    /// Whether the last calibration, which compensates, has no objection.
    pub fn has_acceptable_last(&self) -> bool {
        self.sessions.last().is_none_or(|session| session.acceptable)
    }
}

/// The readings to show of each newtonometer: at rest, the one least certain after a switch-on, and the one that is first due.
pub(crate) fn shown_readings(readings: &[ReadingHistory]) -> Vec<usize> {
    let mut shown = Vec::new();
    for axis in 1..=3 {
        let of_axis = || (0..readings.len()).filter(|n| readings[*n].axis == axis);
        let at_rest = of_axis().find(|n| readings[*n].force == [0.0; 3]);
        let worst = of_axis().max_by(|a, b| readings[*a].after_switch_on.total_cmp(&readings[*b].after_switch_on));
        let with_due = of_axis().filter_map(|n| Some((readings[n].due.as_ref()?.date, n)));
        let first_due = with_due.min().map(|(_, n)| n);
        for n in [at_rest, worst, first_due].into_iter().flatten() {
            if !shown.contains(&n) {
                shown.push(n);
            }
        }
    }
    shown
}

/// Whether two gravities differ by more than 1e-6 of their size: tides alter one place's by 3e-7.
fn are_apart(one: Option<f64>, other: Option<f64>) -> bool {
    one.zip(other).is_some_and(|(one, other)| (one - other).abs() > 1e-6 * other.abs())
}
