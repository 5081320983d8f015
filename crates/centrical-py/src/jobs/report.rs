//! What is handed over: `report`, `compensate`, and curves as the report draws them.

use std::path::PathBuf;

use centrical_report::plot::{Axis, Plot, Point, Series};
use centrical_report::{DocumentRequest, UnitStatement, write_documents};
use centrical_session::{self as session, Axes, CompensationRequest, Dimension, DocumentsReport};
use pyo3::prelude::*;

use crate::progress::{self, Shown};
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

/// `centrical-compensation/1`.
#[pyfunction]
pub fn compensate(
    py: Python,
    result: PathBuf,
    record: PathBuf,
    out: PathBuf,
    session: Option<PathBuf>,
    range: Option<Amount>,
    within_calibration: bool,
    axes: Option<String>,
    shown: Shown,
) -> PyResult<String> {
    let range = Amount::optional(range, "range", Dimension::Acceleration)?;
    let axes = axes.as_deref().map(Axes::from);
    let request = CompensationRequest { result, record, out, session, range, within_calibration, axes };
    progress::run(py, &shown, |work| {
        work.expect(request.record.metadata().map_or(0, |metadata| metadata.len()));
        let (compensated, certificate, objections) = session::compensate(&request, &|bytes| work.advance(bytes))?;
        compensated.report(&request, &certificate, &objections).to_json()
    })
}

/// Label, abscissae, ordinates, and the ends of the interval of each.
type Curve = (String, Vec<f64>, Vec<f64>, Vec<f64>, Vec<f64>);

/// A plot on logarithmic axes as SVG: markers with intervals, joined by lines. A point that has no place there is left out.
#[pyfunction]
pub fn draw_curves(title: String, x_label: String, y_label: String, curves: Vec<Curve>) -> String {
    let mut plot = Plot::new(title, Axis::log(x_label), Axis::log(y_label));
    for (label, x, y, lower, upper) in curves {
        let values = x.into_iter().zip(y).zip(lower.into_iter().zip(upper));
        let point = |((x, y), (low, high)): ((f64, f64), (f64, f64))| {
            if low.is_nan() || high.is_nan() { Point::new(x, y) } else { Point::new(x, y).with_interval(low, high) }
        };
        plot = plot.with(Series::line_and_markers(label, values.map(point).collect()));
    }
    plot.to_svg()
}
