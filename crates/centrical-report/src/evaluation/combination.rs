//! A combination of parameters written out.

use std::fmt::Write;

use super::symbol::symbol;

/// A combination as results have it: parameter to component.
type Direction = serde_json::Map<String, serde_json::Value>;

/// `dR_2[A] + dR_1[B] - drho_22`, in the names of the result.
pub(crate) fn combination(direction: &Direction) -> String {
    written(direction, "-", ToOwned::to_owned)
}

/// The same as print has it.
pub(crate) fn printed_combination(direction: &Direction) -> String {
    written(direction, "\u{2212}", symbol)
}

fn written(direction: &Direction, minus: &str, name: impl Fn(&str) -> String) -> String {
    let mut text = String::new();
    for (parameter, component) in direction {
        let component = component.as_f64().unwrap_or(0.0);
        let sign = if component < 0.0 { minus } else { "+" };
        match (text.is_empty(), component < 0.0) {
            (true, false) => {}
            (true, true) => text.push_str(minus),
            (false, _) => {
                let _ = write!(text, " {sign} ");
            }
        }
        let size = component.abs();
        if size != 1.0 {
            let _ = if size.fract() == 0.0 { write!(text, "{size} ") } else { write!(text, "{size:.4e} ") };
        }
        text.push_str(&name(parameter));
    }
    text
}
