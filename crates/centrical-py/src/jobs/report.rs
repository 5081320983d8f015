//! `report`: the documents that a laboratory hands over, from a result.

use std::path::PathBuf;

use centrical_report::{DocumentRequest, UnitStatement, write_documents};
use centrical_session::{Axes, Dimension, DocumentsReport};
use pyo3::prelude::*;

use crate::progress;
use crate::words::{Amount, language as language_of};

/// `centrical-documents/1`; `name` is what it calls the result in the file `result`.
#[pyfunction]
pub fn report(
    py: Python,
    result: PathBuf,
    name: Option<PathBuf>,
    html: Option<PathBuf>,
    history: Option<PathBuf>,
    past: Vec<PathBuf>,
    pdf: Option<PathBuf>,
    before: Option<PathBuf>,
    dcc: Option<PathBuf>,
    code: Option<PathBuf>,
    range: Option<Amount>,
    laboratory: Option<PathBuf>,
    axes: Option<String>,
    language: &str,
) -> PyResult<String> {
    let range = Amount::optional(range, "range", Dimension::Acceleration)?;
    let language = language_of(language)?;
    let axes = axes.as_deref().map(Axes::from);
    let request =
        DocumentRequest { result, html, history, past, pdf, before, dcc, code, range, laboratory, axes, language };
    progress::run(py, &None, |_| {
        let documents = write_documents(&request)?;
        let name = name.as_deref().unwrap_or(&request.result);
        let within = documents.unit.as_ref().map(UnitStatement::is_within);
        DocumentsReport::of(name, &documents.result, &request.written(), within).to_json()
    })
}
