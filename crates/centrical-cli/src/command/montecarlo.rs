//! `centrical montecarlo SESSION`: the whole calibration repeated on simulated readings.

use std::io::{self, Write};
use std::path::PathBuf;

use centrical::plan::unit_of;
use centrical::uncertainty::{Method, MonteCarlo, Settings, TypeB, monte_carlo};
use centrical::{FitError, MeasurementModel, Observation, STANDARD_GRAVITY, Weight, fit};
use centrical_report::monte_carlo_table;
use centrical_session::{Error, Plan, Problem, Session, read_plan};
use nalgebra::Vector3;

use super::assess::probability;
use crate::{Outcome, progress};

/// Repeat the calibration on simulated noise and type B errors, and check the stated uncertainties.
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
    /// Coverage probability of the intervals
    #[arg(long, default_value_t = 0.95, value_parser = probability)]
    coverage: f64,
    /// The linear fit of [K5.3] alone, to see its second-order error
    #[arg(long)]
    linear: bool,
    /// White noise of the plateau means of a plan, in ug, instead of the plan's noise and durations
    #[arg(long, value_name = "UG")]
    noise: Option<f64>,
    /// Assume a unit with errors of typical size (alternating signs) instead of the plan's nominal unit, or of the
    /// session's estimates
    #[arg(long)]
    typical: bool,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let inside = arguments.session.join("experiment.toml");
    let file = if arguments.session.is_dir() { &inside } else { &arguments.session };
    let failed = |source| Error::Fit { file: file.clone(), source };
    let mut case = match read_plan(file)? {
        Some(plan) => Case::planned(plan, arguments.noise).map_err(failed)?,
        None => Case::measured(&Session::read(file)?)?,
    };
    if arguments.typical {
        case.truth = case.model.parameters().typical_in_turn();
    }
    let monte_carlo = draw(arguments, &case).map_err(failed)?;
    let text = monte_carlo_table(case.model.parameters(), &monte_carlo, arguments.coverage);
    let _ = io::stdout().write_all(format!("{}{text}", case.unit()).as_bytes());
    Ok(Outcome::Done)
}

/// What is drawn from.
struct Case {
    model: MeasurementModel,
    /// Their means are not used.
    observations: Vec<Observation>,
    truth: Vec<f64>,
    stated: TypeB,
}

impl Case {
    /// A session: the estimates of its own calibration are true.
    fn measured(session: &Session) -> Result<Self, Error> {
        let bar = progress::reading(session);
        let Problem { model, reduced } = Problem::of(session, &|bytes| bar.inc(bytes))?;
        bar.finish_and_clear();
        let observations = reduced.observations();
        let fit =
            fit::exact(&model, &observations).map_err(|source| Error::Fit { file: session.file.clone(), source })?;
        let truth = fit.state().to_vec();
        Ok(Self { model, observations, truth, stated: session.type_b })
    }

    /// A plan: the unit that it is predicted for.
    fn planned(plan: Plan, noise: Option<f64>) -> Result<Self, FitError> {
        let Plan { model, nominal, weights, type_b, .. } = plan;
        let truth = unit_of(&model, &weights, &nominal)?;
        let equal = |noise: f64| Weight::equal(weights.len(), noise * 1e-6 * STANDARD_GRAVITY);
        let weights = noise.map_or_else(|| weights.clone(), equal);
        let observation =
            |Weight { set_point, covariance }| Observation { set_point, mean: Vector3::zeros(), covariance };
        let observations = weights.into_iter().map(observation).collect();
        Ok(Self { model, observations, truth, stated: type_b })
    }

    /// Says for which unit is drawn, where that is not what was found of it.
    fn unit(&self) -> &'static str {
        if self.truth.iter().all(|value| *value == 0.0) {
            "A unit without errors, as it is predicted; --typical draws for one of typical errors\n"
        } else if self.truth == self.model.parameters().typical_in_turn() {
            "A unit of typical errors, signs in turn\n"
        } else {
            ""
        }
    }
}

fn draw(arguments: &Arguments, case: &Case) -> Result<MonteCarlo, FitError> {
    let settings = Settings {
        runs: arguments.runs,
        seed: arguments.seed,
        coverage: arguments.coverage,
        method: if arguments.linear { Method::Linear } else { Method::Exact },
        stated: case.stated,
    };
    let bar = progress::calibrations(arguments.runs);
    let done = |count: usize| bar.inc(count as u64);
    let outcome = monte_carlo(&case.model, &case.truth, &case.observations, &settings, &done);
    bar.finish_and_clear();
    outcome
}
