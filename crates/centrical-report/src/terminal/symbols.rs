//! The names of parameters in words, once below a table.

use centrical::Group;

use super::screen::Screen;
use crate::language::Language;

/// What the names in a table mean, each stem once: `alpha: tilt of the rotation axis`.
pub(super) fn legend<'p>(screen: &mut Screen, parameters: impl Iterator<Item = (&'p str, Group)>) {
    let mut stems: Vec<(&str, Vec<Group>)> = Vec::new();
    let (mut has_position, mut has_pair) = (false, false);
    for (name, group) in parameters {
        let place = name.find('[').map_or("", |start| &name[start + 1..]);
        has_position |= name.starts_with("delta") && !place.is_empty();
        has_pair |= name.starts_with("dR") && !place.is_empty();
        let stem = stem(name);
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

/// `delta` of `delta_2[4]`, `radius_scale` of itself.
fn stem(name: &str) -> &str {
    let name = &name[..name.find('[').unwrap_or(name.len())];
    match name.rsplit_once('_') {
        Some((stem, index)) if index.bytes().all(|b| b.is_ascii_digit()) => stem,
        _ => name,
    }
}
