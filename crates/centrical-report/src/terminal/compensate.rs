//! A compensated record as text for the terminal.

use std::path::Path;

use centrical::STANDARD_GRAVITY;
use centrical_compensate::Certificate;
use centrical_session::Compensated;

/// What became of a record, where the inverse is unique, and where the specific forces are.
pub fn compensation_text(compensated: &Compensated, certificate: &Certificate, out: &Path) -> String {
    let g = |f: f64| format!("{:.6} g", f / STANDARD_GRAVITY);
    let Certificate { range, margin, .. } = *certificate;
    let farthest = if margin.is_finite() {
        format!("up to {:.0} g", margin * range / STANDARD_GRAVITY)
    } else {
        "anywhere".to_owned()
    };
    let mut lines = vec![format!(
        "{} readings compensated, range {} on each axis; the inverse is unique there, and could be asked for {farthest}\n",
        compensated.readings,
        g(range)
    )];
    if let Some(first) = &compensated.first_outside {
        lines.push(format!(
            "NOT ACCEPTABLE  {} readings come from beyond the range and are nan, the first at t = {} s: {}\n",
            compensated.outside,
            first.t,
            first.reading.map(g).join(", ")
        ));
    }
    if let Some(first) = &compensated.first_beyond {
        lines.push(format!(
            "WARNING  {} readings lie beyond those of the calibration, where its error model is extrapolated, the first at \
             t = {} s: {}\n",
            compensated.beyond,
            first.t,
            first.reading.map(g).join(", ")
        ));
    }
    let out = out.display();
    lines.push(match compensated.decimals {
        Some(count) => format!("Written to {out}, specific forces to {count} decimals of a m/s^2\n"),
        None => format!("Written to {out}\n"),
    });
    lines.concat()
}
