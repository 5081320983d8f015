//! What the documents say of drift and tilt.

use centrical_session::{
    CalibrationResult, DisturbedPlateau, DriftSummary, LeftOutSummary, MICRO_G, PlateauDriftVerdict,
    SessionDriftVerdict, TiltSummary, TiltVerdict,
};

use super::content::Block;
use crate::evaluation::{has_rounded_times, interpolated, newtonometer, not_used, unscheduled};
use crate::language::{Language, Messages};
use crate::number::MINUTE;

/// Drift, tilt and samples left out under their heading, with a `note` of what they are; nothing for a session that came already averaged.
/// `lines` is the room that the heading needs.
pub(super) fn drift(
    result: &CalibrationResult,
    note: fn(String) -> Block,
    lines: u8,
    language: Language,
) -> Vec<Block> {
    let messages = language.messages();
    let facts = drift_facts(result, language);
    if facts.is_empty() {
        return Vec::new();
    }
    vec![Block::heading(messages.steadiness, lines), note(steadiness_note(result, messages)), Block::facts(facts)]
}

/// A name and a text each.
pub(crate) fn drift_facts(result: &CalibrationResult, language: Language) -> Vec<(&'static str, String)> {
    let mut facts = Vec::new();
    if let Some(drift) = &result.drift {
        drifts(&mut facts, drift, language);
    }
    if let Some(tilt) = &result.tilt {
        tilts(&mut facts, tilt, language);
    }
    if result.drift.is_some() || result.tilt.is_some() {
        left_out(&mut facts, result, language);
    }
    facts
}

/// What the facts are.
fn steadiness_note(result: &CalibrationResult, messages: &Messages) -> String {
    let tilt = result.tilt.as_ref().map(|_| messages.tilt_note);
    [messages.steadiness_note].into_iter().chain(tilt).collect::<Vec<_>>().join(" ")
}

fn drifts(facts: &mut Vec<(&'static str, String)>, drift: &DriftSummary, language: Language) {
    let messages = language.messages();
    let per_minute = MINUTE / MICRO_G;
    let slopes = drift.slope.iter().zip(&drift.slope_uncertainty).enumerate();
    let slopes = slopes.map(|(i, (slope, u))| axis(i + 1, &language.plus_minus(per_minute * slope, per_minute * u)));
    let over_plateaus = match drift.plateau_verdict() {
        PlateauDriftVerdict::NotSeen => messages.no_drift,
        PlateauDriftVerdict::WithinSpeed => messages.plateaus_drift_with_speed,
        PlateauDriftVerdict::Seen => messages.plateaus_drift,
    };
    let said = [
        with_unit(slopes, "ug/min", language),
        format!("χ² = {}; ν = {}", language.fixed(drift.chi_squared, 1), drift.degrees_of_freedom),
        over_plateaus.to_owned(),
    ];
    facts.push((messages.drift_over_plateau, said.join("; ")));
    if !drift.over_session.is_empty() {
        let changes = drift.over_session.iter().map(|trend| {
            axis(trend.axis, &language.plus_minus(trend.change / MICRO_G, trend.standard_uncertainty / MICRO_G))
        });
        let verdict = match drift.session_verdict() {
            SessionDriftVerdict::NotSeen => messages.no_drift,
            SessionDriftVerdict::Unsure => messages.drift_or_chance,
            SessionDriftVerdict::WithinScatter => messages.within_scatter,
            SessionDriftVerdict::Seen => messages.session_drifts,
        };
        let said = [with_unit(changes, "ug", language), verdict.to_owned()];
        facts.push((messages.drift_over_session, said.join("; ")));
    }
    if let Some((worst, differ)) = drift.farthest_apart() {
        let [first, second] = worst.indices.map(|index| format!("{}:{}", worst.mounting, index + 1));
        let chi_squared = language.fixed(worst.chi_squared, 1);
        let said = [
            drift.repeats.len().to_string(),
            format!("{}: {first}, {second}, χ² = {chi_squared}, ν = 3", messages.farthest_apart),
            if differ { messages.differ } else { messages.no_difference }.to_owned(),
        ];
        facts.push((messages.run_again, said.join("; ")));
    }
}

fn tilts(facts: &mut Vec<(&'static str, String)>, tilt: &TiltSummary, language: Language) {
    let messages = language.messages();
    let shown = |value: f64, u: f64| format!("{} {}", language.plus_minus(1e6 * value, 1e6 * u), language.unit("urad"));
    facts.push((messages.tilt_at_rest, shown(tilt.at_rest, tilt.at_rest_uncertainty)));
    let mut said = vec![
        shown(tilt.spinning, tilt.spinning_uncertainty),
        format!("χ² = {}; ν = 1", language.fixed(tilt.chi_squared, 1)),
        match tilt.verdict() {
            TiltVerdict::Agree => messages.tilts_agree.to_owned(),
            TiltVerdict::Differ => messages.tilts_differ.to_owned(),
            TiltVerdict::Absent => messages.tilt_absent.to_owned(),
            TiltVerdict::Reversed => {
                format!("{} ({})", messages.tilt_reversed, shown(tilt.reversed, tilt.spinning_uncertainty))
            }
        },
    ];
    for DisturbedPlateau { mounting, index, tilt } in &tilt.disturbed {
        let size = format!("{} {}", language.significant(1e6 * tilt, 2), language.unit("urad"));
        said.push(format!("{} {mounting}:{}: {size}", messages.tilt_disturbed, index + 1));
    }
    if tilt.scatters() {
        let (chi_squared, nu) = (language.fixed(tilt.scatter_chi_squared, 1), tilt.plateaus.saturating_sub(1));
        said.push(format!("{}: χ² = {chi_squared}; ν = {nu}", messages.tilts_scatter));
    }
    facts.push((messages.tilt_spinning, said.join("; ")));
}

fn left_out(facts: &mut Vec<(&'static str, String)>, result: &CalibrationResult, language: Language) {
    let messages = language.messages();
    let LeftOutSummary { spikes, stuck, missing, repeated } = not_used(result);
    let kinds = [
        (messages.spikes, spikes),
        (messages.missing, missing),
        (messages.stuck, stuck),
        (messages.repeated, repeated),
    ];
    let named = kinds.iter().filter(|(_, count)| *count > 0).map(|(kind, count)| format!("{kind}: {count}"));
    let rounded = has_rounded_times(result).then(|| messages.rounded_times.to_owned());
    let named = named.chain(rounded).collect::<Vec<_>>().join("; ");
    facts.push((messages.not_used, if named.is_empty() { messages.none.to_owned() } else { named }));
    let named: Vec<String> =
        interpolated(result).into_iter().map(|(number, count)| axis(number, &count.to_string())).collect();
    if !named.is_empty() {
        facts.push((messages.interpolated, named.join("; ")));
    }
    if let Some(named) = unscheduled(result.mountings.iter().map(|m| m.unscheduled.as_slice()), language) {
        facts.push((messages.unscheduled, named));
    }
}

/// What is said of a newtonometer.
fn axis(axis: usize, said: &str) -> String {
    format!("{} {said}", newtonometer(axis))
}

fn with_unit(said: impl Iterator<Item = String>, unit: &str, language: Language) -> String {
    format!("{} {}", said.collect::<Vec<_>>().join(", "), language.unit(unit))
}
