//! `compare`: calibrations of one unit, two by two.

use std::path::PathBuf;

use centrical_report::comparison_plot;
use centrical_session::{CalibrationResult, ComparisonRequest, advance, compare_results, refuse_inputs, write_whole};
use pyo3::prelude::*;

use crate::given::GivenResult;
use crate::progress;
use crate::words::refused;

/// `centrical-comparison/1`.
#[pyfunction]
pub fn compare(
    py: Python,
    results: Vec<GivenResult>,
    years: Option<f64>,
    other_units: bool,
    svg: Option<PathBuf>,
) -> PyResult<String> {
    if results.len() < 2 {
        return Err(refused("results", format!("found {}, expected two or more", results.len())));
    }
    progress::run(py, &None, |work| {
        let mut named = Vec::new();
        let mut files = Vec::new();
        for (n, result) in (1..).zip(&results) {
            advance(&|done| work.advance(done), 0)?;
            named.push(match result {
                GivenResult::Path(file) => {
                    files.push(file.clone());
                    (file.clone(), CalibrationResult::read(file)?)
                }
                GivenResult::Read(result) => (PathBuf::from(format!("result {n}")), result.get().result.clone()),
            });
        }
        let named: Vec<_> = named.iter().map(|(file, result)| (file.as_path(), result)).collect();
        let report = compare_results(&named, ComparisonRequest { years, other_units })?;
        if let Some(file) = &svg {
            refuse_inputs(std::slice::from_ref(file), &files)?;
            write_whole(file, comparison_plot(&report).as_bytes())?;
        }
        report.to_json()
    })
}
