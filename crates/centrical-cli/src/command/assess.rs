//! `centrical assess SESSION`: uncertainty budget and checks of a session's calibration.

use std::io::{self, Write};
use std::path::PathBuf;

use centrical::uncertainty::{Budget, Compensated, Validity, patterns, without_outliers};
use centrical::{Fit, FitError, MeasurementModel, Observation, STANDARD_GRAVITY, fit, linear};
use centrical_report::{budget_table, correlation_table, outliers_text, prediction_table, validity_text};
use centrical_session::{Error, Problem, Session};
use nalgebra::{DMatrix, Vector3};

use crate::{Outcome, progress};

/// Uncertainty budget, validity, residual patterns and prediction of a session's calibration.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The session folder, or its experiment.toml
    session: PathBuf,
    /// Coverage probability of the expanded uncertainties
    #[arg(long, default_value_t = 0.95, value_parser = probability)]
    coverage: f64,
    /// Fit without outlying plateaus, at this family-wise error, and show the difference
    #[arg(long, value_name = "ERROR", num_args = 0..=1, default_missing_value = "0.05", value_parser = probability)]
    without_outliers: Option<f64>,
    /// Scale the noise and speed uncertainty of the plateaus by the residuals: for weights known only up to a factor
    #[arg(long)]
    scale_by_residuals: bool,
    /// Show the correlations of the parameters of the instrument; all of them are in the covariance of result.json
    #[arg(long)]
    correlations: bool,
    /// Range of the specific force of the prediction, in g [default: the highest of the session]
    #[arg(long, value_name = "G")]
    range: Option<f64>,
}

/// A probability in (0, 1).
pub fn probability(text: &str) -> Result<f64, String> {
    let value = text.parse::<f64>().ok().filter(|p| *p > 0.0 && *p < 1.0);
    value.ok_or_else(|| "expected a number above 0 and below 1".to_owned())
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let session = Session::read(&arguments.session)?;
    let bar = progress::reading(&session);
    let problem = Problem::of(&session, &|bytes| bar.inc(bytes))?;
    bar.finish_and_clear();
    let text =
        assess(arguments, &session, &problem).map_err(|source| Error::Fit { file: session.file.clone(), source })?;
    let _ = io::stdout().write_all(text.as_bytes());
    Ok(Outcome::Done)
}

fn assess(arguments: &Arguments, session: &Session, problem: &Problem) -> Result<String, FitError> {
    let model = &problem.model;
    let mut observations = problem.reduced.observations();
    let mut fit = fit::exact(model, &observations)?;
    let mut text = String::new();
    if let Some(alpha) = arguments.without_outliers {
        let cleaned = without_outliers(model, &observations, alpha)?;
        text.push_str(&outliers_text(model, &fit, &cleaned));
        (fit, observations) = (cleaned.fit, cleaned.observations);
    }
    let mut budget = Budget::new(&fit, model, &observations, &session.type_b)?;
    if arguments.scale_by_residuals {
        budget = budget.scaled_by_residuals(&fit);
    }
    let validity = Validity::of(&fit, model, &observations)?;
    let patterns = patterns(&fit, model, &observations)?;
    text.push_str(&budget_table(model.parameters(), &budget, arguments.coverage));
    text.push('\n');
    if arguments.correlations {
        text.push_str(&correlation_table(model.parameters(), &budget));
        text.push('\n');
    }
    text.push_str(&validity_text(model.experiment(), &validity, &patterns));
    text.push('\n');
    let range = arguments.range.map_or_else(|| highest(model, &observations), |g| g * STANDARD_GRAVITY);
    text.push_str(&prediction(model, &fit, &budget, range));
    Ok(text)
}

/// Highest nominal specific force of the plateaus [m/s^2].
fn highest(model: &MeasurementModel, observations: &[Observation]) -> f64 {
    let experiment = model.experiment();
    let force = |o: &Observation| linear::nominal(experiment, &experiment.set_points[o.set_point]).amax();
    observations.iter().map(force).fold(0.0, f64::max)
}

fn prediction(model: &MeasurementModel, fit: &Fit, budget: &Budget, range: f64) -> String {
    const POINTS: usize = 21;
    let terms: Vec<usize> =
        (0..model.parameters().len()).filter(|&j| model.parameters()[j].is_of_instrument()).collect();
    let values: Option<Vec<f64>> = terms.iter().map(|&j| fit.value(j)).collect();
    let covariance = |a: usize, b: usize| budget.covariance(terms[a], terms[b]).unwrap_or(f64::NAN);
    let covariance = DMatrix::from_fn(terms.len(), terms.len(), covariance);
    let compensated = values.and_then(|v| Compensated::new(model.error_model().with_coefficients(&v), covariance));
    let Some(compensated) = compensated else {
        return "PREDICTION  none: not all parameters of the instrument are determined\n".to_owned();
    };
    prediction_table(&[0, 1, 2].map(|axis| compensated.curve(&Vector3::ith(axis, 1.0), range, POINTS)))
}
