//! Calibrations of one unit compared, as a JSON document: schema `centrical-comparison/1`.

use std::path::Path;

use centrical::Group;
use centrical::uncertainty::ParameterDifference;
use serde::Serialize;

use super::result::{CalibrationResult, Program};

/// Name of the schema's present version.
pub(crate) const COMPARISON_SCHEMA: &str = "centrical-comparison/1";

/// Results compared two by two.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparisonReport {
    /// `centrical-comparison/1`.
    pub schema: &'static str,
    /// What made it.
    pub program: Program,
    /// The results, in the order in which they were given.
    pub results: Vec<ComparedResultSummary>,
    /// The pairs that were compared.
    pub comparisons: Vec<PairComparison>,
    /// Whether every pair is of one unit and agrees.
    pub agree: bool,
}

/// A result that is compared.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ComparedResultSummary {
    /// Its file, as it was given.
    pub file: String,
    /// Title of the session.
    pub title: String,
    /// Date of the session, as it was written.
    pub date: String,
    /// Model of the unit.
    pub unit_model: String,
    /// Serial number of the unit.
    pub unit_serial: String,
    /// Whether no check raised an objection.
    pub acceptable: bool,
}

/// Two results, the second less the first.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairComparison {
    /// The first result, counted from 0.
    pub first: usize,
    /// The second result, counted from 0.
    pub second: usize,
    /// Whether the two results are of one unit.
    pub same_unit: bool,
    /// Coefficients of terms that only the first error model has.
    pub only_in_first: Vec<String>,
    /// Coefficients of terms that only the second error model has.
    pub only_in_second: Vec<String>,
    /// Coefficients that priors alone determine in one of the two: they show no change.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub by_priors_alone: Vec<String>,
    /// Files with the same bytes that both rest on, but for settings: of one measurement they are all.
    pub same_files: usize,
    /// Years between the two, if they were given.
    pub years: Option<f64>,
    /// The coefficients that both determine.
    pub differences: Vec<DifferenceSummary>,
    /// `d^T C^-1 d` of all together, with the covariance of the differences; null where the sum is not a covariance.
    pub chi_squared: Option<f64>,
    /// Its degrees of freedom.
    pub degrees_of_freedom: usize,
    /// Probability of so large a chi^2 if nothing has changed.
    pub probability: Option<f64>,
    /// Whether the two are of one unit and agree.
    pub agree: bool,
}

/// One coefficient in both, SI.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DifferenceSummary {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// bias, scale, misalignment, ...
    #[serde(serialize_with = "crate::document::json::serialize")]
    pub group: Group,
    /// Value in the first result, relative to the raw output of the second.
    pub first: Option<f64>,
    /// Value in the second result.
    pub second: Option<f64>,
    /// Second less first, by the data alone where there are priors.
    pub difference: f64,
    /// Standard uncertainty of the difference.
    pub standard_uncertainty: f64,
    /// Difference over its expanded uncertainty, `k = 2` (ISO/IEC 17043).
    pub e_n: f64,
    /// Probability of a difference as large as this, in uncertainties, in any of the coefficients if nothing has changed
    /// (Bonferroni).
    pub probability: f64,
    /// Whether this coefficient alone shows that the two disagree.
    pub disagrees: bool,
    /// Drift per year, if the years between the two were given.
    pub per_year: Option<f64>,
}

impl ComparisonReport {
    /// Whether all results are of one unit.
    pub fn is_of_one_unit(&self) -> bool {
        self.comparisons.iter().all(|pair| pair.same_unit)
    }

    /// Results by their files, and the pairs that were compared.
    pub(crate) fn new(results: &[(&Path, &CalibrationResult)], comparisons: Vec<PairComparison>) -> Self {
        let summary = |(file, result): &(&Path, &CalibrationResult)| ComparedResultSummary {
            file: file.display().to_string(),
            title: result.session.title.clone(),
            date: result.session.date.clone(),
            unit_model: result.session.unit_model.clone(),
            unit_serial: result.session.unit_serial.clone(),
            acceptable: result.objections().is_empty(),
        };
        let agree = comparisons.iter().all(|pair| pair.agree);
        Self {
            schema: COMPARISON_SCHEMA,
            program: Program::this(),
            results: results.iter().map(summary).collect(),
            comparisons,
            agree,
        }
    }
}

impl DifferenceSummary {
    /// A difference of a coefficient with this `unit` and `group`, its values in both results, and the years between them.
    pub(crate) fn of(
        found: &ParameterDifference,
        (unit, group): (&str, Group),
        [first, second]: [Option<f64>; 2],
        years: Option<f64>,
    ) -> Self {
        Self {
            name: found.name.clone(),
            unit: unit.to_owned(),
            group,
            first,
            second,
            difference: found.difference,
            standard_uncertainty: found.standard_uncertainty,
            e_n: found.e_n,
            probability: found.probability,
            disagrees: found.is_real(),
            per_year: years.map(|years| found.difference / years),
        }
    }
}
