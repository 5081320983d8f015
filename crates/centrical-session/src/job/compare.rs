//! Calibrations of one unit, two by two.

use std::collections::HashSet;
use std::path::Path;

use centrical::uncertainty::{Comparison, Estimates, ParameterDifference};
use nalgebra::{DMatrix, DVector};

use super::history::{Calibrated, CalibratedParameter, Kinds, refuse_other_output, shared_changes};
use crate::document::{CalibrationResult, ComparisonReport, DifferenceSummary, PairComparison};
use crate::error::{Error, Place};
use crate::quantity::Date;
use crate::store::TermSummary;

/// How results are compared.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ComparisonRequest {
    /// Years between two results; by the dates of their sessions if absent.
    pub years: Option<f64>,
    /// Whether results of other units than the first are compared with it.
    pub other_units: bool,
}

/// Compares each result with the one before it, and the last of more than two with the first: the coefficients that both
/// determine, of the terms that both error models have. Errors that both sessions share cancel, and priors do not count, as in a history.
///
/// # Errors
/// [`Error`] when a result is of another unit than the first and the request does not allow it, or its raw output is in another unit.
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
    Ok(ComparisonReport::new(results, pairs.collect::<Result<_, _>>()?))
}

/// The result in `file` with its estimates relative to the nominal raw output of `other`, a result of the same unit in `of`. Its covariance and
/// its readings stay as they are.
///
/// # Errors
/// [`Error`] when its output is in another unit.
pub fn result_beside(
    mut result: CalibrationResult,
    file: &Path,
    other: &CalibrationResult,
    of: &Path,
) -> Result<CalibrationResult, Error> {
    let mut kinds = Kinds::default();
    let [mut own, other] = [(file, &result), (of, other)].map(|(file, result)| calibrated(file, result, &mut kinds));
    refuse_other_output(&other, &own)?;
    let Some(output) = other.output.filter(|output| own.output.as_ref() != Some(output)) else { return Ok(result) };
    own.restate(&output);
    let estimates = own.values.into_iter().zip(own.standard_uncertainties);
    for (parameter, (value, u)) in result.parameters.iter_mut().zip(estimates) {
        parameter.value = parameter.value.and(Some(value)).filter(|value| value.is_finite());
        parameter.standard_uncertainty = parameter.standard_uncertainty.and(Some(u)).filter(|u| u.is_finite());
    }
    Ok(result)
}

/// A result as it is compared. Of a session without a day the day does not count.
fn calibrated(file: &Path, result: &CalibrationResult, kinds: &mut Kinds) -> Calibrated {
    let date = result.session.date.parse().unwrap_or(Date { year: 1970, month: 1, day: 1 });
    Calibrated::on(date, file.display().to_string(), result.row(&[]), kinds)
}

/// The two of a pair, the first relative to the raw output of the second.
fn pair_of(
    results: &[(&Path, &CalibrationResult)],
    pair: [usize; 2],
    years: Option<f64>,
) -> Result<PairComparison, Error> {
    let [first, second] = pair.map(|n| results[n].1);
    let [only_in_first, only_in_second] = [terms_missing(first, second), terms_missing(second, first)];
    let mut kinds = Kinds::default();
    let [mut a, b] = pair.map(|n| calibrated(results[n].0, results[n].1, &mut kinds));
    refuse_other_output(&a, &b)?;
    if let Some(output) = &b.output {
        a.restate(output);
    }
    // A coefficient of the same name may belong to another term.
    let is_common =
        |name: &String| a.place(name).is_some() && b.place(name).is_some() && !only_in_second.contains(name);
    let common: Vec<String> = second.model.error_model.iter().map(|term| term.name.clone()).filter(is_common).collect();
    let is_by_priors = |name: &String| [&a, &b].iter().any(|c| c.place(name).is_some_and(|j| c.rests_on_priors(j)));
    let (by_priors_alone, names): (Vec<String>, Vec<String>) = common.into_iter().partition(is_by_priors);
    let same_unit = first.session.unit() == second.session.unit();
    let years = years.or_else(|| years_between(first, second)).filter(|years| *years != 0.0);
    let comparison = differences(&[&a, &b], &names);
    let summary = |difference: &ParameterDifference| {
        let [in_a, in_b] = [a.place(&difference.name)?, b.place(&difference.name)?];
        let CalibratedParameter { unit, group, .. } = &b.parameters[in_b];
        Some(DifferenceSummary::of(difference, (unit, *group), [Some(a.values[in_a]), Some(b.values[in_b])], years))
    };
    Ok(PairComparison {
        first: pair[0],
        second: pair[1],
        same_unit,
        only_in_first,
        only_in_second,
        by_priors_alone,
        same_files: same_files(first, second),
        years,
        differences: comparison.differences.iter().filter_map(summary).collect(),
        chi_squared: comparison.chi_squared,
        degrees_of_freedom: comparison.differences.len(),
        probability: comparison.probability,
        agree: same_unit && comparison.agrees(),
    })
}

/// Files of records or means with the same bytes in both.
fn same_files(first: &CalibrationResult, second: &CalibrationResult) -> usize {
    let measured = |result: &CalibrationResult| -> HashSet<String> {
        result.inputs.iter().filter(|input| input.is_measured()).map(|input| input.sha256.clone()).collect()
    };
    measured(first).intersection(&measured(second)).count()
}

/// The differences of `names` by the data alone. What both sessions share cancels, as far as it changes both alike.
fn differences(pair: &[&Calibrated; 2], names: &[String]) -> Comparison {
    let changes = shared_changes(pair, names, |_| true);
    let unlike = &changes[1] - &changes[0];
    let nothing = || Estimates { values: DVector::zeros(0), covariance: DMatrix::zeros(0, 0) };
    let [first, mut second] = pair.map(|calibrated| calibrated.own_estimates(names).unwrap_or_else(nothing));
    second.covariance += &unlike * unlike.transpose();
    Comparison::of(names, [&first, &second])
}

/// Years between the dates of two sessions, if both are days.
fn years_between(first: &CalibrationResult, second: &CalibrationResult) -> Option<f64> {
    let [first, second] = [first, second].map(|result| result.session.date.parse::<Date>().ok());
    second?.years_since(first?)
}

/// Names of the coefficients of terms that `of` has and `other` has not.
fn terms_missing(of: &CalibrationResult, other: &CalibrationResult) -> Vec<String> {
    let is_missing = |term: &&TermSummary| !other.model.error_model.contains(term);
    of.model.error_model.iter().filter(is_missing).map(|term| term.name.clone()).collect()
}
