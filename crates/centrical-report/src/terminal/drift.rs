//! How steady the readings were, as text for the terminal.

use std::fmt::Write;

use centrical_session::{CalibrationResult, DriftSummary, LeftOutSummary, MICRO_G, TiltSummary};

use crate::evaluation::drift::{MINUTE, SessionDrift, Tilts, farthest_apart, not_used, plateaus_drift, tilts_scatter};
use crate::number::with_uncertainty;

/// The section of the terminal's table; empty for a session that came already averaged.
pub(super) fn drift(text: &mut String, result: &CalibrationResult) {
    left_out(text, result);
    if let Some(drift) = &result.drift {
        over_plateaus(text, drift);
        over_session(text, drift);
        repeats(text, drift);
    }
    if let Some(tilt) = &result.tilt {
        tilts(text, tilt);
    }
}

/// Samples that are not used, by kind, where there are any.
fn left_out(text: &mut String, result: &CalibrationResult) {
    let LeftOutSummary { spikes, stuck, missing, repeated } = not_used(result);
    let kinds = [("spikes", spikes), ("missing", missing), ("stuck", stuck), ("repeated", repeated)];
    let named: Vec<String> =
        kinds.iter().filter(|(_, count)| *count > 0).map(|(kind, count)| format!("{kind} {count}")).collect();
    if !named.is_empty() {
        let _ = writeln!(text, "      samples not used: {}", named.join(", "));
    }
}

fn over_plateaus(text: &mut String, drift: &DriftSummary) {
    let shown: Vec<String> = (drift.slope.iter().zip(&drift.slope_uncertainty))
        .map(|(slope, u)| with_uncertainty(MINUTE * slope / MICRO_G, MINUTE * u / MICRO_G))
        .map(|(slope, u)| format!("{slope} ± {u}"))
        .collect();
    let verdict = if plateaus_drift(drift) { "plateaus drift" } else { "no drift seen" };
    let _ = writeln!(
        text,
        "DRIFT over a plateau, mean: {} ug/min; chi^2 {:.1} of {} slopes, {verdict}",
        shown.join(", "),
        drift.chi_squared,
        drift.degrees_of_freedom
    );
}

fn over_session(text: &mut String, drift: &DriftSummary) {
    if drift.over_session.is_empty() {
        return;
    }
    let trends = drift.over_session.iter().map(|trend| {
        let (change, u) = with_uncertainty(trend.change / MICRO_G, trend.standard_uncertainty / MICRO_G);
        format!("f{} {change} ± {u}", trend.axis)
    });
    let trends: Vec<String> = trends.collect();
    let verdict = match SessionDrift::of(drift) {
        SessionDrift::NotSeen => "no drift seen",
        SessionDrift::WithinScatter => "no more than the plateaus scatter",
        SessionDrift::Seen => "the session drifts",
    };
    let _ = writeln!(text, "      over the session: {} ug, {verdict}", trends.join(", "));
}

fn repeats(text: &mut String, drift: &DriftSummary) {
    let Some((worst, differ)) = farthest_apart(drift) else { return };
    let count = drift.repeats.len();
    let [first, second] = worst.indices.map(|index| index + 1);
    let verdict = if differ { "they differ" } else { "no difference seen" };
    let _ = writeln!(
        text,
        "      plateaus run again: {count}; farthest apart are {}:{first} and {0}:{second}, chi^2 {:.1} of 3, {verdict}",
        worst.mounting, worst.chi_squared
    );
}

fn tilts(text: &mut String, tilt: &TiltSummary) {
    let shown = |value: f64, u: f64| {
        let (value, u) = with_uncertainty(1e6 * value, 1e6 * u);
        format!("{value} ± {u} urad")
    };
    let verdict = match Tilts::of(tilt) {
        Tilts::Agree => "they agree".to_owned(),
        Tilts::Differ => {
            "they differ: the axis is not the same while it spins, or something else turns with it".to_owned()
        }
        Tilts::Reversed => {
            let as_if = shown(tilt.reversed, tilt.spinning_uncertainty);
            format!("it turns the other way ({as_if}): the sense of rotation is wrong")
        }
    };
    let _ = writeln!(
        text,
        "TILT  by the once-per-revolution term of {} plateaus {}, by rest {}; chi^2 {:.1} of 1, {verdict}",
        tilt.plateaus,
        shown(tilt.spinning, tilt.spinning_uncertainty),
        shown(tilt.at_rest, tilt.at_rest_uncertainty),
        tilt.chi_squared
    );
    if tilts_scatter(tilt) {
        let _ = writeln!(
            text,
            "      the plateaus' own tilts scatter: chi^2 {:.1} of {}",
            tilt.scatter_chi_squared,
            tilt.plateaus.saturating_sub(1)
        );
    }
}
