//! `observe`: rank, undetermined combinations, causes, remedies.

use std::path::PathBuf;

use centrical_session::{ObservabilityReport, subject};
use pyo3::prelude::*;

use crate::progress::{self, Shown};

/// `centrical-observability/1`.
#[pyfunction]
pub fn observe(py: Python, file: PathBuf, combinations: Vec<String>, shown: Shown) -> PyResult<String> {
    progress::run(py, &shown, |work| {
        let subject = subject(&file, &|bytes| work.advance(bytes))?;
        ObservabilityReport::of(&subject, &combinations)?.to_json()
    })
}
