//! One calibration as one row.

use centrical::Group;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::quantity::Date;
use crate::record::hexadecimal;

/// Whether a calibration was done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// Done; acceptable or not.
    #[default]
    Done,
    /// There is no result.
    Failed,
}

/// Reason for a missing result; unknown fields are empty.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Failure {
    /// The message.
    pub message: String,
    /// The file.
    pub file: String,
    /// Place in the file.
    pub place: String,
    /// What was found.
    pub found: String,
    /// What was expected.
    pub expected: String,
}

/// A term of the error model.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TermSummary {
    /// Name of its coefficient, one of the parameters.
    pub name: String,
    /// Newtonometer it acts on: 1, 2 or 3.
    pub axis: usize,
    /// Powers of f1, f2, f3.
    pub powers: [u8; 3],
    /// Newtonometer whose sign the monomial takes, for odd terms such as `|f1| f1`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sign_of: Option<usize>,
}

/// An influence that is the same in other sessions of the station.
#[derive(Debug, Clone, PartialEq)]
pub struct SharedInfluence {
    /// Its source in the budget: "radius".
    pub source: String,
    /// Signed change of every parameter at one standard uncertainty, SI; NaN where a parameter is not estimable.
    pub changes: Vec<f64>,
}

/// A prior on a parameter of the unit.
#[derive(Debug, Clone, PartialEq)]
pub struct RowPrior {
    /// The parameter.
    pub parameter: String,
    /// Mean, SI.
    pub mean: f64,
    /// Standard uncertainty, SI.
    pub standard_uncertainty: f64,
    /// Signed change of every parameter when the mean is off by one standard uncertainty, SI; NaN where one is not estimable.
    pub changes: Vec<f64>,
}

/// A calibration as a row: what the history of a unit is made from. Fields beyond the depth that was read are empty.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Row {
    /// SHA-256 of the bytes of `result.json`, hexadecimal; of a failure, of its session and message.
    pub key: String,
    /// Whether it was done.
    pub status: Status,
    /// Why not.
    pub failure: Failure,
    /// Model of the unit.
    pub unit_model: String,
    /// Serial number of the unit.
    pub unit_serial: String,
    /// Title of the session.
    pub title: String,
    /// Date as the session writes it.
    pub date: String,
    /// The same in days since 1970-01-01, if it is a day.
    pub day: Option<i64>,
    /// Name of the station, empty if none is stated.
    pub station: String,
    /// Gravity at the place, as stated [m/s^2]; NaN in rows of older programs.
    pub gravity: f64,
    /// Version of the program.
    pub program: String,
    /// SHA-256 over the paths and hashes of the inputs, hexadecimal.
    pub inputs: String,
    /// "first-proof-mass" or "own-axes".
    pub reference: String,
    /// Largest magnitude of the specific force on each axis [m/s^2].
    pub range: Vec<f64>,
    /// How the fit ended.
    pub termination: String,
    /// Weighted sum of squared residuals; NaN of a failure.
    pub chi_squared: f64,
    /// Its degrees of freedom.
    pub degrees_of_freedom: i64,
    /// Rank of the design.
    pub rank: i64,
    /// Number of unknowns.
    pub columns: i64,
    /// Whether the result is acceptable.
    pub acceptable: bool,
    /// Names of the objections.
    pub objections: Vec<String>,
    /// Names of the parameters.
    pub parameters: Vec<String>,
    /// Their units, SI.
    pub units: Vec<String>,
    /// Their groups.
    pub groups: Vec<Group>,
    /// Estimates, SI; NaN where not estimable.
    pub values: Vec<f64>,
    /// Combined standard uncertainties, SI; NaN where not estimable.
    pub standard_uncertainties: Vec<f64>,
    /// Combined covariance, the lower triangle by rows; NaN where not estimable.
    pub covariance: Vec<f64>,
    /// Unit of the raw output, empty of readings in m/s^2.
    pub output_unit: String,
    /// Nominal scale of each newtonometer [raw unit per m/s^2], and raw output of each at no specific force: three each, if any.
    pub output_scale: Vec<f64>,
    /// See `output_scale`.
    pub output_bias: Vec<f64>,
    /// The error model.
    pub terms: Vec<TermSummary>,
    /// Whether the result says which influences are shared: not one of an older program.
    pub shared_known: bool,
    /// What they leave.
    pub shared: Vec<SharedInfluence>,
    /// Whether the result says what priors leave: not one of an older program.
    pub priors_known: bool,
    /// Priors on parameters of the unit.
    pub priors: Vec<RowPrior>,
}

impl Row {
    /// The row of a session without a result.
    pub fn failed(session: &str, failure: Failure) -> Self {
        let key = sha256(format!("{session}\n{}", failure.message).as_bytes());
        Self {
            key,
            status: Status::Failed,
            failure,
            chi_squared: f64::NAN,
            title: session.to_owned(),
            ..Self::default()
        }
    }

    /// Index of a parameter.
    pub fn index(&self, parameter: &str) -> Option<usize> {
        self.parameters.iter().position(|name| name == parameter)
    }

    /// Combined covariance of parameters `i` and `j`; NaN where one is not estimable, nothing if covariances were not read.
    pub fn covariance_of(&self, i: usize, j: usize) -> Option<f64> {
        self.covariance.get(packed(i, j)).copied()
    }
}

/// Days from 1970-01-01 to a day in ISO 8601; `None` if the text has none.
pub fn days_since_1970(date: &str) -> Option<i64> {
    let first = Date { year: 1970, month: 1, day: 1 };
    date.parse::<Date>().ok()?.days_since(first).map(i64::from)
}

/// Place of the entry of parameters `i` and `j` in a lower triangle by rows.
pub(crate) fn packed(i: usize, j: usize) -> usize {
    let (low, high) = (i.min(j), i.max(j));
    high * (high + 1) / 2 + low
}

/// SHA-256, hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}
