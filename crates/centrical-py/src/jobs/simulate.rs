//! `simulate`: a session as a laboratory would deliver it.

use std::path::PathBuf;

use centrical_session::{Session, SimulationReport, Truth, simulate_session};
use pyo3::prelude::*;

use crate::progress::{self, Shown};
use crate::words;

/// `centrical-simulation/1`.
#[pyfunction]
pub fn simulate(
    py: Python,
    plan: PathBuf,
    truth: PathBuf,
    seed: u64,
    out: PathBuf,
    format: &str,
    shown: Shown,
) -> PyResult<String> {
    let format = words::format(format)?;
    progress::run(py, &shown, |work| {
        let plan = Session::read(&plan)?;
        let truth = Truth::read(&truth, &plan, seed)?;
        let plan = &truth.plan;
        work.expect((plan.mountings.len() + plan.rest_tables.len()) as u64);
        simulate_session(&truth, seed, format, &out, &|count| work.count(count))?;
        SimulationReport::of(plan, seed, &out).to_json()
    })
}
