//! The parts of a plan that are asked for.

use std::path::PathBuf;

/// Levels `m` of [K5.5] on the frontier unless others are given.
pub const USUAL_LEVELS: [f64; 4] = [0.0, 1.0, 2.0, 3.0];

/// Times of the frontier over that of the plan unless others are given.
pub const USUAL_TIMES: [f64; 8] = [0.5, 0.6, 0.7, 0.85, 1.0, 1.25, 1.5, 2.0];

/// The parts of a plan that are asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanRequest {
    /// Time available [s], in place of the one in the plan file.
    pub time: Option<f64>,
    /// Whether to search until every set of mountings is decided on.
    pub certify: bool,
    /// Times of the frontier over that of the plan; empty for no frontier.
    pub frontier: Vec<f64>,
    /// Levels `m` of [K5.5] to compare with.
    pub levels: Vec<f64>,
    /// Probability that expanded uncertainties are to cover.
    pub coverage: f64,
    /// Files that will be written: none of them may be one that is read.
    pub outputs: Vec<PathBuf>,
}

impl PlanRequest {
    /// A level `m` of [K5.5].
    ///
    /// # Errors
    /// What was found and expected.
    pub fn level(level: f64) -> Result<f64, String> {
        let is_level = (0.0..=1e6).contains(&level);
        is_level.then_some(level).ok_or_else(|| format!("found {level}, expected a multiple of Omega*^2, zero or more"))
    }
}
