//! `init`: an experiment file from what the files show.

use std::path::{Path, PathBuf};

use centrical_session::{self as session, Error, InitRequest, Place, write_whole};
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
        if let Some(file) = out.as_ref().filter(|file| file.exists()) {
            let expected = "a new file: no draft replaces what was written";
            return Err(Error::content(file, Place::Whole, "a file that exists", expected));
        }
        let folder = match out.as_deref().and_then(Path::parent) {
            Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
            _ => PathBuf::from("."),
        };
        let draft = session::init(&InitRequest { inputs, folder, tumble, six_positions }, &|done| work.advance(done))?;
        if let Some(file) = &out {
            write_whole(file, draft.text.as_bytes())?;
        }
        draft.report(out.as_deref()).to_json()
    })
}
