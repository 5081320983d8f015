//! What records show beside their means, in the experiment file of a session that is reduced to these: JSON in
//! `record_findings`.

use serde::{Deserialize, Serialize};

use super::json;
use super::result::{CalibrationResult, SpeedsSummary};
use super::steadiness::{DriftSummary, TiltSummary};
use crate::error::{Error, Place};
use crate::experiment::Session;

/// What calibrating the records found in them, in the forms of `result.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct RecordFindings {
    /// How the readings drifted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    drift: Option<DriftSummary>,
    /// The tilt at rest and while spinning.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    tilt: Option<TiltSummary>,
    /// What the measured speeds say of the schedule.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    speeds: Option<SpeedsSummary>,
}

impl RecordFindings {
    /// Those of a result; none where it has none.
    pub fn of(result: &CalibrationResult) -> Option<Self> {
        let found = Self { drift: result.drift.clone(), tilt: result.tilt, speeds: result.speeds.clone() };
        let has_any = found.drift.is_some() || found.tilt.is_some() || found.speeds.is_some();
        has_any.then_some(found)
    }

    /// Those that a reduced session states; none of one with records.
    ///
    /// # Errors
    /// [`Error`] when they are not of this form.
    pub fn stated(session: &Session) -> Result<Option<Self>, Error> {
        let Some(text) = &session.record_findings else { return Ok(None) };
        let refused = |error: serde_json::Error| {
            let expected = "what `centrical reduce` writes there";
            Error::content(&session.file, Place::Whole, format!("record_findings with {error}"), expected)
        };
        serde_json::from_str(text).map(Some).map_err(refused)
    }

    /// Their text in an experiment file.
    ///
    /// # Errors
    /// [`Error::Json`] when a value has no place in JSON.
    pub fn to_json(&self) -> Result<String, Error> {
        json::document("record_findings", self)
    }

    /// A result of the means with what the records show beside them.
    pub fn added_to(self, result: CalibrationResult) -> CalibrationResult {
        CalibrationResult {
            drift: result.drift.or(self.drift),
            tilt: result.tilt.or(self.tilt),
            speeds: with_findings(result.speeds, self.speeds),
            ..result
        }
    }
}

/// What is known of the speeds, with what was found in the records where the means show no such thing.
fn with_findings(of_means: Option<SpeedsSummary>, of_records: Option<SpeedsSummary>) -> Option<SpeedsSummary> {
    match (of_means, of_records) {
        (Some(of_means), Some(of_records)) if of_means.findings.is_empty() => {
            Some(SpeedsSummary { findings: of_records.findings, ..of_means })
        }
        (of_means, of_records) => of_means.or(of_records),
    }
}
