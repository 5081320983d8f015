//! `schema`: the JSON Schema of a file that people write.

use std::path::PathBuf;

use centrical_session::{SettingsForm, settings_schema, write_whole};
use pyo3::prelude::*;

use crate::failure::{exception, guarded};
use crate::words::one_of;

/// The JSON Schema itself.
#[pyfunction]
pub fn schema(py: Python, form: &str, out: Option<PathBuf>) -> PyResult<String> {
    let forms = [
        ("experiment", SettingsForm::Experiment),
        ("plan", SettingsForm::Plan),
        ("truth", SettingsForm::Truth),
        ("laboratory", SettingsForm::Laboratory),
    ];
    let form = one_of("form", form, &forms)?;
    guarded(|| {
        let schema = settings_schema(form).map_err(|error| exception(py, &error))?;
        if let Some(file) = &out {
            write_whole(file, schema.as_bytes()).map_err(|error| exception(py, &error.into()))?;
        }
        Ok(schema)
    })
}
