//! C99: one header, one source, in double and single precision.

use super::model::{Model, outside_range, vector_rows};
use super::statement::Language;

/// The header.
pub(super) fn header(model: &Model) -> String {
    let raw = model.of_raw(RAW_HEADER, &DOUBLE);
    model.fill(include_str!("compensate.h.in"), &DOUBLE).replace("@raw@", &raw)
}

/// The source: the same text once for each precision, then the test vectors.
pub(super) fn source(model: &Model) -> String {
    let body = |c: &C| {
        let text = model.fill(include_str!("compensate_body.c.in"), c);
        let text = text.replace("@raw@", &model.of_raw(RAW_SOURCE, c));
        let text = text.replace("@axes@", &model.in_axes(AXES, "", c));
        let text = text.replace("@turned@", &model.in_axes(TURNED, "x[i]", c));
        text.replace("@real@", c.real).replace("@name@", c.name).replace("@literal@", c.literal)
    };
    let row = |reading: &str, f: &str| format!("    {{{{{reading}}}, {{{f}}}}},");
    model
        .fill(include_str!("compensate.c.in"), &DOUBLE)
        .replace("@double@", &body(&DOUBLE))
        .replace("@single@", &body(&SINGLE))
        .replace("@raw_test@", &model.of_raw(RAW_TEST, &DOUBLE))
        .replace("@vectors@", &vector_rows(model, &DOUBLE, row))
        .replace("@outside@", &outside_range(model, &DOUBLE))
}

/// Declarations of the header for a unit in counts or volts.
const RAW_HEADER: &str = "
/*
 * The same of the raw output of the unit in @raw_unit@, by its nominal scale (@raw_scale@) per m/s^2
 * and bias (@raw_bias@).
 */
int centrical_compensate_raw(const double raw[3], double f[3]);
int centrical_compensate_raw_float(const float raw[3], float f[3]);
";

/// Definitions for a unit in counts or volts, once for each precision: its raw output is taken to readings first.
const RAW_SOURCE: &str = "
int centrical_compensate_raw@name@(const @real@ raw[3], @real@ f[3]) {
    static const @real@ scale[3] = {@raw_scale@}, raw_bias[3] = {@raw_bias@};
    @real@ reading[3];
    int i;
    for (i = 0; i < 3; i++) { reading[i] = (raw[i] - raw_bias[i]) / scale[i]; }
    return centrical_compensate@name@(reading, f);
}
";

/// A part of the self-test of such a unit: the vectors again, as raw output.
const RAW_TEST: &str = "
    for (n = 0; n < count; n++) {
        static const double scale[3] = {@raw_scale@}, raw_bias[3] = {@raw_bias@};
        double raw[3];
        for (i = 0; i < 3; i++) { raw[i] = vectors[n][0][i] * scale[i] + raw_bias[i]; }
        failures += centrical_compensate_raw(raw, f) != 0 || !agrees(f, vectors[n], 1e-9);
    }";

/// Constant of a result in other axes, once for each precision.
const AXES: &str = "
/* From the axes of specific forces to those of the newtonometers, by rows. */
static const @real@ axes@name@[3][3] = {
    {@axes_1@},
    {@axes_2@},
    {@axes_3@},
};
";

/// Component `i` of a specific force in them.
const TURNED: &str = "axes@name@[0][i] * x[0] + axes@name@[1][i] * x[1] + axes@name@[2][i] * x[2]";

/// C in one precision.
struct C {
    real: &'static str,
    /// What names of functions end in.
    name: &'static str,
    /// What literals end in.
    literal: &'static str,
}

const DOUBLE: C = C { real: "double", name: "", literal: "" };
const SINGLE: C = C { real: "float", name: "_float", literal: "f" };

impl Language for C {
    fn comment(&self) -> &'static str {
        " *"
    }

    fn epsilon(&self) -> f64 {
        if self.literal.is_empty() { f64::EPSILON } else { f32::EPSILON.into() }
    }

    fn number(&self, value: f64) -> String {
        if self.literal.is_empty() {
            format!("{value:e}")
        } else {
            #[allow(clippy::cast_possible_truncation, reason = "single precision is what is asked for")]
            let single = value as f32;
            format!("{single:e}f")
        }
    }

    fn table_line(&self, number: &str, remark: &str) -> String {
        format!("    {number}, /* {remark} */")
    }

    fn coefficient(&self, k: usize) -> String {
        format!("c[{k}]")
    }

    fn component(&self, j: usize) -> String {
        format!("f[{j}]")
    }

    fn sign(&self, j: usize) -> String {
        format!(
            "(f[{j}] < {zero} ? {minus} : {plus})",
            zero = self.number(0.0),
            minus = self.number(-1.0),
            plus = self.number(1.0)
        )
    }

    fn add_to_error(&self, i: usize, value: &str, remark: &str) -> String {
        format!("    error[{i}] += {value}; /* {remark} */")
    }

    fn add_to_gain(&self, i: usize, j: usize, value: &str) -> String {
        format!("    gain[{i}][{j}] += {value};")
    }
}
