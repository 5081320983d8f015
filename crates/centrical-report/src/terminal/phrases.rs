//! Phrases that several commands say: probabilities, short lists, parameters, patterns and rivals in words.

use centrical::{Extension, Group, Rival};
use centrical_session::{Follows, MICRO_G, PatternSummary};

use super::screen::Screen;
use crate::evaluation::ParameterName;
use crate::language::Language;
use crate::number::{two_digits, with_uncertainty};

/// A probability to three places, a small one as [`chance`] has it.
pub fn chance_to_three_places(probability: f64) -> String {
    if probability < 1e-3 { chance(probability) } else { format!("{probability:.3}") }
}

/// A probability as a person reads it; a small one may be too small for a number.
pub fn chance(probability: f64) -> String {
    match probability {
        0.01.. => format!("{probability:.2}"),
        1e-300.. => format!("{probability:.1e}"),
        _ => "below 1e-300".to_owned(),
    }
}

/// The first `most` of `names`, and the number of the others.
pub fn short_list(names: &[String], most: usize, between: &str) -> String {
    let first = names.iter().take(most).map(String::as_str).collect::<Vec<_>>().join(between);
    if names.len() > most { format!("{first} and {} more", names.len() - most) } else { first }
}

/// `theta of 26 rests`: the attitude of each rest is two angles.
pub(super) fn rests_name(angles: usize) -> String {
    format!("theta of {} rests", angles / 2)
}

/// `1.7 to 2.3`; `lost` if one of them is lost.
pub(super) fn extent(uncertainties: impl Iterator<Item = Option<f64>>) -> String {
    let extremes = uncertainties.map(|u| u.map(|u| (u, u)));
    match extremes.reduce(|a, b| a.zip(b).map(|((low, high), (u, _))| (low.min(u), high.max(u)))).flatten() {
        Some((low, high)) => format!("{} to {}", two_digits(low), two_digits(high)),
        None => "lost".to_owned(),
    }
}

/// What the names in a table mean, each stem once: `alpha: tilt of the rotation axis`.
pub(super) fn legend<'p>(screen: &mut Screen, parameters: impl Iterator<Item = (&'p str, Group)>) {
    legend_in(screen, parameters, Language::English);
}

/// The same in a language.
pub(super) fn legend_in<'p>(
    screen: &mut Screen,
    parameters: impl Iterator<Item = (&'p str, Group)>,
    language: Language,
) {
    let (messages, of) = (language.messages(), language.comparison());
    let mut stems: Vec<(&str, Vec<Group>)> = Vec::new();
    let (mut has_position, mut has_pair) = (false, false);
    for (name, group) in parameters {
        let ParameterName { stem, place, .. } = ParameterName::of(name);
        has_position |= group == Group::Turn && !place.is_empty();
        has_pair |= group == Group::Shift && !place.is_empty();
        match stems.iter_mut().find(|(known, _)| *known == stem) {
            Some((_, groups)) if groups.contains(&group) => {}
            Some((_, groups)) => groups.push(group),
            None => stems.push((stem, vec![group])),
        }
    }
    let word = |group: &Group| (messages.words.group)(*group).to_lowercase();
    let meaning = |(stem, groups): &(&str, Vec<Group>)| {
        format!("{stem}: {}", groups.iter().map(word).collect::<Vec<_>>().join(of.or))
    };
    let mut words: Vec<String> = stems.iter().map(meaning).collect();
    words.extend(has_position.then(|| of.position.to_owned()));
    words.extend(has_pair.then(|| of.pair.to_owned()));
    if !words.is_empty() {
        screen.sentence(2, 2, &format!("{}.", words.join("; ")));
    }
}

/// "residuals of newtonometer 2 grow with the square of the speed in position 3 ...: an elastic turn or a loose seat".
pub(super) fn pattern_in_words(pattern: &PatternSummary) -> String {
    let (what, cause) = match &pattern.follows {
        Follows::Position { position } => {
            (format!("have a step in position {position}"), "a seat that moved or a thermal shift")
        }
        Follows::SpeedInPosition { position } => {
            (format!("grow with the square of the speed in position {position}"), "an elastic turn or a loose seat")
        }
        Follows::SpeedOnSeat { radius } => (
            format!("grow with the square of the speed at radius {radius} m"),
            "a wrong radius or a stretch of the arm",
        ),
        Follows::Speed => ("grow with the square of the speed".to_owned(), "a wrong speed or a missing term"),
        Follows::Load => ("grow with the load".to_owned(), "a missing term of the error model or an elastic arm"),
        Follows::Mounting { mounting } => {
            (format!("have a step in mounting {mounting}"), "a drift of the bias or a loose mounting")
        }
        Follows::Time => ("drift over the session".to_owned(), "a drift of the bias"),
    };
    let (amplitude, uncertainty) =
        with_uncertainty(pattern.amplitude / MICRO_G, pattern.standard_uncertainty / MICRO_G);
    format!(
        "residuals of newtonometer {} {what} ({amplitude} ± {uncertainty} ug, probability {:.1e}): {cause}",
        pattern.axis, pattern.probability
    )
}

/// What to change under `[model]` in `experiment.toml` to put rivals into the model: `add "jump" to error_model`.
pub(super) fn changes_for(rivals: &[Rival]) -> String {
    let mut terms: Vec<String> = Vec::new();
    let mut extensions: Vec<String> = Vec::new();
    let mut changes = Vec::new();
    for rival in rivals {
        match rival {
            Rival::Terms(extra) => terms.push(extra.name().to_owned()),
            Rival::Effect(Extension::PositionShift) => changes.push("set pair_relation = \"free\"".to_owned()),
            Rival::Effect(extension) => extensions.push(extension.name()),
        }
    }
    for (key, names) in [("error_model", terms), ("extensions", extensions)] {
        if !names.is_empty() {
            let names: Vec<String> = names.iter().map(|name| format!("{name:?}")).collect();
            changes.push(format!("add {} to {key}", names.join(", ")));
        }
    }
    changes.join("; ")
}
