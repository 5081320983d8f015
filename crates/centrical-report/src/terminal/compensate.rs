//! A compensated record as text for the terminal.

use std::path::Path;

use centrical::STANDARD_GRAVITY;
use centrical_compensate::Certificate;
use centrical_session::CompensatedRecord;

use super::screen::{Emphasis, Screen};
use crate::number::{counted, rounded_down};

/// What became of a record, where the inverse is unique, and where the specific forces are.
pub fn compensation_text(compensated: &CompensatedRecord, certificate: &Certificate, out: &Path) -> Screen {
    let g = |f: f64| format!("{:.6} g", f / STANDARD_GRAVITY);
    let Certificate { range, margin, .. } = *certificate;
    let farthest = if margin.is_finite() {
        format!("up to {} g", rounded_down(margin * range / STANDARD_GRAVITY, 3))
    } else {
        "anywhere".to_owned()
    };
    let mut screen = Screen::default();
    if let Some(first) = &compensated.outside.first {
        let words = format!(
            "{} beyond the range, written as nan, the first at t = {} s: {}",
            counted(compensated.outside.count, "reading"),
            first.t,
            first.reading.map(g).join(", ")
        );
        screen.marked(Emphasis::NotAcceptable, "NOT ACCEPTABLE", &words);
    }
    if let Some(first) = &compensated.beyond.first {
        let words = format!(
            "{} beyond those of the calibration, where its error model is extrapolated, the first at t = {} s: {}",
            counted(compensated.beyond.count, "reading"),
            first.t,
            first.reading.map(g).join(", ")
        );
        screen.marked(Emphasis::Warning, "WARNING", &words);
    }
    let words = format!(
        "{} in {} compensated, range {} g on each axis; the inverse is unique there, and could be asked for {farthest}",
        counted(compensated.readings - compensated.outside.count, "reading"),
        compensated.unit,
        rounded_down(range / STANDARD_GRAVITY, 5)
    );
    screen.say(0, &words);
    let out = out.display();
    screen.say(
        0,
        &match compensated.decimals {
            Some(count) => format!("Written to {out}, specific forces to {} of a m/s^2", counted(count, "decimal")),
            None => format!("Written to {out}"),
        },
    );
    screen
}
