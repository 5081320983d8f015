//! `montecarlo`: the whole calibration repeated on simulated readings.

use centrical_session::{MonteCarloCase, MonteCarloRequest, read_plan};
use pyo3::prelude::*;

use crate::given::GivenSession;
use crate::progress::{self, Shown};
use crate::words::{probability, refused};

/// `centrical-montecarlo/1`.
#[pyfunction]
pub fn montecarlo(
    py: Python,
    subject: GivenSession,
    runs: usize,
    seed: u64,
    coverage: f64,
    linear: bool,
    noise: Option<f64>,
    typical: bool,
    shown: Shown,
) -> PyResult<String> {
    let runs = MonteCarloRequest::runs(runs).map_err(|wrong| refused("runs", wrong))?;
    let request = MonteCarloRequest { runs, seed, coverage: probability("coverage", coverage)?, linear };
    progress::run(py, &shown, |work| {
        let plan = match &subject {
            GivenSession::Path(folder) if folder.is_dir() => read_plan(&folder.join("experiment.toml"))?,
            GivenSession::Path(file) => read_plan(file)?,
            GivenSession::InMemory(..) => None,
        };
        let mut case = if let Some(plan) = plan {
            MonteCarloCase::planned(plan, noise)?
        } else {
            let session = subject.read()?;
            MonteCarloCase::refuse_noise(&session.file, noise)?;
            work.expect(2 * session.record_bytes());
            MonteCarloCase::measured(&session, &|bytes| work.advance(bytes))?
        };
        if typical {
            case = case.of_typical_unit();
        }
        work.expect(runs as u64);
        let monte_carlo = case.run(&request, &|count| work.count(count))?;
        case.report(&request, &monte_carlo).to_json()
    })
}
