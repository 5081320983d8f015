//! How a series of calibrations ended: schema `centrical-series/1`.

use serde::Serialize;

use super::result::Program;

/// Name of the schema's present version.
pub(crate) const SERIES_SCHEMA: &str = "centrical-series/1";

/// How a series ended.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
pub struct SeriesSummary {
    /// `centrical-series/1`.
    pub schema: &'static str,
    /// What made it.
    pub program: Program,
    /// Sessions.
    pub sessions: usize,
    /// Those whose result was there already.
    pub known: usize,
    /// Those that are acceptable.
    pub acceptable: usize,
    /// Those that are not.
    pub not_acceptable: usize,
    /// Those without a result.
    pub failed: usize,
    /// These, a hundred at most; `series.csv` has all.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub failures: Vec<FailedSession>,
}

/// A session without a result.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct FailedSession {
    /// As it was named.
    pub session: String,
    /// Why.
    pub message: String,
}

impl SeriesSummary {
    /// A summary before the first session is done.
    pub(crate) fn of(sessions: usize) -> Self {
        Self { schema: SERIES_SCHEMA, program: Program::this(), sessions, ..Self::default() }
    }
}
