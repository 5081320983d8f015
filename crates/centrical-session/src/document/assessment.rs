//! How far a calibration can be trusted, as a JSON document: schema `centrical-assessment/1`.

use centrical::uncertainty::{Budget, CurvePoint, Improvement, Pattern, PlateauCheck, Validity};
use centrical::{Experiment, Fit, Group, MeasurementModel, Source, Termination};
use serde::Serialize;

use super::documents::ObjectionName;
use super::json::finite_degrees;
use super::result::{BudgetSummary, CalibrationResult, Program, ValiditySummary};
use crate::experiment::PlateauName;

/// Name of the schema's present version.
pub(crate) const ASSESSMENT_SCHEMA: &str = "centrical-assessment/1";

/// Budget, checks and prediction of a calibration.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AssessmentReport {
    /// `centrical-assessment/1`.
    pub schema: &'static str,
    /// What made it.
    pub program: Program,
    /// Title of the session.
    pub title: String,
    /// Probability that the expanded uncertainties are to cover.
    pub coverage: f64,
    /// Whether the uncertainties by noise, speeds and priors are scaled by the residuals.
    pub scaled_by_residuals: bool,
    /// The fit of all plateaus.
    pub fit: AssessedFit,
    /// What was left out and the fit of the others, on which all else rests then; null if that was not asked for.
    pub without_outliers: Option<WithoutOutliers>,
    /// The unknowns in order.
    pub parameters: Vec<AssessedParameter>,
    /// Combined covariance of the unknowns in their order, SI; null where one is not determined.
    pub covariance: Vec<Vec<Option<f64>>>,
    /// The uncertainties by their sources.
    pub budget: BudgetSummary,
    /// What each source costs the parameters of the instrument, the costliest first.
    pub improvements: Vec<ImprovementSummary>,
    /// The checks of the fit; `rivals` are those of `calibrate`, and are not looked for here.
    pub validity: ValiditySummary,
    /// The plateaus against their prediction from all others, in order.
    pub plateaus: Vec<AssessedPlateau>,
    /// Uncertainty of a compensated reading along each instrument axis; null while a coefficient is not determined.
    pub prediction: Option<[Vec<CompensatedUncertainty>; 3]>,
    /// Whether the calibration that the above rests on is acceptable.
    pub acceptable: bool,
    /// The objections to it.
    pub objections: Vec<ObjectionName>,
}

/// How a fit went.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AssessedFit {
    /// How it ended.
    #[serde(serialize_with = "crate::document::json::serialize")]
    pub termination: Termination,
    /// Weighted sum of squared residuals.
    pub chi_squared: f64,
    /// Readings less rank.
    pub degrees_of_freedom: usize,
}

/// A fit without outlying plateaus.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WithoutOutliers {
    /// The plateaus left out, the most outlying first.
    pub left_out: Vec<LeftOutPlateau>,
    /// The fit of the others.
    pub fit: AssessedFit,
}

/// A plateau that was left out.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LeftOutPlateau {
    /// Mounting, counted from 1.
    pub mounting: usize,
    /// Plateau of the mounting's schedule, counted from 0.
    pub index: usize,
    /// Probability of a plateau so far out by chance, when it was left out.
    pub probability: f64,
}

/// An unknown with its uncertainty, SI.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AssessedParameter {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// bias, scale, misalignment, ...
    #[serde(serialize_with = "crate::document::json::serialize")]
    pub group: Group,
    /// Estimate; null where it is not determined, as all that follows.
    pub value: Option<f64>,
    /// Combined standard uncertainty.
    pub standard_uncertainty: Option<f64>,
    /// Effective degrees of freedom (Welch-Satterthwaite); null also where they are infinite.
    pub degrees_of_freedom: Option<f64>,
    /// Coverage factor.
    pub coverage_factor: Option<f64>,
    /// Expanded uncertainty.
    pub expanded_uncertainty: Option<f64>,
}

/// What a perfect source of uncertainty would bring.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ImprovementSummary {
    /// The source.
    #[serde(serialize_with = "crate::document::json::serialize")]
    pub source: Source,
    /// Its mean share of the variance of the parameters of the instrument, 0 to 1.
    pub share: f64,
    /// Mean factor on their combined uncertainties without it.
    pub mean_factor: f64,
    /// The parameter that gains most.
    pub parameter: String,
    /// Factor on the combined uncertainty of that parameter.
    pub factor: f64,
}

/// A plateau against its prediction from all others.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AssessedPlateau {
    /// Mounting, counted from 1.
    pub mounting: usize,
    /// Plateau of the mounting's schedule, counted from 0.
    pub index: usize,
    /// Residuals over their standard deviations, by newtonometer.
    pub standardised: [f64; 3],
    /// Part of its readings that the fit follows, 0 to 1.
    pub leverage: f64,
    /// Probability of so large a difference by chance, for this plateau alone.
    pub probability: f64,
}

/// Standard uncertainty of a compensated reading, calibration alone.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CompensatedUncertainty {
    /// Specific force along the axis [m/s^2].
    pub force: f64,
    /// Standard uncertainties of the three components [m/s^2].
    pub components: [f64; 3],
    /// Standard uncertainty along the force [m/s^2].
    pub along: f64,
}

