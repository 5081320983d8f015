//! A control chart, as a JSON document: schema `centrical-chart/1`.

use std::fmt::{self, Display, Formatter};

use centrical::Group;
use serde::{Serialize, Serializer};

use super::unit::PastSession;
use crate::document::result::Program;

/// Name of the schema's present version.
pub(crate) const CHART_SCHEMA: &str = "centrical-chart/1";

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
    #[serde(serialize_with = "crate::document::json::serialize")]
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
    /// What gave it.
    pub rule: ChartRule,
    /// The rule in words.
    pub words: &'static str,
}

/// What gives a signal. Rules of single values have their number in their set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChartRule {
    /// `nelson-1`, ...
    Nelson(usize),
    /// `western-electric-1`, ...
    WesternElectric(usize),
    /// `moving-range`
    MovingRange,
    /// `ewma`
    Ewma,
    /// `cusum`
    Cusum,
}

/// A kind of chart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChartKind {
    /// Single values.
    Individuals,
    /// Steps from value to value.
    MovingRange,
    /// Exponentially weighted means.
    Ewma,
    /// Cumulative sums.
    Cusum,
}

impl ChartRule {
    /// The chart that the rule is of.
    pub fn kind(self) -> ChartKind {
        match self {
            Self::Nelson(_) | Self::WesternElectric(_) => ChartKind::Individuals,
            Self::MovingRange => ChartKind::MovingRange,
            Self::Ewma => ChartKind::Ewma,
            Self::Cusum => ChartKind::Cusum,
        }
    }
}

impl Display for ChartRule {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        match self {
            Self::Nelson(number) => write!(f, "nelson-{number}"),
            Self::WesternElectric(number) => write!(f, "western-electric-{number}"),
            Self::MovingRange => f.write_str("moving-range"),
            Self::Ewma => f.write_str("ewma"),
            Self::Cusum => f.write_str("cusum"),
        }
    }
}

impl Serialize for ChartRule {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
