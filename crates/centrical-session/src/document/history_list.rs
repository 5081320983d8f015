//! The calibrations of a store, a line each: schema `centrical-history-list/1`.

use serde::Serialize;

use super::json;
use super::result::Program;
use crate::store::{Row, Status};

/// Name of the schema's present version.
pub(crate) const HISTORY_LIST_SCHEMA: &str = "centrical-history-list/1";

/// The calibrations of a store.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HistoryList {
    /// `centrical-history-list/1`.
    pub schema: &'static str,
    /// What made it.
    pub program: Program,
    /// Folder of the store, as it was given.
    pub store: String,
    /// The calibrations by unit and day, and sessions that failed and have no later row.
    pub calibrations: Vec<HistoryLine>,
    /// What may not be meant, if the store was checked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub doubts: Option<Vec<Doubt>>,
}

/// Something in a store that may not be meant.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Doubt {
    /// What it is.
    pub kind: DoubtKind,
    /// Keys of the calibrations; of [`DoubtKind::Spelling`] the units, model and serial number, or the stations.
    pub of: Vec<String>,
}

/// What may not be meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum DoubtKind {
    /// Units or stations whose names differ in no more than spaces, hyphens, case, leading zeros, or Cyrillic for Latin letters.
    Spelling,
    /// Results of the same files.
    SameInputs,
    /// Results of one unit and day from other files.
    SameDay,
    /// A date that is not a day.
    NoDay,
    /// A day that is still to come.
    Ahead,
    /// A day before 1980.
    LongAgo,
    /// No copy of the result.
    Missing,
    /// A copy that is not what was added.
    Changed,
    /// A row that is not what its copy says.
    RowChanged,
}

/// One calibration.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HistoryLine {
    /// SHA-256 of `result.json`.
    pub key: String,
    /// Whether there is a result.
    pub status: Status,
    /// Model of the unit.
    pub unit_model: String,
    /// Serial number of the unit.
    pub unit_serial: String,
    /// Title of the session.
    pub title: String,
    /// Date as the session writes it.
    pub date: String,
    /// Name of the station; empty if none is stated.
    pub station: String,
    /// Whether the result is acceptable; null of a failure.
    pub acceptable: Option<bool>,
    /// Names of the objections.
    pub objections: Vec<String>,
    /// Weighted sum of squared residuals; null of a failure.
    pub chi_squared: Option<f64>,
    /// Its degrees of freedom.
    pub degrees_of_freedom: i64,
    /// Why there is no result.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub message: Option<String>,
}

impl HistoryLine {
    /// chi^2 per degree of freedom; `None` of a failure, and without redundancy.
    pub fn ratio(&self) -> Option<f64> {
        self.chi_squared.filter(|_| self.degrees_of_freedom > 0).map(|c| c / self.degrees_of_freedom as f64)
    }
}

impl HistoryList {
    /// The rows of the store in `folder`, in the order of unit, day and key.
    pub(crate) fn new(folder: &str, mut rows: Vec<Row>) -> Self {
        rows.sort_by(|a, b| {
            let order = |row: &Row| (row.day, row.date.clone());
            let of_unit = (&a.unit_model, &a.unit_serial).cmp(&(&b.unit_model, &b.unit_serial));
            of_unit.then_with(|| order(a).cmp(&order(b))).then_with(|| a.key.cmp(&b.key))
        });
        let calibrations = rows.into_iter().map(HistoryLine::new).collect();
        Self {
            schema: HISTORY_LIST_SCHEMA,
            program: Program::this(),
            store: folder.to_owned(),
            calibrations,
            doubts: None,
        }
    }

    /// Number of sessions without a result.
    pub fn failed(&self) -> usize {
        self.calibrations.iter().filter(|line| line.status == Status::Failed).count()
    }
}

impl HistoryLine {
    fn new(row: Row) -> Self {
        let is_done = row.status == Status::Done;
        Self {
            status: row.status,
            acceptable: is_done.then_some(row.acceptable),
            chi_squared: json::finite(row.chi_squared).filter(|_| is_done),
            degrees_of_freedom: row.degrees_of_freedom,
            message: (!is_done).then_some(row.failure.message),
            key: row.key,
            unit_model: row.unit_model,
            unit_serial: row.unit_serial,
            title: row.title,
            date: row.date,
            station: row.station,
            objections: row.objections,
        }
    }
}
