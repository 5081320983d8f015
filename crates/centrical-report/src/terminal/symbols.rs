//! The names of parameters in words, once below a table.

use centrical::Group;

use super::screen::Screen;
use crate::language::Language;

/// The parts of a parameter's name: `delta`, `2` and `[4]` of `delta_2[4]`; all of `radius_scale` is its stem.
pub(super) struct Symbol<'n> {
    pub stem: &'n str,
    /// Digits behind the stem.
    pub index: &'n str,
    /// The position or pair of positions in brackets.
    pub place: &'n str,
}

impl<'n> Symbol<'n> {
    /// Takes a name apart.
    pub fn of(name: &'n str) -> Self {
        let (name, place) = name.split_at(name.find('[').unwrap_or(name.len()));
        let is_index = |index: &str| !index.is_empty() && index.bytes().all(|b| b.is_ascii_digit());
        let (stem, index) = name.rsplit_once('_').filter(|(_, index)| is_index(index)).unwrap_or((name, ""));
        Self { stem, index, place }
    }
}

/// What the names in a table mean, each stem once: `alpha: tilt of the rotation axis`.
pub(super) fn legend<'p>(screen: &mut Screen, parameters: impl Iterator<Item = (&'p str, Group)>) {
    let mut stems: Vec<(&str, Vec<Group>)> = Vec::new();
    let (mut has_position, mut has_pair) = (false, false);
    for (name, group) in parameters {
        let Symbol { stem, place, .. } = Symbol::of(name);
        has_position |= group == Group::Turn && !place.is_empty();
        has_pair |= group == Group::Shift && !place.is_empty();
        match stems.iter_mut().find(|(known, _)| *known == stem) {
            Some((_, groups)) if groups.contains(&group) => {}
            Some((_, groups)) => groups.push(group),
            None => stems.push((stem, vec![group])),
        }
    }
    let word = |group: &Group| (Language::English.messages().words.group)(*group).to_lowercase();
    let meaning = |(stem, groups): &(&str, Vec<Group>)| {
        format!("{stem}: {}", groups.iter().map(word).collect::<Vec<_>>().join(" or "))
    };
    let mut words: Vec<String> = stems.iter().map(meaning).collect();
    words.extend(has_position.then(|| "delta[n]: of position n".to_owned()));
    words.extend(has_pair.then(|| "dR[A]: of the pair A of positions".to_owned()));
    if !words.is_empty() {
        screen.sentence(2, 2, &format!("{}.", words.join("; ")));
    }
}
