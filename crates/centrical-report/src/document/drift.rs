//! What is said of drift and tilt, and of what records have beside the samples that are used.

use centrical_session::{
    CalibrationResult, DisturbedPlateau, DriftSummary, LeftOutSummary, MICRO_G, PlateauDriftVerdict,
    SessionDriftVerdict, TiltSummary, TiltVerdict,
};

use super::content::Block;
use crate::evaluation::newtonometer;
use crate::language::{Language, Messages};
use crate::number::MINUTE;

/// Plateaus that are named at most.
const NAMED: usize = 4;

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

/// What slopes within plateaus show.
pub(crate) fn plateaus_drift(drift: &DriftSummary, language: Language) -> &'static str {
    let messages = language.messages();
    match drift.plateau_verdict() {
        PlateauDriftVerdict::NotSeen => messages.no_drift,
        PlateauDriftVerdict::WithinSpeed => messages.plateaus_drift_with_speed,
        PlateauDriftVerdict::Seen => messages.plateaus_drift,
    }
}

/// What trends over the session show.
pub(crate) fn session_drifts(drift: &DriftSummary, language: Language) -> &'static str {
    let messages = language.messages();
    match drift.session_verdict() {
        SessionDriftVerdict::NotSeen => messages.no_drift,
        SessionDriftVerdict::Unsure => messages.drift_or_chance,
        SessionDriftVerdict::WithinScatter => messages.within_scatter,
        SessionDriftVerdict::Seen => messages.session_drifts,
    }
}

/// Whether the tilts agree; of a reversed one its size, as it is `shown`.
pub(crate) fn tilts_agree(tilt: &TiltSummary, shown: impl Fn(f64, f64) -> String, language: Language) -> String {
    let messages = language.messages();
    match tilt.verdict() {
        TiltVerdict::Agree => messages.tilts_agree.to_owned(),
        TiltVerdict::Differ => messages.tilts_differ.to_owned(),
        TiltVerdict::Absent => messages.tilt_absent.to_owned(),
        TiltVerdict::Reversed => {
            format!("{} ({})", messages.tilt_reversed, shown(tilt.reversed, tilt.spinning_uncertainty))
        }
    }
}

/// Samples of all plateaus that are not used, by kind; kinds without any are left out.
pub(crate) fn not_used(result: &CalibrationResult, language: Language) -> Vec<(&'static str, usize)> {
    let messages = language.messages();
    let sum = |of: fn(&LeftOutSummary) -> usize| all_left_out(result).map(of).sum();
    let kinds = [
        (messages.spikes, sum(|of| of.spikes)),
        (messages.missing, sum(|of| of.missing)),
        (messages.stuck, sum(|of| of.stuck)),
        (messages.repeated, sum(|of| of.repeated)),
    ];
    kinds.into_iter().filter(|(_, count)| *count > 0).collect()
}

/// Whether more samples were left out for a time that the one before had than were used: the times are rounded.
pub(crate) fn has_rounded_times(result: &CalibrationResult) -> bool {
    let repeated: usize = all_left_out(result).map(|of| of.repeated).sum();
    repeated as u64 > result.plateaus.iter().map(|plateau| plateau.samples).sum()
}

fn all_left_out(result: &CalibrationResult) -> impl Iterator<Item = &LeftOutSummary> {
    result.plateaus.iter().filter_map(|plateau| plateau.left_out.as_ref())
}

/// Readings of newtonometers 1, 2, 3 that were interpolated, of all mountings together, those without any left out: axis from 1 and count.
pub(crate) fn interpolated(mountings: impl IntoIterator<Item = Option<[u64; 3]>>) -> Vec<(usize, u64)> {
    let sum = mountings.into_iter().flatten().fold([0; 3], |sum, of| [0, 1, 2].map(|axis| sum[axis] + of[axis]));
    (1..).zip(sum).filter(|(_, count)| *count > 0).collect()
}

/// The plateaus of each mounting that its schedule does not have, with the times [s] of their begin and end; `None` without any.
pub(crate) fn unscheduled<'a>(
    mountings: impl IntoIterator<Item = &'a [[f64; 2]]>,
    language: Language,
) -> Option<String> {
    let of_mounting = |(number, windows): (usize, &'a [[f64; 2]])| windows.iter().map(move |window| (number, *window));
    let all: Vec<(usize, [f64; 2])> = (1..).zip(mountings).flat_map(of_mounting).collect();
    let named = all.iter().take(NAMED).map(|(number, [from, to])| {
        let messages = language.messages();
        let [from, to] = [from, to].map(|t| language.fixed(*t, 1));
        format!("{} {number}, {from} – {to} {}", messages.in_mounting, language.unit("s"))
    });
    let more = if all.len() > NAMED { format!("; … ({})", all.len()) } else { String::new() };
    (!all.is_empty()).then(|| named.collect::<Vec<_>>().join("; ") + &more)
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
    let said = [
        with_unit(slopes, "ug/min", language),
        format!("χ² = {}; ν = {}", language.fixed(drift.chi_squared, 1), drift.degrees_of_freedom),
        plateaus_drift(drift, language).to_owned(),
    ];
    facts.push((messages.drift_over_plateau, said.join("; ")));
    if !drift.over_session.is_empty() {
        let changes = drift.over_session.iter().map(|trend| {
            axis(trend.axis, &language.plus_minus(trend.change / MICRO_G, trend.standard_uncertainty / MICRO_G))
        });
        let said = [with_unit(changes, "ug", language), session_drifts(drift, language).to_owned()];
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
        tilts_agree(tilt, shown, language),
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
    let named = not_used(result, language).into_iter().map(|(kind, count)| format!("{kind}: {count}"));
    let rounded = has_rounded_times(result).then(|| messages.rounded_times.to_owned());
    let named = named.chain(rounded).collect::<Vec<_>>().join("; ");
    facts.push((messages.not_used, if named.is_empty() { messages.none.to_owned() } else { named }));
    let counts = interpolated(result.mountings.iter().map(|mounting| mounting.interpolated));
    let named: Vec<String> = counts.into_iter().map(|(number, count)| axis(number, &count.to_string())).collect();
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
