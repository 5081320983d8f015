//! `series`: many sessions, one on each core.

use std::path::PathBuf;

use centrical_session::{SeriesRequest, calibrate_series, matching_paths};
use pyo3::prelude::*;

use crate::progress::{self, Shown};
use crate::words;

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
        return Err(words::refused("sessions", "found none, expected one or more"));
    }
    let request = SeriesRequest { out, method: words::method(method)?, jobs, rows_only, reduced };
    progress::run(py, &shown, |work| {
        let sessions = matching_paths(&sessions)?;
        work.expect(sessions.len() as u64);
        calibrate_series(&sessions, &request, &|count| work.count(count))?.to_json()
    })
}
