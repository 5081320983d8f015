//! `centrical montecarlo SESSION`: the whole calibration repeated on drawn readings.

use std::io::{self, Write};
use std::path::PathBuf;

use centrical::uncertainty::{Method, MonteCarlo, Settings, monte_carlo};
use centrical::{FitError, MeasurementModel, Observation, STANDARD_GRAVITY, Weight, fit};
use centrical_io::{Error, Plan, Problem, Session};
use centrical_report::monte_carlo_table;
use nalgebra::Vector3;

use super::assess::probability;
use crate::{Outcome, progress};

/// Draw noise and stated uncertainties, calibrate again and again, and compare with what is stated.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The session folder, or its experiment.toml; one without records and plateau table is a plan
    session: PathBuf,
    /// Number of calibrations
    #[arg(long, default_value_t = 10_000)]
    runs: usize,
    /// Seed of the random numbers: the same seed gives the same numbers for any number of threads
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Probability that the intervals are to cover
    #[arg(long, default_value_t = 0.95, value_parser = probability)]
    coverage: f64,
    /// The linear fit of [K5.3] alone, to see its second-order error
    #[arg(long)]
    linear: bool,
    /// White noise of the means of a plan, in ug, in place of its own noise and durations
    #[arg(long, value_name = "UG")]
    noise: Option<f64>,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let session = Session::read(&arguments.session)?;
    let failed = |source| Error::Fit { file: session.file.clone(), source };
    let has_data = session.plateaus.is_some() || session.mountings.iter().any(|m| m.record.is_some());
    let (model, observations, truth) = if has_data {
        let bar = progress::reading(&session);
        let problem = Problem::of(&session, &|bytes| bar.inc(bytes))?;
        bar.finish_and_clear();
        let observations = problem.reduced.observations();
        let fit = fit::exact(&problem.model, &observations, session.speed_uncertainty).map_err(failed)?;
        (problem.model, observations, fit.state().to_vec())
    } else {
        planned(arguments, &session)?
    };
    let monte_carlo = draw(arguments, &session, &model, &observations, &truth).map_err(failed)?;
    let text = monte_carlo_table(model.parameters(), &monte_carlo, arguments.coverage);
    let _ = io::stdout().write_all(text.as_bytes());
    Ok(Outcome::Done)
}

/// A plan: the experiment with the noise it reckons with, and a unit with no errors.
fn planned(arguments: &Arguments, session: &Session) -> Result<(MeasurementModel, Vec<Observation>, Vec<f64>), Error> {
    let model = session.model()?;
    let weights = match (arguments.noise, Plan::read(&session.file)?) {
        (None, Some(plan)) => plan.weights,
        (noise, _) => {
            let sigma = noise.unwrap_or(10.0) * 1e-6 * STANDARD_GRAVITY;
            Weight::equal(model.experiment().set_points.len(), sigma)
        }
    };
    let truth = vec![0.0; model.parameters().len()];
    let observation = |Weight { set_point, covariance }| Observation { set_point, mean: Vector3::zeros(), covariance };
    Ok((model, weights.into_iter().map(observation).collect(), truth))
}

fn draw(
    arguments: &Arguments,
    session: &Session,
    model: &MeasurementModel,
    observations: &[Observation],
    truth: &[f64],
) -> Result<MonteCarlo, FitError> {
    let settings = Settings {
        runs: arguments.runs,
        seed: arguments.seed,
        coverage: arguments.coverage,
        method: if arguments.linear { Method::Linear } else { Method::Exact },
        stated: session.type_b,
    };
    let bar = progress::calibrations(arguments.runs);
    let done = |count: usize| bar.inc(count as u64);
    let outcome = monte_carlo(model, truth, observations, session.speed_uncertainty, &settings, &done);
    bar.finish_and_clear();
    outcome
}
