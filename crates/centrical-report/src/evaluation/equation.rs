//! The error model, and combinations of parameters, written out.

use std::fmt::Write;

use centrical_compensate::Monomial;
use centrical_session::{CalibrationResult, TermSummary};

use super::symbol::{newtonometer, symbol, typeset};

/// A combination as results have it: parameter to component.
type Direction = serde_json::Map<String, serde_json::Value>;

/// The equations of the three newtonometers, separated by semicolons, in the names of the result.
pub(crate) fn equation(result: &CalibrationResult) -> String {
    equations_in(result, |axis| format!("f{axis}"), ToOwned::to_owned, |monomial| monomial).join("; ")
}

/// One equation for each newtonometer, as print has it.
pub(crate) fn equations(result: &CalibrationResult) -> [String; 3] {
    equations_in(result, newtonometer, symbol, |monomial| typeset(&monomial))
}

/// `f1' = f1 + df_1 + G0_11 f1 + ...`, its newtonometers, names and monomials written by the three functions.
fn equations_in(
    result: &CalibrationResult,
    newtonometer: impl Fn(usize) -> String,
    name: impl Fn(&str) -> String,
    product: impl Fn(String) -> String,
) -> [String; 3] {
    [1, 2, 3].map(|axis| {
        let f = newtonometer(axis);
        let mut text = format!("{f}\u{2032} = {f}");
        for term in result.model.error_model.iter().filter(|term| term.axis == axis) {
            let (name, monomial) = (name(&term.name), monomial(term));
            let _ = if term.monomial().is_ok_and(|monomial| monomial == Monomial::ONE) {
                write!(text, " + {name}")
            } else {
                write!(text, " + {name}·{}", product(monomial))
            };
        }
        text
    })
}

/// `f1^2*f3`, `f2*|f2|` or `1`, as sessions write it; a question mark if it takes the sign of an axis that does not exist.
pub(crate) fn monomial(term: &TermSummary) -> String {
    term.monomial().map_or_else(|_| "?".to_owned(), |monomial| monomial.to_string())
}

/// `dR_2[A] + dR_1[B] - drho_22`, in the names of the result.
pub(crate) fn combination(direction: &Direction) -> String {
    combination_in(direction, "-", ToOwned::to_owned)
}

/// The same as print has it.
pub(crate) fn printed_combination(direction: &Direction) -> String {
    combination_in(direction, "\u{2212}", symbol)
}

fn combination_in(direction: &Direction, minus: &str, name: impl Fn(&str) -> String) -> String {
    let mut text = String::new();
    for (parameter, component) in direction {
        let component = component.as_f64().unwrap_or(0.0);
        let is_negative = component < 0.0;
        if !text.is_empty() {
            let _ = write!(text, " {} ", if is_negative { minus } else { "+" });
        } else if is_negative {
            text.push_str(minus);
        }
        let size = component.abs();
        if size != 1.0 {
            let _ = if size.fract() == 0.0 { write!(text, "{size} ") } else { write!(text, "{size:.4e} ") };
        }
        text.push_str(&name(parameter));
    }
    text
}
