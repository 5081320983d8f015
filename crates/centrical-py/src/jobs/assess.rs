//! `assess`: uncertainty budget and checks of a session's calibration.

use centrical_session::{self as session, AssessmentRequest, Dimension};
use pyo3::prelude::*;

use crate::given::GivenSession;
use crate::progress::{self, Shown};
use crate::words::{Amount, probability};

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
        let session = session.read()?;
        work.expect(2 * session.record_bytes());
        session::assess(&session, &request, &|bytes| work.advance(bytes))?.report(coverage).to_json()
    })
}
