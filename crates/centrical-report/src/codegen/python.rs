//! Python 3: one module without dependencies; arrays of readings where NumPy is there.

use super::axes;
use super::model::Model;
use super::raw;
use super::statement::Language;
use super::vectors;

/// The module.
pub(super) fn module(model: &Model) -> String {
    let row = |reading: &str, f: &str| format!("    (({reading}), ({f})),");
    model
        .fill(include_str!("compensate.py.in"), &Python)
        .replace("@axes@", &model.in_axes(axes::PYTHON_CONSTANT, "", &Python))
        .replace("@turned@", &model.in_axes(axes::PYTHON_TURNED, "f", &Python))
        .replace("@turned_array@", &model.in_axes(axes::PYTHON_TURNED_ARRAY, "f", &Python))
        .replace("@raw@", &model.of_raw(raw::PYTHON_SOURCE, &Python))
        .replace("@raw_test@", &model.of_raw(raw::PYTHON_TEST, &Python))
        .replace("@vectors@", &vectors::rows(model, &Python, row))
        .replace("@outside@", &vectors::outside(model, &Python))
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
