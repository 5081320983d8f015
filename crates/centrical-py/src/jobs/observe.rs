//! `observe`: rank, undetermined combinations, causes, remedies.

use centrical_session::{ObservabilityReport, subject, subject_of};
use pyo3::prelude::*;

use crate::given::GivenSession;
use crate::progress::{self, Shown};

/// `centrical-observability/1`.
#[pyfunction]
pub fn observe(py: Python, given: GivenSession, combinations: Vec<String>, shown: Shown) -> PyResult<String> {
    progress::run(py, &shown, |work| {
        let subject = match given {
            GivenSession::Path(file) => subject(&file, &|bytes| work.advance(bytes))?,
            in_memory @ GivenSession::InMemory(..) => subject_of(&in_memory.read()?, &|bytes| work.advance(bytes))?,
        };
        ObservabilityReport::of(&subject, &combinations)?.to_json()
    })
}
