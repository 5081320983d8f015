//! Compensation as source code for others to build into their systems: C99, MATLAB and Octave, Python.
//!
//! Each file stands alone, allocates nothing that its language does not force it to, and holds test vectors with a
//! function that runs them. All three do what [`centrical_compensate`] does, statement by statement: the same start,
//! the same certified number of Newton steps, the same refusal out of range.

mod c;
mod model;
mod octave;
mod python;
mod statement;

use std::path::Path;

use centrical::STANDARD_GRAVITY;
use centrical_compensate::{Compensation, Term};
use centrical_session::{CalibrationResult, Error, MICRO_G, ObjectionName, OutputSummary, sha256};

use self::model::Model;
use crate::evaluation::{COVERAGE_PROBABILITY, expanded_along_axes};
use crate::language::Language;
use crate::number::{rounded_down, two_digits};

/// The compensation of a result as source files, for specific forces up to `range` [m/s^2], by default the range of the result.
///
/// # Errors
/// [`Error`] where the result lacks a coefficient, or its model is not certain to be invertible over the range.
pub(crate) fn source_of_result(
    result: &CalibrationResult,
    file: &Path,
    range: Option<f64>,
) -> Result<Vec<SourceFile>, Error> {
    let compensation = result.compensation(file, range)?;
    let names: Vec<String> = result.model.error_model.iter().map(|term| term.name.clone()).collect();
    let ranges = [result.calibrated_range(), compensation.certificate().range];
    let heading = [heading(result), reach(result, ranges), identity(file)].concat();
    Ok(compensation_source(&heading, &names, &compensation, ranges[0], result.output.as_ref()))
}

/// What the first comment says of a result.
fn heading(result: &CalibrationResult) -> Vec<String> {
    let session = &result.session;
    let calibrated = if session.date.is_empty() { String::new() } else { format!(", calibrated {}", session.date) };
    let axes = result.axes.as_ref().map(|axes| {
        let name = (Language::English.messages().words.axes)(&axes.name);
        format!("Specific forces in the {name}; readings and range in the axes of the newtonometers.")
    });
    let objections: Vec<&str> = result.objections().iter().map(|of| ObjectionName::from(of).word()).collect();
    let refused = (!objections.is_empty()).then(|| format!("NOT ACCEPTABLE: {}.", objections.join(", ")));
    let lines = vec![
        format!("Compensation of {}{calibrated}.", session.unit()),
        session.title.clone(),
        format!("Made by {} {}; not to be edited.", result.program.name, result.program.version),
    ];
    lines.into_iter().chain(refused).chain(axes).collect()
}

/// How far calibration and inverse reach, and how well a reading is known there, in lines.
fn reach(result: &CalibrationResult, [calibrated, certified]: [f64; 2]) -> Vec<String> {
    let g = |range: f64| rounded_down(range / STANDARD_GRAVITY, 5);
    let expanded = expanded_along_axes(result, calibrated).map(|u| u.map(|u| two_digits(u / (1e3 * MICRO_G))));
    let uncertainty = expanded.map(|u| {
        let coverage = 100.0 * COVERAGE_PROBABILITY;
        format!(
            "Expanded uncertainty ({coverage:.2} %) at the calibrated range along axes 1, 2, 3: {} mg.",
            u.join(", ")
        )
    });
    let lines = [
        format!(
            "Calibrated range: {} g, the largest reading; beyond it the error model is extrapolated.",
            g(calibrated)
        ),
        format!("Certified range: {} g, over which the inverse is unique.", g(certified)),
    ];
    lines.into_iter().chain(uncertainty).collect()
}

/// The file of the result, by the key that a store has for it.
fn identity(file: &Path) -> Vec<String> {
    let name = file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    std::fs::read(file).map(|bytes| format!("From {name}, SHA-256 {}.", sha256(&bytes))).into_iter().collect()
}

/// A file of source code.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SourceFile {
    /// Name of the file.
    pub name: &'static str,
    /// Its text.
    pub text: String,
}

/// The compensation of a unit as `centrical_compensate.h`, `.c`, `.m` (MATLAB and Octave) and `.py`, its terms under these `names`.
/// `calibrated` is the largest reading of the calibration [m/s^2]. `heading` goes into the first comment of each, a line each. With the nominal `output` of a unit in counts or volts, each also takes
/// its raw output.
pub fn compensation_source(
    heading: &[String],
    names: &[String],
    compensation: &Compensation<Vec<Term>>,
    calibrated: f64,
    output: Option<&OutputSummary>,
) -> Vec<SourceFile> {
    let model = Model { heading, names, calibrated, output, compensation };
    vec![
        SourceFile { name: "centrical_compensate.h", text: c::header(&model) },
        SourceFile { name: "centrical_compensate.c", text: c::source(&model) },
        SourceFile { name: "centrical_compensate.m", text: octave::function(&model) },
        SourceFile { name: "centrical_compensate.py", text: python::module(&model) },
    ]
}
