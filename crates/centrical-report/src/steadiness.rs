//! How steady the readings were, in words: drift, tilt while spinning, samples left out.

use std::fmt::Write;

use centrical::STANDARD_GRAVITY;
use centrical_io::{CalibrationResult, DriftSummary, TiltSummary};

use crate::customary::with_uncertainty;

/// What comes by chance less often than this is said to be there.
const CHANCE: f64 = 1e-3;

/// ug per m/s^2.
const MICRO_G: f64 = 1e6 / STANDARD_GRAVITY;

/// The section of the terminal's table; empty for a session that came already averaged.
pub(crate) fn steadiness(text: &mut String, result: &CalibrationResult) {
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
    let kinds: [(&str, usize); 4] = result.plateaus.iter().filter_map(|plateau| plateau.left_out).fold(
        [("spikes", 0), ("missing", 0), ("stuck", 0), ("repeated", 0)],
        |[spikes, missing, stuck, repeated], of| {
            [
                (spikes.0, spikes.1 + of.spikes),
                (missing.0, missing.1 + of.missing),
                (stuck.0, stuck.1 + of.stuck),
                (repeated.0, repeated.1 + of.repeated),
            ]
        },
    );
    let named: Vec<String> =
        kinds.iter().filter(|(_, count)| *count > 0).map(|(kind, count)| format!("{kind} {count}")).collect();
    if !named.is_empty() {
        let _ = writeln!(text, "      samples not used: {}", named.join(", "));
    }
}

fn over_plateaus(text: &mut String, drift: &DriftSummary) {
    const MINUTE: f64 = 60.0;
    let shown: Vec<String> = (drift.slope.iter().zip(&drift.slope_uncertainty))
        .map(|(slope, u)| with_uncertainty(MICRO_G * MINUTE * slope, MICRO_G * MINUTE * u))
        .map(|(slope, u)| format!("{slope} ± {u}"))
        .collect();
    let verdict = if drift.probability < CHANCE { "plateaus drift" } else { "no drift seen" };
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
        let (change, u) = with_uncertainty(MICRO_G * trend.change, MICRO_G * trend.standard_uncertainty);
        format!("f{} {change} ± {u}", trend.axis)
    });
    let trends: Vec<String> = trends.collect();
    // Family-wise over the newtonometers, by Bonferroni.
    let tests = drift.over_session.len() as f64;
    let is_seen = drift.over_session.iter().any(|trend| tests * trend.probability < CHANCE);
    let verdict = if is_seen { "the session drifts" } else { "no drift seen" };
    let _ = writeln!(text, "      over the session: {} ug, {verdict}", trends.join(", "));
}

fn repeats(text: &mut String, drift: &DriftSummary) {
    let Some(worst) = drift.repeats.iter().min_by(|a, b| a.probability.total_cmp(&b.probability)) else { return };
    let count = drift.repeats.len();
    let [first, second] = worst.indices.map(|index| index + 1);
    let differ = count as f64 * worst.probability < CHANCE;
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
    let turned = tilt.reversed > tilt.spinning && tilt.probability < CHANCE;
    let verdict = if turned {
        let as_if = shown(tilt.reversed, tilt.spinning_uncertainty);
        format!("it turns the other way ({as_if}): the sense of rotation is wrong")
    } else if tilt.probability < CHANCE {
        "they differ: the axis is not the same while it spins, or something else turns with it".to_owned()
    } else {
        "they agree".to_owned()
    };
    let _ = writeln!(
        text,
        "TILT  by the once-per-revolution term of {} plateaus {}, by rest {}; chi^2 {:.1} of 1, {verdict}",
        tilt.plateaus,
        shown(tilt.spinning, tilt.spinning_uncertainty),
        shown(tilt.at_rest, tilt.at_rest_uncertainty),
        tilt.chi_squared
    );
    if tilt.scatter_probability < CHANCE {
        let _ = writeln!(
            text,
            "      the plateaus' own tilts scatter: chi^2 {:.1} of {}",
            tilt.scatter_chi_squared,
            tilt.plateaus.saturating_sub(1)
        );
    }
}
