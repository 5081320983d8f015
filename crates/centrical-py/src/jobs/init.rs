//! `init`: an experiment file from what the files show.

use std::path::PathBuf;

use centrical_session::{self as session, InitRequest, write_whole};
use pyo3::prelude::*;

use crate::progress;
use crate::words::one_of;

/// `centrical-draft/1`.
#[pyfunction]
pub fn init(
    py: Python,
    inputs: Vec<PathBuf>,
    out: Option<PathBuf>,
    positions: Option<&str>,
    tumble: Option<PathBuf>,
) -> PyResult<String> {
    let six_positions = positions.map_or(Ok(false), |word| one_of("positions", word, &[("six", true)]))?;
    progress::run(py, &None, |work| {
        let request = InitRequest { inputs, out, tumble, six_positions };
        let draft = session::init(&request, &|done| work.advance(done))?;
        if let Some(file) = &request.out {
            write_whole(file, draft.text.as_bytes())?;
        }
        draft.report(request.out.as_deref()).to_json()
    })
}
