//! The calibration repeated on drawn readings, as a JSON document: schema `centrical-montecarlo/1`.

use centrical::uncertainty::{MonteCarlo, ParameterStatistics, Settings, WeightedSquare};
use centrical::{Group, Parameters};
use serde::Serialize;

use super::json;
use super::result::Program;

/// Name of the schema's present version.
pub(crate) const MONTE_CARLO_SCHEMA: &str = "centrical-montecarlo/1";

/// Distance of Kolmogorov's test over `1/sqrt(runs)` that chance exceeds once in twenty.
const ONCE_IN_TWENTY: f64 = 1.36;

/// What the runs show beside what was stated.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MonteCarloReport {
    /// `centrical-montecarlo/1`.
    pub schema: &'static str,
    /// What made it.
    pub program: Program,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Which fit is repeated.
    pub fit: RepeatedFit,
    /// Which noise was drawn, in words.
    pub weighted_by: String,
    /// Runs that converged: all figures are of these.
    pub runs: usize,
    /// Runs that did not converge.
    pub failures: usize,
    /// Probability that the intervals are to cover.
    pub coverage: f64,
    /// The unknowns in order.
    pub parameters: Vec<RepeatedParameter>,
    /// `e^T C^-1 e` of the determined unknowns with the covariance stated in each run.
    pub weighted_square: SquareSummary,
    /// chi^2 of the fits.
    pub chi_squared: SquareSummary,
    /// Names of the unknowns whose stated uncertainty is too small ([`MonteCarlo::understated`]).
    pub understated: Vec<String>,
    /// Whether the stated uncertainties hold ([`MonteCarlo::is_acceptable`]).
    pub acceptable: bool,
}

/// The fit that is repeated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum RepeatedFit {
    /// Gauss-Newton on the exact model.
    Exact,
    /// The linear fit of [K5.3] alone.
    Linear,
}

/// One unknown over all runs, SI. All figures are null where the data do not determine it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RepeatedParameter {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// bias, scale, misalignment, ...
    #[serde(serialize_with = "crate::document::json::serialize")]
    pub group: Group,
    /// The true value that was drawn for.
    pub truth: f64,
    /// Combined standard uncertainty of the budget.
    pub stated: Option<f64>,
    /// Standard deviation of the error about its mean.
    pub standard_deviation: Option<f64>,
    /// Mean error of the estimate.
    pub bias: Option<f64>,
    /// Part of the runs whose interval covers the truth.
    pub covered: Option<f64>,
    /// Whether lost combinations of unknowns leave doubt in it that is not in `stated`.
    #[serde(rename = "leans_on_lost")]
    pub is_affected_by_null_space: bool,
}

/// A quadratic form over all runs, beside the chi^2 distribution that it should have.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SquareSummary {
    /// Degrees of freedom: the expected mean.
    pub degrees_of_freedom: usize,
    /// Mean over the runs; null without a run.
    pub mean: Option<f64>,
    /// Standard deviation over the runs; null with fewer than two.
    pub standard_deviation: Option<f64>,
    /// The standard deviation that is expected, `sqrt(2 nu)`.
    pub expected_standard_deviation: f64,
    /// Largest distance from the chi^2 distribution (Kolmogorov); null without a run.
    pub distance: Option<f64>,
    /// The distance that chance exceeds once in twenty; null without a run.
    pub distance_once_in_twenty: Option<f64>,
}

impl MonteCarloReport {
    /// What runs with these `settings` gave, of a unit with these true values.
    pub(crate) fn of(
        parameters: &Parameters,
        truth: &[f64],
        weighted_by: &str,
        settings: &Settings,
        monte_carlo: &MonteCarlo,
    ) -> Self {
        let runs = monte_carlo.runs;
        let parameter = |j: usize| {
            let statistics = monte_carlo.parameters[j].filter(|_| runs > 0);
            let number = |value: fn(&ParameterStatistics) -> f64| statistics.as_ref().map(value).and_then(json::finite);
            RepeatedParameter {
                name: parameters[j].name.clone(),
                unit: parameters[j].unit.clone(),
                group: parameters[j].group,
                truth: truth[j],
                stated: monte_carlo.parameters[j].map(|s| s.stated),
                standard_deviation: number(|s| s.standard_deviation).filter(|_| runs > 1),
                bias: number(|s| s.bias),
                covered: number(|s| s.coverage),
                is_affected_by_null_space: monte_carlo.parameters[j].is_some_and(|s| s.is_affected_by_null_space),
            }
        };
        Self {
            schema: MONTE_CARLO_SCHEMA,
            program: Program::this(),
            seed: settings.seed,
            fit: if settings.is_linear { RepeatedFit::Linear } else { RepeatedFit::Exact },
            weighted_by: weighted_by.to_owned(),
            runs,
            failures: monte_carlo.failures,
            coverage: settings.coverage,
            parameters: (0..parameters.len()).map(parameter).collect(),
            weighted_square: SquareSummary::of(&monte_carlo.weighted_square, runs),
            chi_squared: SquareSummary::of(&monte_carlo.chi_squared, runs),
            understated: monte_carlo.understated().into_iter().map(|j| parameters[j].name.clone()).collect(),
            acceptable: monte_carlo.is_acceptable(settings.coverage),
        }
    }
}

impl SquareSummary {
    fn of(square: &WeightedSquare, runs: usize) -> Self {
        let is_any = runs > 0;
        Self {
            degrees_of_freedom: square.degrees_of_freedom,
            mean: json::finite(square.mean),
            standard_deviation: json::finite(square.standard_deviation).filter(|_| runs > 1),
            expected_standard_deviation: (2.0 * square.degrees_of_freedom as f64).sqrt(),
            distance: is_any.then(|| square.distance_from_chi_squared()),
            distance_once_in_twenty: is_any.then(|| ONCE_IN_TWENTY / (runs as f64).sqrt()),
        }
    }
}
