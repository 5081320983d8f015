//! What records show beside their means, in the experiment file of a session that is reduced to these: JSON in
//! `record_findings`.

use centrical::uncertainty::Test;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::result::{CalibrationResult, SpeedsSummary};
use super::steadiness::{DriftSummary, TiltSummary};
use crate::error::{Error, Place};
use crate::experiment::Session;
use crate::settings::from_json_under;

/// Probabilities that differ by less are the same, whatever computed them.
const SAME_PROBABILITY: f64 = 1e-6;

/// The key that they stand under.
pub(super) const KEY: &str = "record_findings";

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
        let found = Self { drift: result.drift.clone(), tilt: result.tilt.clone(), speeds: result.speeds.clone() };
        let has_any = found.drift.is_some() || found.tilt.is_some() || found.speeds.is_some();
        has_any.then_some(found)
    }

    /// Those that a reduced session states; none of one with records.
    ///
    /// # Errors
    /// [`Error`] when they are not of this form.
    pub fn stated(session: &Session) -> Result<Option<Self>, Error> {
        let Some(text) = &session.record_findings else { return Ok(None) };
        let expected = "what `centrical reduce` writes there";
        let findings: Self = from_json_under(&session.file, KEY, text, expected)?;
        let numbers = from_json_under(&session.file, KEY, text, expected)?;
        match impossible(KEY, &numbers).or_else(|| findings.contradiction()) {
            Some((found, expected)) => Err(Error::content(&session.file, Place::Whole, found, expected)),
            None => Ok(Some(findings)),
        }
    }

    /// A probability that is not that of its chi^2.
    fn contradiction(&self) -> Option<(String, String)> {
        let of_drift = self.drift.as_ref().map(|drift| {
            ("drift", drift.probability, Test::chi_squared(drift.chi_squared, drift.degrees_of_freedom).probability)
        });
        let of_tilt = self
            .tilt
            .as_ref()
            .map(|tilt| ("tilt", tilt.probability, Test::chi_squared(tilt.chi_squared, 1).probability));
        let is_other = |(_, found, expected): &(&str, f64, f64)| (found - expected).abs() > SAME_PROBABILITY;
        let (name, found, expected) = of_drift.into_iter().chain(of_tilt).find(is_other)?;
        Some((format!("{KEY}.{name}.probability = {found:e}"), format!("{expected:e}, that of its chi_squared")))
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

/// The first number of a document that its key rules out: a probability outside 0 to 1, or a negative uncertainty or chi^2. What was found, and
/// what was expected.
fn impossible(name: &str, document: &Value) -> Option<(String, String)> {
    first(name, name, document)
}

/// The first one at `path`, under `key`.
fn first(path: &str, key: &str, value: &Value) -> Option<(String, String)> {
    match value {
        Value::Number(number) => {
            let number = number.as_f64()?;
            let found = || format!("{path} = {number:e}");
            if key.ends_with("probability") && !(0.0..=1.0).contains(&number) {
                Some((found(), "a probability from 0 to 1".to_owned()))
            } else if number < 0.0 && ["uncertainty", "chi_squared"].iter().any(|end| key.ends_with(end)) {
                Some((found(), "zero or more".to_owned()))
            } else {
                None
            }
        }
        Value::Array(values) => {
            values.iter().enumerate().find_map(|(n, value)| first(&format!("{path}[{n}]"), key, value))
        }
        Value::Object(entries) => entries.iter().find_map(|(key, value)| first(&format!("{path}.{key}"), key, value)),
        _ => None,
    }
}
