//! `calibrate`: from a session folder to calibrated parameters.

use std::path::PathBuf;

use centrical_report::{read_issuer, write_all_documents};
use centrical_session::claim_folder;
use pyo3::prelude::*;

use crate::given::{GivenSession, refuse_outputs};
use crate::progress::{self, Shown};
use crate::result::CalibrationResult;
use crate::words;

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
        let session = session.read()?;
        work.expect(2 * session.record_bytes());
        let claim = out.as_deref().map(claim_folder).transpose()?;
        if let Some(folder) = &out {
            refuse_outputs(folder, &[session.files(), laboratory.as_deref().into_iter().collect()].concat())?;
        }
        let result = centrical_session::calibrate(&session, &hold_out, method, &|bytes| work.advance(bytes))?;
        if let Some(folder) = &out {
            result.write(&folder.join("result.json"))?;
        }
        let issuer = laboratory.as_deref().map(|file| read_issuer(file, &result)).transpose()?;
        if let Some(folder) = &out {
            write_all_documents(&result, issuer.as_ref(), language, folder)?;
        }
        drop(claim);
        Ok((result, issuer.and_then(|issuer| issuer.unit)))
    })?;
    let mut result = CalibrationResult::from(result);
    result.unit = unit;
    Ok(result)
}