/// How far a calibration can be trusted.
#[derive(Debug)]
pub struct Assessment {
    /// Whether the noise and the speed of the plateaus are scaled by the residuals.
    pub scaled_by_residuals: bool,
    /// The model.
    pub model: MeasurementModel,
    /// The fit of all plateaus.
    pub fit: Fit,
    /// If it was asked for, the fit without outlying plateaus, on which what follows rests then; and these, by set point, each
    /// with its probability at the time.
    pub cleaned: Option<(Fit, Vec<(usize, f64)>)>,
    /// What each source of uncertainty leaves.
    pub budget: Budget,
    /// Whether the residuals are those of a true model.
    pub validity: Validity,
    /// Patterns in the residuals.
    pub patterns: Vec<Pattern>,
    /// Uncertainty of a compensated reading along each instrument axis; `None` while a coefficient is not determined.
    pub prediction: Option<[Vec<CurvePoint>; 3]>,
    /// The calibration that the above rests on, as [`calibrate`](crate::calibrate()) has it.
    pub result: CalibrationResult,
}

impl Assessment {
    /// The assessment as a JSON document, expanded uncertainties for a probability of `coverage`.
    pub fn report(&self, coverage: f64) -> AssessmentReport {
        let Self { model, fit, cleaned, budget, validity, patterns, prediction, result, .. } = self;
        let objections = result.objections();
        let (experiment, parameters) = (model.experiment(), model.parameters());
        let count = parameters.len();
        let used = cleaned.as_ref().map_or(fit, |(without, _)| without);
        let own: Vec<usize> = (0..count).filter(|&j| parameters[j].is_of_instrument()).collect();
        let improvement = |i: &Improvement| ImprovementSummary {
            source: i.source,
            share: i.share,
            mean_factor: i.mean_factor,
            parameter: parameters[i.most].name.clone(),
            factor: i.most_factor,
        };
        let row = |i: usize| (0..count).map(|j| budget.covariance(i, j)).collect();
        AssessmentReport {
            schema: ASSESSMENT_SCHEMA,
            program: Program::this(),
            title: result.session.title.clone(),
            coverage,
            scaled_by_residuals: self.scaled_by_residuals,
            fit: AssessedFit::of(fit),
            without_outliers: cleaned.as_ref().map(|(fit, left_out)| WithoutOutliers::of(experiment, fit, left_out)),
            parameters: (0..count).map(|j| AssessedParameter::of(model, used, budget, coverage, j)).collect(),
            covariance: (0..count).map(row).collect(),
            budget: BudgetSummary::new(budget, count, &[]),
            improvements: budget.improvements(&own).iter().map(improvement).collect(),
            validity: ValiditySummary::new(experiment, validity, patterns),
            plateaus: validity.plateaus.iter().map(|check| AssessedPlateau::of(experiment, check)).collect(),
            prediction: prediction
                .as_ref()
                .map(|curves| curves.each_ref().map(|curve| curve.iter().map(Into::into).collect())),
            acceptable: objections.is_empty(),
            objections: objections.iter().map(Into::into).collect(),
        }
    }
}

impl AssessedFit {
    fn of(fit: &Fit) -> Self {
        Self { termination: fit.termination, chi_squared: fit.chi_squared, degrees_of_freedom: fit.degrees_of_freedom }
    }
}

impl WithoutOutliers {
    fn of(experiment: &Experiment, fit: &Fit, left_out: &[(usize, f64)]) -> Self {
        let plateau = |&(set_point, probability): &(usize, f64)| {
            let PlateauName { mounting, plateau } = PlateauName::among(&experiment.set_points, set_point);
            LeftOutPlateau { mounting, index: plateau - 1, probability }
        };
        Self { left_out: left_out.iter().map(plateau).collect(), fit: AssessedFit::of(fit) }
    }
}

impl AssessedParameter {
    fn of(model: &MeasurementModel, fit: &Fit, budget: &Budget, coverage: f64, j: usize) -> Self {
        let parameter = &model.parameters()[j];
        let degrees = budget.degrees_of_freedom(j);
        let factor = degrees.map(|degrees| degrees.coverage_factor(coverage));
        let standard_uncertainty = budget.standard_uncertainty(j);
        Self {
            name: parameter.name.clone(),
            unit: parameter.unit.clone(),
            group: parameter.group,
            value: fit.value(j),
            standard_uncertainty,
            degrees_of_freedom: degrees.and_then(finite_degrees),
            coverage_factor: factor,
            expanded_uncertainty: standard_uncertainty.zip(factor).map(|(u, k)| k * u),
        }
    }
}

impl AssessedPlateau {
    fn of(experiment: &Experiment, check: &PlateauCheck) -> Self {
        let PlateauName { mounting, plateau } = PlateauName::among(&experiment.set_points, check.set_point);
        Self {
            mounting,
            index: plateau - 1,
            standardised: check.standardised.into(),
            leverage: check.leverage,
            probability: check.test.probability,
        }
    }
}

impl From<&CurvePoint> for CompensatedUncertainty {
    fn from(&CurvePoint { force, components, along }: &CurvePoint) -> Self {
        Self { force, components, along }
    }
}
