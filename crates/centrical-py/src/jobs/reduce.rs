//! `reduce`: from records to a session of plateau means.

use std::path::PathBuf;

use centrical_session::{ReductionReport, reduce_without_inputs, write_reduced};
use pyo3::prelude::*;

use crate::given::GivenSession;
use crate::progress::{self, Shown};
use crate::words;

/// `centrical-reduction/1`.
#[pyfunction]
pub fn reduce(py: Python, session: GivenSession, out: PathBuf, format: &str, shown: Shown) -> PyResult<String> {
    let format = words::format(format)?;
    progress::run(py, &shown, |work| {
        let session = session.read()?;
        work.expect(2 * session.record_bytes());
        let (session, reduced) = reduce_without_inputs(&session, &|bytes| work.advance(bytes))?;
        write_reduced(&session, &reduced, None, format, &out, &|bytes| work.advance(bytes))?;
        ReductionReport::of(&session, &reduced, &out).to_json()
    })
}
