//! Calibrations of one unit, two by two.

use std::path::Path;

use centrical::uncertainty::compare;

use crate::document::{CalibrationResult, ComparisonReport, PairComparison, TermSummary};
use crate::error::{Error, Place};
use crate::quantity::Date;

/// How results are compared.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ComparisonRequest {
    /// Years between two results; by the dates of their sessions if absent.
    pub years: Option<f64>,
    /// Whether results of other units than the first are compared with it.
    pub other_units: bool,
}

/// Compares each result with the one before it, and the last of more than two with the first: the coefficients that both
/// determine, of the terms that both error models have.
///
/// # Errors
/// [`Error`] when a result is of another unit than the first and the request does not allow it.
pub fn compare_results(
    results: &[(&Path, &CalibrationResult)],
    request: ComparisonRequest,
) -> Result<ComparisonReport, Error> {
    if !request.other_units
        && let Some((file, other)) =
            results.iter().find(|(_, result)| result.session.unit() != results[0].1.session.unit())
    {
        let expected = format!("a result of {}, or --other-units", results[0].1.session.unit());
        return Err(Error::content(file, Place::Whole, format!("a result of {}", other.session.unit()), expected));
    }
    let consecutive = (1..results.len()).map(|n| [n - 1, n]);
    let ends = (results.len() > 2).then(|| [0, results.len() - 1]);
    let pairs = consecutive.chain(ends).map(|pair| pair_of(results, pair, request.years));
    Ok(ComparisonReport::new(results, pairs.collect()))
}

fn pair_of(results: &[(&Path, &CalibrationResult)], pair: [usize; 2], years: Option<f64>) -> PairComparison {
    let [first, second] = pair.map(|n| results[n].1);
    let [only_in_first, only_in_second] = [terms_missing(first, second), terms_missing(second, first)];
    let mut second_unit = second.of_unit();
    // A coefficient of the same name may belong to another term.
    for name in second_unit.names.iter_mut().filter(|name| only_in_second.contains(name)) {
        name.clear();
    }
    let comparison = compare(&first.of_unit(), &second_unit);
    let same_unit = first.session.unit() == second.session.unit();
    let years = years.or_else(|| years_between(first, second)).filter(|years| *years != 0.0);
    PairComparison {
        first: pair[0],
        second: pair[1],
        same_unit,
        only_in_first,
        only_in_second,
        agree: same_unit && comparison.agrees(),
        ..PairComparison::of([first, second], &comparison, years)
    }
}

/// Years between the dates of two sessions, if both are days.
fn years_between(first: &CalibrationResult, second: &CalibrationResult) -> Option<f64> {
    let [first, second] = [first, second].map(|result| result.session.date.parse::<Date>().ok());
    Some(f64::from(second?.days_since(first?)?) / 365.25)
}

/// Names of the coefficients of terms that `of` has and `other` has not.
fn terms_missing(of: &CalibrationResult, other: &CalibrationResult) -> Vec<String> {
    let is_missing = |term: &&TermSummary| !other.model.error_model.contains(term);
    of.model.error_model.iter().filter(is_missing).map(|term| term.name.clone()).collect()
}
