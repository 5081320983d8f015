//! `models`: which error model the data support.

use centrical_session::{ModelsReport, select_model};
use pyo3::prelude::*;

use crate::given::GivenSession;
use crate::progress::{self, Shown};

/// `centrical-models/1`.
#[pyfunction]
pub fn models(py: Python, session: GivenSession, shown: Shown) -> PyResult<String> {
    progress::run(py, &shown, |work| {
        let session = session.read()?;
        work.expect(2 * session.record_bytes());
        let selection = select_model(&session, &|bytes| work.advance(bytes))?;
        ModelsReport::of(&selection, &session.title).to_json()
    })
}
