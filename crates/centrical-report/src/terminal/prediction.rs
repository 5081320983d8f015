//! What will be known, as text for the terminal.

use std::fmt::Write;

use centrical::STANDARD_GRAVITY;
use centrical_session::{MICRO_G, PredictionReport, customary};

use super::rests_on::rests_on_text;
use crate::number::digits;

/// Said of a parameter in which lost combinations leave doubt that no number beside it holds.
pub(super) const LEANING: &str = "  leans on what is lost";

/// What will be known: parameters, and the compensated reading.
pub fn prediction_text(prediction: &PredictionReport) -> String {
    let mut text = String::new();
    let _ = writeln!(
        text,
        "PREDICTION  by {}\n  {:<12}{:<9}{:>10}{:>10}{:>10}",
        prediction.sources.join(", "),
        "",
        "unit",
        "type A",
        "combined",
        "expanded"
    );
    for p in &prediction.parameters {
        let (factor, unit) = customary(&p.unit, p.group);
        let _ = write!(text, "  {:<12}{unit:<9}", p.name);
        let _ = match (p.type_a, p.combined, p.expanded) {
            (Some(a), Some(all), Some(expanded)) => {
                let note = if p.is_affected_by_null_space { LEANING } else { "" };
                let [a, all, expanded] = [a, all, expanded].map(|u| digits(u * factor));
                writeln!(text, "{a:>10}{all:>10}{expanded:>10}{note}")
            }
            _ => writeln!(text, "  not determined"),
        };
    }
    let _ = writeln!(text, "  expanded for {:.2} %", 100.0 * prediction.coverage);
    let ug = |u: f64| digits(u / MICRO_G);
    let range = prediction.range / STANDARD_GRAVITY;
    match prediction.reading {
        Some([a, all]) => {
            let _ = writeln!(
                text,
                "  compensated reading, root mean square over all directions to {range:.0} g: type A {} ug, combined {} ug",
                ug(a),
                ug(all)
            );
        }
        None => text.push_str("  compensated reading: a coefficient is not determined\n"),
    }
    if !prediction.curves.is_empty() {
        let _ = writeln!(text, "  {:>16}{:>14}{:>14}{:>14}", "along, ug, at", "axis 1", "axis 2", "axis 3");
        for [force, u @ ..] in &prediction.curves {
            let [a, b, c] = u.map(ug);
            let _ = writeln!(text, "  {:>14.0} g{a:>14}{b:>14}{c:>14}", force / STANDARD_GRAVITY);
        }
    }
    text.push_str(&rests_on_text(&prediction.rests_on));
    text
}
