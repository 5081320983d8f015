//! A control chart, as a document: schema `centrical-chart/1`.

use centrical::Group;
use serde::Serialize;

use super::unit::PastSession;
use crate::document::json;
use crate::document::result::Program;
use crate::error::Error;

/// Name of the schema's present version.
pub const CHART_SCHEMA: &str = "centrical-chart/1";

/// Control charts of one parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChartReport {
    /// `centrical-chart/1`.
    pub schema: &'static str,
    /// What made it.
    pub program: Program,
    /// The parameter.
    pub name: String,
    /// Unit of SI.
    pub unit: String,
    /// bias, scale, tilt, ...
    #[serde(serialize_with = "crate::document::words::serialize")]
    pub group: Group,
    /// Sessions whose values gave the limits; 0 where they were stated.
    pub accepted: usize,
    /// Mean of the process in control.
    pub centre: f64,
    /// Standard deviation from value to value.
    pub deviation: f64,
    /// Limits of single values.
    pub limits: [f64; 2],
    /// Upper limit of the moving range.
    pub range_limit: f64,
    /// The sessions, in the order of time.
    pub sessions: Vec<PastSession>,
    /// Their values.
    pub values: Vec<f64>,
    /// Moving ranges, one less.
    pub ranges: Vec<f64>,
    /// Exponentially weighted means.
    pub ewma: Vec<f64>,
    /// Half of the distance between their limits.
    pub ewma_half_widths: Vec<f64>,
    /// Cumulative sums upwards, in standard deviations.
    pub cusum_upper: Vec<f64>,
    /// Cumulative sums downwards, in standard deviations.
    pub cusum_lower: Vec<f64>,
    /// Limit of the cumulative sums.
    pub cusum_limit: f64,
    /// The signals, in the order of time.
    pub signals: Vec<ChartSignal>,
}

/// A signal of a chart.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ChartSignal {
    /// The session, counted from 0.
    pub session: usize,
    /// What gave it: nelson-1 ..., western-electric-1 ..., moving-range, ewma, cusum.
    pub rule: String,
    /// The rule in words.
    pub words: &'static str,
}

impl ChartReport {
    /// The text of the document.
    ///
    /// # Errors
    /// [`Error::Json`] when a value has no place in JSON.
    pub fn to_json(&self) -> Result<String, Error> {
        json::document(CHART_SCHEMA, self)
    }
}
