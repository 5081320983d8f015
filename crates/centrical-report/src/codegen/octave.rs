//! MATLAB and Octave: one function file, many readings at a time.

use super::axes;
use super::model::Model;
use super::raw;
use super::statement::Language;
use super::vectors;

/// The function file.
pub(super) fn function(model: &Model) -> String {
    let row = |reading: &str, f: &str| format!("    {reading}, {f}");
    let raw = match model.output {
        Some(_) => model.of_raw(raw::OCTAVE_SOURCE, &Octave),
        None => raw::OCTAVE_WITHOUT.to_owned(),
    };
    model
        .fill(include_str!("compensate.m.in"), &Octave)
        .replace("@axes@", &model.in_axes(axes::OCTAVE, "", &Octave))
        .replace("@raw_help@", &model.of_raw(raw::OCTAVE_HELP, &Octave))
        .replace("@raw@", &raw)
        .replace("@raw_test@", &model.of_raw(raw::OCTAVE_TEST, &Octave))
        .replace("@vectors@", &vectors::rows(model, &Octave, row))
        .replace("@outside@", &vectors::outside(model, &Octave))
}

struct Octave;

impl Language for Octave {
    fn comment(&self) -> &'static str {
        "%"
    }

    fn table_line(&self, number: &str, remark: &str) -> String {
        format!("    {number} % {remark}")
    }

    fn coefficient(&self, k: usize) -> String {
        format!("c({})", k + 1)
    }

    fn component(&self, j: usize) -> String {
        format!("f{}", j + 1)
    }

    fn sign(&self, j: usize) -> String {
        format!("(1 - 2 * (f{} < 0))", j + 1)
    }

    fn times(&self) -> &'static str {
        " .* "
    }

    fn add_to_error(&self, i: usize, value: &str, remark: &str) -> String {
        format!("  e{n} = e{n} + {value}; % {remark}", n = i + 1)
    }

    fn add_to_gain(&self, i: usize, j: usize, value: &str) -> String {
        format!("  g{n} = g{n} + {value};", n = 10 * (i + 1) + j + 1)
    }
}
