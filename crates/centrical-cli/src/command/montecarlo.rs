//! `centrical montecarlo SESSION`: the whole calibration repeated on simulated readings.

use std::path::PathBuf;

use centrical_report::monte_carlo_text;
use centrical_session::{Error, MonteCarloCase, MonteCarloRequest, OnProgress, Session, read_plan};

use crate::given::{above_zero, probability};
use crate::output::{Outcome, Printing};
use crate::progress;

/// Repeat the calibration on simulated noise and type B errors, and check the stated uncertainties.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical montecarlo examples/ta-200 --runs 1000 --seed 7")]
pub struct Arguments {
    /// The session folder, or its experiment.toml; one without records and plateau table is a plan
    session: PathBuf,
    /// Number of calibrations
    #[arg(long, default_value_t = 10_000, value_parser = runs)]
    runs: usize,
    /// Seed of the random numbers: the same seed gives the same numbers for any number of threads
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Coverage probability of the intervals
    #[arg(long, default_value_t = 0.95, value_parser = probability)]
    coverage: f64,
    /// Make the linear fit of [K5.3] alone, which shows its second-order error
    #[arg(long)]
    linear: bool,
    /// White noise of the plateau means of a plan, in ug, instead of the plan's noise and durations
    #[arg(long, value_name = "UG", value_parser = above_zero, allow_hyphen_values = true)]
    noise: Option<f64>,
    /// Assume a unit with errors of typical size (alternating signs) instead of the plan's nominal unit, or of the
    /// session's estimates
    #[arg(long)]
    typical: bool,
    #[command(flatten)]
    printing: Printing,
}

fn runs(text: &str) -> Result<usize, String> {
    let runs = text.parse().map_err(|_| format!("found {text:?}, expected a number of calibrations"))?;
    MonteCarloRequest::runs(runs)
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let file = &arguments.session;
    let mut case = if let Some(plan) = read_plan(file)? {
        MonteCarloCase::planned(plan, arguments.noise)?
    } else {
        MonteCarloCase::refuse_noise(file, arguments.noise)?;
        let session = Session::read(file)?;
        progress::reading(&session, arguments.printing, |progress| MonteCarloCase::measured(&session, progress))?
    };
    if arguments.typical {
        case = case.of_typical_unit();
    }
    let request = MonteCarloRequest {
        runs: arguments.runs,
        seed: arguments.seed,
        coverage: arguments.coverage,
        linear: arguments.linear,
    };
    let template = "calibrating {bar:30} {pos}/{len}, {eta} left";
    let job = |progress: OnProgress<usize>| case.run(&request, progress);
    let monte_carlo = progress::counting(template, Some(arguments.runs), arguments.printing.quiet, job)?;
    let text = || monte_carlo_text(&case, &monte_carlo, arguments.coverage);
    arguments.printing.show(text, || case.report(&request, &monte_carlo).to_json())?;
    Ok(Outcome::acceptable(monte_carlo.is_acceptable(arguments.coverage)))
}
