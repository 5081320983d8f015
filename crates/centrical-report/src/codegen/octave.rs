//! MATLAB and Octave: one function file, many readings at a time.

use super::model::{Model, outside_range, vector_rows};
use super::statement::Language;

/// The function file.
pub(super) fn function(model: &Model) -> String {
    let row = |reading: &str, f: &str| format!("    {reading}, {f}");
    model
        .fill(include_str!("compensate.m.in"), &Octave)
        .replace("@vectors@", &vector_rows(model, &Octave, row))
        .replace("@outside@", &outside_range(model, &Octave))
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
