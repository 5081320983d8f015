//! What is done with records: `reduce`, `noise`.

use std::path::{Path, PathBuf};

use centrical_report::write_noise;
use centrical_session::{
    Error, Estimator, Folder, NoiseAnalysis, NoiseRequest, Quantity, ReductionReport, noise_of, noise_of_plateau,
    reduce_without_inputs, write_reduced,
};
use pyo3::prelude::*;

use crate::given::{GivenFile, GivenSession};
use crate::progress::{self, Shown};
use crate::words::{self, Amount, GivenColumn, column, one_of, plateau};

/// `centrical-reduction/1`.
#[pyfunction]
pub fn reduce(py: Python, session: GivenSession, out: PathBuf, format: &str, shown: Shown) -> PyResult<String> {
    let format = words::format(format)?;
    progress::run(py, &shown, |work| {
        let session = session.read_for(work)?;
        let (session, reduced) = reduce_without_inputs(&session, &|bytes| work.advance(bytes))?;
        write_reduced(&session, &reduced, None, format, &out, &|bytes| work.advance(bytes))?;
        ReductionReport::of(&session, &reduced, &out).to_json()
    })
}

/// `centrical-noise/1`.
#[pyfunction]
pub fn noise(
    py: Python,
    source: GivenFile,
    plateau_name: Option<&str>,
    session: Option<PathBuf>,
    time: GivenColumn,
    rate: Option<Amount>,
    readings: Vec<GivenColumn>,
    unit: String,
    window: [f64; 2],
    estimators: Vec<String>,
    out: Option<PathBuf>,
    shown: Shown,
) -> PyResult<String> {
    let (file, folder) = source.in_folder(Folder::default());
    let request = NoiseRequest {
        file,
        folder,
        plateau: plateau_name.map(|name| plateau("plateau", name)).transpose()?,
        session,
        time: column("time", time)?,
        rate: Amount::checked(rate, "rate", Quantity::sampling_rate)?,
        readings: readings.into_iter().map(|name| column("readings", name)).collect::<PyResult<_>>()?,
        unit,
        window,
        estimators: named(&estimators)?,
    };
    progress::run(py, &shown, |work| {
        let (analysis, _) = noise_of(&request, &|bytes| work.advance(bytes))?;
        written(&analysis, out.as_deref())
    })
}

/// The same of a plateau of a session that is in memory.
#[pyfunction]
pub fn noise_of_session(
    py: Python,
    session: GivenSession,
    plateau_name: Option<&str>,
    estimators: Vec<String>,
    out: Option<PathBuf>,
    shown: Shown,
) -> PyResult<String> {
    let plateau = plateau_name.map(|name| plateau("plateau", name)).transpose()?;
    let estimators = named(&estimators)?;
    progress::run(py, &shown, |work| {
        let (analysis, _) = noise_of_plateau(&session.read()?, plateau, &estimators, &|bytes| work.advance(bytes))?;
        written(&analysis, out.as_deref())
    })
}

/// The document; with its drawing in a folder, if one is given.
fn written(analysis: &NoiseAnalysis, folder: Option<&Path>) -> Result<String, Error> {
    folder.map_or(Ok(()), |folder| write_noise(analysis, folder))?;
    Ok(analysis.to_json())
}

fn named(names: &[String]) -> PyResult<Vec<Estimator>> {
    let words = Estimator::ALL.map(|estimator| (estimator.name(), estimator));
    let some = |name: &String| match name.as_str() {
        "all" => Ok(Estimator::ALL.to_vec()),
        name => one_of("estimators", name, &words).map(|estimator| vec![estimator]),
    };
    Ok(names.iter().map(some).collect::<PyResult<Vec<_>>>()?.concat())
}
