//! The names of parameters in words, once below a table.

use centrical::Group;

use super::screen::Screen;
use crate::evaluation::ParameterName;
use crate::language::Language;

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
