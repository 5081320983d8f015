//! From measurements to a calibration, and its checks: `calibrate`, `series`, `models`, `assess`, `montecarlo`, `compare`.

use std::path::PathBuf;

use centrical_report::{Language, comparison_plot, read_issuer, refuse_outputs, write_all_documents};
use centrical_session::{
    self as session, AssessmentRequest, ComparisonRequest, Dimension, ModelsReport, MonteCarloCase, MonteCarloRequest,
    SeriesRequest, advance, calibrate_series, claim_folder, compare_results, matching_paths, read_plan, refuse_inputs,
    select_model, write_whole,
};
use pyo3::prelude::*;

use crate::given::{GivenResult, GivenSession};
use crate::progress::{self, Shown};
use crate::result::CalibrationResult;
use crate::words::{self, Amount, probability, refused};

/// The result of a session; into the folder `out` as well, with its report, if one is given.
#[pyfunction]
pub fn calibrate(
    py: Python,
    session: GivenSession,
    method: &str,
    hold_out: Vec<String>,
    out: Option<PathBuf>,
    laboratory: Option<PathBuf>,
    language: &str,
    shown: Shown,
) -> PyResult<CalibrationResult> {
    let (method, language) = (words::method(method)?, words::language(language)?);
    let hold_out = words::plateaus("hold_out", &hold_out)?;
    let (result, unit) = progress::run(py, &shown, |work| {
        let session = session.read_for(work)?;
        let claim = out.as_deref().map(claim_folder).transpose()?;
        if let Some(folder) = &out {
            refuse_outputs(
                Some(&folder.join("result.json")),
                Some(folder),
                &[session.files(), laboratory.as_deref().into_iter().collect()].concat(),
                [&session.unit_model, &session.unit_serial],
            )?;
        }
        let result = session::calibrate(&session, &hold_out, method, &|bytes| work.advance(bytes))?;
        let issuer = laboratory.as_deref().map(|file| read_issuer(file, &result)).transpose();
        if let Some(folder) = &out {
            write_all_documents(&result, issuer.as_ref().ok().and_then(Option::as_ref), language, folder)?;
        }
        let issuer = issuer?;
        drop(claim);
        Ok((result, issuer.and_then(|issuer| issuer.unit)))
    })?;
    let mut result = CalibrationResult::from(result);
    result.unit = unit;
    Ok(result)
}

/// `centrical-series/1`.
#[pyfunction]
pub fn series(
    py: Python,
    sessions: Vec<PathBuf>,
    out: PathBuf,
    method: &str,
    jobs: Option<usize>,
    rows_only: bool,
    reduced: bool,
    shown: Shown,
) -> PyResult<String> {
    if sessions.is_empty() {
        return Err(refused("sessions", "found none, expected one or more"));
    }
    let request = SeriesRequest { out, method: words::method(method)?, jobs, rows_only, reduced };
    progress::run(py, &shown, |work| {
        let sessions = matching_paths(&sessions)?;
        work.expect(sessions.len() as u64);
        calibrate_series(&sessions, &request, &|count| work.count(count))?.to_json()
    })
}

/// `centrical-models/1`.
#[pyfunction]
pub fn models(py: Python, session: GivenSession, shown: Shown) -> PyResult<String> {
    progress::run(py, &shown, |work| {
        let session = session.read_for(work)?;
        let selection = select_model(&session, &|bytes| work.advance(bytes))?;
        ModelsReport::of(&selection, &session.title).to_json()
    })
}

/// `centrical-assessment/1`.
#[pyfunction]
pub fn assess(
    py: Python,
    session: GivenSession,
    coverage: f64,
    without_outliers: Option<f64>,
    scale_by_residuals: bool,
    range: Option<Amount>,
    shown: Shown,
) -> PyResult<String> {
    let coverage = probability("coverage", coverage)?;
    let without_outliers = without_outliers.map(|error| probability("without_outliers", error)).transpose()?;
    let range = Amount::optional(range, "range", Dimension::Acceleration)?;
    let request = AssessmentRequest { without_outliers, scale_by_residuals, range };
    progress::run(py, &shown, |work| {
        let session = session.read_for(work)?;
        session::assess(&session, &request, &|bytes| work.advance(bytes))?.report(coverage).to_json()
    })
}

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
            GivenSession::Path(path) => read_plan(path)?,
            GivenSession::InMemory(..) => None,
        };
        let mut case = if let Some(plan) = plan {
            MonteCarloCase::planned(plan, noise)?
        } else {
            let session = subject.read_for(work)?;
            MonteCarloCase::refuse_noise(&session.file, noise)?;
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

/// `centrical-comparison/1`.
#[pyfunction]
pub fn compare(
    py: Python,
    results: Vec<GivenResult>,
    years: Option<f64>,
    other_units: bool,
    svg: Option<PathBuf>,
) -> PyResult<String> {
    if results.len() < 2 {
        return Err(refused("results", format!("found {}, expected two or more", results.len())));
    }
    progress::run(py, &None, |work| {
        let mut named = Vec::new();
        let mut files = Vec::new();
        for (n, result) in (1..).zip(&results) {
            advance(&|done| work.advance(done), 0)?;
            named.push(match result {
                GivenResult::Path(file) => {
                    files.push(file.clone());
                    (file.clone(), session::CalibrationResult::read(file)?)
                }
                GivenResult::Read(result) => (PathBuf::from(format!("result {n}")), result.get().result.clone()),
            });
        }
        let named: Vec<_> = named.iter().map(|(file, result)| (file.as_path(), result)).collect();
        let report = compare_results(&named, ComparisonRequest { years, other_units })?;
        if let Some(file) = &svg {
            refuse_inputs(std::slice::from_ref(file), &files)?;
            write_whole(file, comparison_plot(&report, Language::English).as_bytes())?;
        }
        report.to_json()
    })
}
