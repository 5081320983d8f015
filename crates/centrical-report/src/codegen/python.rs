//! Python 3: one module without dependencies; arrays of readings where NumPy is there.

use super::model::{Model, outside_range, vector_rows};
use super::statement::Language;

/// The module.
pub(super) fn module(model: &Model) -> String {
    let row = |reading: &str, f: &str| format!("    (({reading}), ({f})),");
    model
        .fill(include_str!("compensate.py.in"), &Python)
        .replace("@vectors@", &vector_rows(model, &Python, row))
        .replace("@outside@", &outside_range(model, &Python))
}

struct Python;

impl Language for Python {
    fn comment(&self) -> &'static str {
        "#"
    }

    fn table_line(&self, number: &str, remark: &str) -> String {
        format!("    {number},  # {remark}")
    }

    fn coefficient(&self, k: usize) -> String {
        format!("c[{k}]")
    }

    fn component(&self, j: usize) -> String {
        format!("f[{j}]")
    }

    fn sign(&self, j: usize) -> String {
        format!("(1.0 - 2.0 * (f[{j}] < 0.0))")
    }

    fn add_to_error(&self, i: usize, value: &str, remark: &str) -> String {
        format!("    error[{i}] = error[{i}] + {value}  # {remark}")
    }

    fn add_to_gain(&self, i: usize, j: usize, value: &str) -> String {
        format!("    gain[{i}][{j}] = gain[{i}][{j}] + {value}")
    }
}
