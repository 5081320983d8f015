//! `compensate`: from a record of readings to a record of specific forces.

use std::path::PathBuf;

use centrical_session::{self as session, Axes, CompensationRequest, Dimension};
use pyo3::prelude::*;

use crate::progress::{self, Shown};
use crate::words::Amount;

/// `centrical-compensation/1`.
#[pyfunction]
pub fn compensate(
    py: Python,
    result: PathBuf,
    record: PathBuf,
    out: PathBuf,
    session: Option<PathBuf>,
    range: Option<Amount>,
    within_calibration: bool,
    axes: Option<String>,
    shown: Shown,
) -> PyResult<String> {
    let range = Amount::optional(range, "range", Dimension::Acceleration)?;
    let axes = axes.as_deref().map(Axes::from);
    let request = CompensationRequest { result, record, out, session, range, within_calibration, axes };
    progress::run(py, &shown, |work| {
        work.expect(request.record.metadata().map_or(0, |metadata| metadata.len()));
        let (compensated, certificate, objections) = session::compensate(&request, &|bytes| work.advance(bytes))?;
        compensated.report(&request, &certificate, &objections).to_json()
    })
}
