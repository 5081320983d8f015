//! Plateaus that records show and the schedule does not have.

use crate::language::Language;

/// Plateaus that are named at most.
const NAMED: usize = 4;

/// The plateaus of each mounting that its schedule does not have, with the times [s] of their begin and end; `None` without any.
pub fn unscheduled<'a>(mountings: impl IntoIterator<Item = &'a [[f64; 2]]>, language: Language) -> Option<String> {
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
