//! `tumble`: a unit that was turned by hand or on a table, calibrated by gravity alone.

use std::path::{Path, PathBuf};

use centrical_report::{Language, write_all_documents};
use centrical_session::{Dimension, STANDARD_GRAVITY, TumbleRequest, claim_folder, refuse_inputs};
use pyo3::prelude::*;

use crate::progress::{self, Shown};
use crate::result::CalibrationResult;
use crate::words::{Amount, Named, column, sampling_rate};

/// The result of records; into the folder `out` as well, with the rests as a session and the report, if one is given.
#[pyfunction]
#[allow(clippy::too_many_arguments, reason = "what is said of a record")]
pub fn tumble(
    py: Python,
    records: Vec<PathBuf>,
    time: Named,
    rate: Option<Amount>,
    readings: [Named; 3],
    unit: String,
    gravity: [Option<Amount>; 2],
    terms: Option<Vec<String>>,
    serial: String,
    date: String,
    out: Option<PathBuf>,
    shown: Shown,
) -> PyResult<CalibrationResult> {
    let [first, second, third] = readings;
    let [gravity, uncertainty] = gravity.map(|amount| Amount::optional(amount, "gravity", Dimension::Acceleration));
    let (gravity, uncertainty) = (gravity?, uncertainty?);
    let anywhere = if gravity.is_some() { 0.0 } else { TumbleRequest::GRAVITY_ANYWHERE };
    let request = TumbleRequest {
        files: records,
        time: column("time", time)?,
        rate: sampling_rate(rate)?,
        readings: [column("readings", first)?, column("readings", second)?, column("readings", third)?],
        unit,
        gravity: gravity.unwrap_or(STANDARD_GRAVITY),
        gravity_uncertainty: uncertainty.unwrap_or(anywhere),
        terms: terms.unwrap_or_else(|| TumbleRequest::USUAL_TERMS.map(str::to_owned).to_vec()),
        serial,
        date,
    };
    let result = progress::run(py, &shown, |work| {
        let folder = out.as_deref().unwrap_or(Path::new(""));
        let claim = out.as_deref().map(claim_folder).transpose()?;
        let read: Vec<&Path> = request.files.iter().map(PathBuf::as_path).collect();
        refuse_inputs(&["result.json", "report.html"].map(|name| folder.join(name)), &read)?;
        let tumble = centrical_session::tumble(&request, folder, &|bytes| work.advance(bytes))?;
        if out.is_some() {
            tumble.write(&request.files, folder)?;
            write_all_documents(&tumble.result, None, Language::English, folder)?;
        }
        drop(claim);
        Ok(tumble.result)
    })?;
    Ok(result.into())
}
