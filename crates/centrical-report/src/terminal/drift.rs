//! How steady the readings were, and what records have beside the samples that are used, as text for the terminal.

use std::path::Path;

use centrical_session::{
    CalibrationResult, CreepSummary, DisturbedPlateau, DriftSummary, MICRO_G, Reduced, SessionDriftVerdict, TiltSummary,
};

use super::screen::Screen;
use crate::document::{
    has_rounded_times, interpolated, not_used, plateaus_drift, session_drifts, tilts_agree, unscheduled,
};
use crate::language::Language;
use crate::number::{MINUTE, counted, with_uncertainty};

/// The section of the terminal's table; empty for a session that came already averaged.
pub(super) fn drift(screen: &mut Screen, result: &CalibrationResult) {
    left_out(screen, result);
    if let Some(drift) = &result.drift {
        over_plateaus(screen, drift);
        creep(screen, drift);
        over_session(screen, drift);
        repeats(screen, drift);
    }
    if let Some(tilt) = &result.tilt {
        tilts(screen, tilt);
    }
}

/// Samples that are not used, by kind, and interpolated readings, if any.
fn left_out(screen: &mut Screen, result: &CalibrationResult) {
    let named = not_used(result, Language::English);
    let named: Vec<String> = named.iter().map(|(kind, count)| format!("{kind} {count}")).collect();
    if !named.is_empty() {
        screen.fact("", &format!("samples not used: {}", named.join(", ")));
    }
    if has_rounded_times(result) {
        screen
            .fact("", "more samples share a time than are used: the times are rounded; time = { rate = ... } uses all");
    }
    let interpolated = result.mountings.iter().map(|mounting| mounting.interpolated);
    for line in not_as_recorded(interpolated, result.mountings.iter().map(|m| m.unscheduled.as_slice())) {
        screen.fact("", &line);
    }
}

/// Interpolated readings, and plateaus that the schedule does not have, by mounting: a sentence each, if any.
fn not_as_recorded<'m>(
    counts: impl IntoIterator<Item = Option<[u64; 3]>>,
    windows: impl IntoIterator<Item = &'m [[f64; 2]]>,
) -> impl Iterator<Item = String> {
    let named: Vec<String> = interpolated(counts).iter().map(|(axis, count)| format!("f{axis} {count}")).collect();
    let interpolated =
        (!named.is_empty()).then(|| format!("readings interpolated to common stamps: {}", named.join(", ")));
    let unscheduled = unscheduled(windows, Language::English)
        .map(|named| format!("plateaus that the schedule does not have, not used: {named}"));
    interpolated.into_iter().chain(unscheduled)
}

/// A session that was reduced into the folder `out`.
pub fn reduction_text(reduced: &Reduced, out: &Path) -> Screen {
    let samples: u64 = reduced.plateaus.iter().map(|plateau| plateau.samples).sum();
    let [plateaus, samples] = [counted(reduced.plateaus.len(), "plateau"), counted(samples, "sample")];
    let mut screen = Screen::default();
    screen.say(0, &format!("{plateaus} of {samples} written to {}", out.display()));
    let windows = reduced.mountings.iter().map(|mounting| mounting.unscheduled.as_slice());
    for line in not_as_recorded(reduced.mountings.iter().map(|mounting| mounting.interpolated), windows) {
        screen.say(0, &line);
    }
    screen
}

fn over_plateaus(screen: &mut Screen, drift: &DriftSummary) {
    let shown: Vec<String> = (drift.slope.iter().zip(&drift.slope_uncertainty))
        .map(|(slope, u)| with_uncertainty(MINUTE * slope / MICRO_G, MINUTE * u / MICRO_G))
        .map(|(slope, u)| format!("{slope} ± {u}"))
        .collect();
    let verdict = plateaus_drift(drift, Language::English);
    let text = format!(
        "over a plateau, mean: {} ug/min; chi^2 {:.1} of {} slopes, {verdict}",
        shown.join(", "),
        drift.chi_squared,
        drift.degrees_of_freedom
    );
    screen.fact("DRIFT", &text);
}

/// Where slopes of rests follow the change of the reading before.
fn creep(screen: &mut Screen, drift: &DriftSummary) {
    let Some(creep) = drift.creep.filter(CreepSummary::is_real) else { return };
    let (rate, u) = with_uncertainty(1e6 * creep.rate, 1e6 * creep.standard_uncertainty);
    let text = format!(
        "creep after each turn: {rate} ± {u} ppm of the change a second, chance {}",
        Language::English.probability(creep.probability)
    );
    screen.fact("", &text);
}

fn over_session(screen: &mut Screen, drift: &DriftSummary) {
    if drift.over_session.is_empty() {
        return;
    }
    let trends = drift.over_session.iter().map(|trend| {
        let (change, u) = with_uncertainty(trend.change / MICRO_G, trend.standard_uncertainty / MICRO_G);
        format!("f{} {change} ± {u}", trend.axis)
    });
    let trends: Vec<String> = trends.collect();
    let verdict = session_drifts(drift, Language::English);
    let is_unsure = drift.session_verdict() == SessionDriftVerdict::Unsure;
    let advice = if is_unsure { "; bias_drift under [uncertainty] allows for one" } else { "" };
    screen.fact("", &format!("over the session: {} ug, {verdict}{advice}", trends.join(", ")));
}

fn repeats(screen: &mut Screen, drift: &DriftSummary) {
    let Some((worst, differ)) = drift.farthest_apart() else { return };
    let count = drift.repeats.len();
    let [first, second] = worst.indices.map(|index| index + 1);
    let messages = Language::English.messages();
    let verdict = if differ { messages.differ } else { messages.no_difference };
    let text = format!(
        "plateaus run again: {count}; farthest apart are {}:{first} and {0}:{second}, chi^2 {:.1} of 3, {verdict}",
        worst.mounting, worst.chi_squared
    );
    screen.fact("", &text);
}

fn tilts(screen: &mut Screen, tilt: &TiltSummary) {
    let shown = |value: f64, u: f64| {
        let (value, u) = with_uncertainty(1e6 * value, 1e6 * u);
        format!("{value} ± {u} urad")
    };
    let verdict = tilts_agree(tilt, shown, Language::English);
    let text = format!(
        "by the once-per-revolution term of {} {}, by rest {}; chi^2 {:.1} of 1, {verdict}",
        counted(tilt.plateaus, "plateau"),
        shown(tilt.spinning, tilt.spinning_uncertainty),
        shown(tilt.at_rest, tilt.at_rest_uncertainty),
        tilt.chi_squared
    );
    screen.fact("TILT", &text);
    for DisturbedPlateau { mounting, index, tilt } in &tilt.disturbed {
        let (place, size) = (format!("{mounting}:{}", index + 1), 1e6 * tilt);
        let words = "something else turns with the arm there, such as a vibration of the machine";
        screen.fact("", &format!("left out: {place}, {size:.0} urad; {words}"));
    }
    if tilt.scatters() {
        let text = format!(
            "the plateaus' own tilts scatter: chi^2 {:.1} of {}",
            tilt.scatter_chi_squared,
            tilt.plateaus.saturating_sub(1)
        );
        screen.fact("", &text);
    }
}
