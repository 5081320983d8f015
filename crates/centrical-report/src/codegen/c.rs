//! C99: one header, one source, in double and single precision.

use super::model::{Model, outside_range, vector_rows};
use super::statement::Language;

/// The header.
pub(super) fn header(model: &Model) -> String {
    model.fill(include_str!("compensate.h.in"), &DOUBLE)
}

/// The source: the same text once for each precision, then the test vectors.
pub(super) fn source(model: &Model) -> String {
    let body = |c: &C| {
        let text = model.fill(include_str!("compensate_body.c.in"), c);
        text.replace("@real@", c.real).replace("@name@", c.name).replace("@literal@", c.literal)
    };
    let row = |reading: &str, f: &str| format!("    {{{{{reading}}}, {{{f}}}}},");
    model
        .fill(include_str!("compensate.c.in"), &DOUBLE)
        .replace("@double@", &body(&DOUBLE))
        .replace("@single@", &body(&SINGLE))
        .replace("@vectors@", &vector_rows(model, &DOUBLE, row))
        .replace("@outside@", &outside_range(model, &DOUBLE))
}

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
