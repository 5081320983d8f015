//! Python 3: one module without dependencies; arrays of readings where NumPy is there.

use super::model::{Model, outside_range, vector_rows};
use super::statement::Language;

/// The module.
pub(super) fn module(model: &Model) -> String {
    let row = |reading: &str, f: &str| format!("    (({reading}), ({f})),");
    model
        .fill(include_str!("compensate.py.in"), &Python)
        .replace("@axes@", &model.in_axes(AXES, "", &Python))
        .replace("@turned@", &model.in_axes(TURNED, "f", &Python))
        .replace("@turned_array@", &model.in_axes(TURNED_ARRAY, "f", &Python))
        .replace("@raw@", &model.of_raw(RAW_SOURCE, &Python))
        .replace("@raw_test@", &model.of_raw(RAW_TEST, &Python))
        .replace("@vectors@", &vector_rows(model, &Python, row))
        .replace("@outside@", &outside_range(model, &Python))
}

/// Constants and functions for a unit in counts or volts: its raw output is taken to readings first.
const RAW_SOURCE: &str = "
RAW_UNIT = \"@raw_unit@\"
RAW_SCALE = (@raw_scale@)  # Nominal scale, raw unit per m/s^2.
RAW_BIAS = (@raw_bias@)  # Nominal bias, raw unit.


def compensate_raw(raw):
    \"\"\"Specific force of the raw output of the unit, in RAW_UNIT.\"\"\"
    raw = _three(raw)
    return compensate([(raw[i] - RAW_BIAS[i]) / RAW_SCALE[i] for i in range(3)])


def compensate_raw_array(raw):
    \"\"\"Specific forces of raw output, an array (n, 3), in RAW_UNIT; NaN as of compensate_array. Needs NumPy.\"\"\"
    import numpy

    return compensate_array((_rows(raw, numpy) - RAW_BIAS) / RAW_SCALE)

";

/// A part of the self-test of such a unit: the vectors again, as raw output.
const RAW_TEST: &str = "
    for reading, expected in VECTORS:
        raw = [reading[i] * RAW_SCALE[i] + RAW_BIAS[i] for i in range(3)]
        largest = max(abs(x) for x in reading + expected)
        if not all(abs(x - y) <= 1e-9 * largest for x, y in zip(compensate_raw(raw), expected)):
            raise AssertionError(f\"{raw}: expected {expected}\")";

/// Constant of a result in other axes.
const AXES: &str = "
# From the axes of specific forces to those of the newtonometers, by rows.
AXES = (
    (@axes_1@),
    (@axes_2@),
    (@axes_3@),
)
";

/// A specific force in them.
const TURNED: &str = "tuple(sum(AXES[i][j] * f[i] for i in range(3)) for j in range(3))";

/// Columns of specific forces in them.
const TURNED_ARRAY: &str = "numpy.array([sum(AXES[i][j] * f[i] for i in range(3)) for j in range(3)])";

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
