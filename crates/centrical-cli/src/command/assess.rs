//! `centrical assess SESSION`: uncertainty budget and checks of a session's calibration.

use std::path::PathBuf;

use centrical_report::assessment_text;
use centrical_session::{AssessmentRequest, Error, PredictionReport, STANDARD_GRAVITY, Session, assess};

use crate::given::{above_zero, probability};
use crate::output::{Outcome, Printing};
use crate::progress;

/// Assess a session's calibration: uncertainty budget, validity, residual patterns and prediction.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical assess examples/ta-200 --coverage 0.99 --without-outliers")]
pub struct Arguments {
    /// The session folder, or its experiment.toml
    session: PathBuf,
    /// Coverage probability of the expanded uncertainties, by default that of all documents (k = 2 for a normal distribution)
    #[arg(long, default_value_t = PredictionReport::COVERAGE, value_parser = probability)]
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
    #[arg(long, value_name = "G", value_parser = above_zero, allow_hyphen_values = true)]
    range: Option<f64>,
    #[command(flatten)]
    printing: Printing,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let session = Session::read(&arguments.session)?;
    let request = AssessmentRequest {
        without_outliers: arguments.without_outliers,
        scale_by_residuals: arguments.scale_by_residuals,
        range: arguments.range.map(|g| g * STANDARD_GRAVITY),
    };
    let assessment = progress::reading(&session, arguments.printing, |progress| assess(&session, &request, progress))?;
    let text = || assessment_text(&assessment, arguments.coverage, arguments.correlations);
    arguments.printing.show(text, || assessment.report(arguments.coverage).to_json())?;
    Ok(Outcome::acceptable(assessment.result.objections().is_empty()))
}
