//! What a plan will know, as data for documents.

use centrical::plan::Prediction;
use centrical::{FitError, Group};
use serde::Serialize;

use super::json::finite_degrees;
use super::result::RestsOn;

/// Points of the curve of the compensated reading, from 0 to the range.
const POINTS: usize = 5;

/// Uncertainties before the experiment.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PredictionReport {
    /// Probability that expanded uncertainties are to cover.
    pub coverage: f64,
    /// Sources that leave anything.
    pub sources: Vec<&'static str>,
    /// The unknowns in order.
    pub parameters: Vec<PredictedParameter>,
    /// Largest specific force of the range [m/s^2].
    pub range: f64,
    /// Root of the mean variance of the compensated reading over the range, by noise, speeds and priors alone, and by all
    /// sources [m/s^2]; null where a coefficient is not determined.
    pub reading: Option<[f64; 2]>,
    /// Along each instrument axis: specific force, and standard uncertainty of the compensated reading [m/s^2].
    pub curves: Vec<[f64; 4]>,
    /// The effects whose absence the calibration will rest on, the worst first.
    pub rests_on: Vec<RestsOn>,
}

/// An unknown before the experiment, SI; null where it is not determined.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PredictedParameter {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// bias, scale, misalignment, ...
    #[serde(serialize_with = "crate::document::json::serialize")]
    pub group: Group,
    /// Standard uncertainty by noise, speeds and priors.
    pub type_a: Option<f64>,
    /// Combined standard uncertainty.
    pub combined: Option<f64>,
    /// Expanded uncertainty.
    pub expanded: Option<f64>,
    /// Effective degrees of freedom; null when infinite.
    pub degrees_of_freedom: Option<f64>,
    /// Whether lost combinations of unknowns leave doubt in it that is not in its uncertainties.
    #[serde(rename = "leans_on_lost")]
    pub is_affected_by_null_space: bool,
}

impl PredictionReport {
    /// The usual probability, that of all documents: of two standard uncertainties in a normal distribution (EA-4/02, 5.1).
    pub const COVERAGE: f64 = 0.954_499_736_103_642;

    /// The report of a prediction.
    ///
    /// # Errors
    /// [`FitError`] when numbers overflow.
    pub fn of(prediction: &Prediction, range: f64, coverage: f64) -> Result<Self, FitError> {
        let budget = prediction.budget();
        let parameters = prediction.model().parameters();
        let parameter = |j: usize| {
            let degrees = budget.degrees_of_freedom(j);
            let combined = prediction.standard_uncertainty(j);
            PredictedParameter {
                name: parameters[j].name.clone(),
                unit: parameters[j].unit.clone(),
                group: parameters[j].group,
                type_a: prediction.type_a(j),
                combined,
                expanded: combined.zip(degrees).map(|(u, degrees)| u * degrees.coverage_factor(coverage)),
                degrees_of_freedom: degrees.and_then(finite_degrees),
                is_affected_by_null_space: combined.is_some() && prediction.is_affected_by_null_space(j),
            }
        };
        // The curve is symmetric but for rounding: the half from 0 on is shown.
        let curves = prediction.curves(range, 2 * POINTS - 1).map_or_else(Vec::new, |[a, b, c]| {
            let rows = a.iter().zip(&b).zip(&c).skip(POINTS - 1);
            rows.map(|((a, b), c)| [a.force, a.along, b.along, c.along]).collect()
        });
        Ok(Self {
            coverage,
            sources: budget.contributions().iter().map(|c| c.source.name()).collect(),
            parameters: (0..parameters.len()).map(parameter).collect(),
            range,
            reading: prediction.reading(range),
            curves,
            rests_on: RestsOn::all(prediction.model(), prediction.rests_on()?),
        })
    }
}
