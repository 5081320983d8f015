//! Two calibrations of one unit.

use std::path::Path;

use centrical::uncertainty::{Comparison, compare};

use crate::document::{CalibrationResult, ComparisonReport, PairComparison, TermSummary};

/// Two calibrations compared.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedResults {
    /// The differences, and the joint test.
    pub comparison: Comparison,
    /// Model and serial number of the two units, if they are not the same unit.
    pub different_units: Option<[String; 2]>,
    /// Coefficients of terms that only the first error model has, and only the second. What they would have explained is in the
    /// other coefficients.
    pub terms_of_one: [Vec<String>; 2],
    /// Whether the two are of one unit and agree.
    pub agree: bool,
}

/// Compares the coefficients that both calibrations determine, of the terms that both error models have.
pub fn compare_results(first: &CalibrationResult, second: &CalibrationResult) -> ComparedResults {
    let terms_of_one = [terms_missing(first, second), terms_missing(second, first)];
    let mut second_unit = second.of_unit();
    // A coefficient of the same name may belong to another term.
    for name in second_unit.names.iter_mut().filter(|name| terms_of_one[1].contains(name)) {
        name.clear();
    }
    let comparison = compare(&first.of_unit(), &second_unit);
    let units = [first, second].map(unit);
    let different_units = (units[0] != units[1]).then_some(units);
    let agree = different_units.is_none() && comparison.agrees();
    ComparedResults { comparison, different_units, terms_of_one, agree }
}

impl ComparedResults {
    /// The comparison as a document: the files and the results that were compared; `years` lie between them, where known.
    pub fn report(
        &self,
        [(first_file, first), (second_file, second)]: [(&Path, &CalibrationResult); 2],
        years: Option<f64>,
    ) -> ComparisonReport {
        let years = years.filter(|years| *years != 0.0);
        let [only_in_first, only_in_second] = self.terms_of_one.clone();
        let pair = PairComparison {
            same_unit: self.different_units.is_none(),
            only_in_first,
            only_in_second,
            agree: self.agree,
            ..PairComparison::of([first, second], &self.comparison, years)
        };
        ComparisonReport::new(&[(first_file, first), (second_file, second)], vec![pair])
    }
}

/// Names of the coefficients of terms that `of` has and `other` has not.
fn terms_missing(of: &CalibrationResult, other: &CalibrationResult) -> Vec<String> {
    let is_missing = |term: &&TermSummary| !other.model.error_model.contains(term);
    of.model.error_model.iter().filter(is_missing).map(|term| term.name.clone()).collect()
}

fn unit(result: &CalibrationResult) -> String {
    format!("{}, serial {}", result.session.unit_model, result.session.unit_serial)
}
