//! Two calibrations of one unit.

use centrical::uncertainty::{Comparison, Level, compare};

use crate::document::CalibrationResult;

/// Two calibrations compared.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedResults {
    /// The differences, and the joint test.
    pub comparison: Comparison,
    /// Whether the two agree.
    pub agree: bool,
}

/// Compares the coefficients of the error model that both calibrations determine.
pub fn compare_results(first: &CalibrationResult, second: &CalibrationResult) -> ComparedResults {
    let comparison = compare(&first.of_unit(), &second.of_unit());
    let agree = comparison.probability.is_some_and(|probability| probability > Level::Disagreement.probability());
    ComparedResults { comparison, agree }
}
