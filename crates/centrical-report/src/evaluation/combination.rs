//! A combination of parameters written out.

use std::fmt::Write;

/// `dR_2[A] + dR_1[B] - drho_22`.
pub(crate) fn combination(direction: &serde_json::Map<String, serde_json::Value>) -> String {
    let mut text = String::new();
    for (name, component) in direction {
        let component = component.as_f64().unwrap_or(0.0);
        let sign = if component < 0.0 { "-" } else { "+" };
        match (text.is_empty(), sign) {
            (true, "+") => {}
            (true, _) => text.push('-'),
            (false, _) => {
                let _ = write!(text, " {sign} ");
            }
        }
        let size = component.abs();
        if size != 1.0 {
            let _ = if size.fract() == 0.0 { write!(text, "{size} ") } else { write!(text, "{size:.4e} ") };
        }
        text.push_str(name);
    }
    text
}
