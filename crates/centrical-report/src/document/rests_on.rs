//! What a result rests on: effects whose absence it presupposes.

use centrical_session::{CalibrationResult, MICRO_G, RestsOn, customary};

use super::content::{Align, Block, Table};
use super::objection::cause;
use crate::language::Language;

/// Rows of the table in a report.
const ROWS: usize = 12;

/// The table for a report, the worst effect first.
pub(super) fn rests_on(result: &CalibrationResult, language: Language) -> Vec<Block> {
    if result.rests_on.is_empty() {
        return Vec::new();
    }
    let messages = language.messages();
    let columns = [
        (messages.rests_on_effect, 0.4, Align::Left),
        (messages.rests_on_size, 0.22, Align::Right),
        (messages.rests_on_moves, 0.22, Align::Right),
        (messages.rests_on_reading, 0.16, Align::Right),
    ];
    let row = |effect: &RestsOn| {
        let moved = format!("{}: {}\u{a0}u", effect.parameter, language.significant(effect.standard_uncertainties, 2));
        let reading = format!("{} {}", language.significant(effect.reading / MICRO_G, 2), language.unit("ug"));
        vec![cause(&effect.name, language), size(effect, language), moved, reading]
    };
    vec![
        Block::heading(messages.rests_on, 4),
        Block::paragraph(messages.rests_on_note),
        Block::Table(Table::numbers(columns, result.rests_on.iter().take(ROWS).map(row))),
    ]
}

/// One effect in a sentence: the size below which it would not show, and what that size does.
pub(crate) fn rests_on_sentence(effect: &RestsOn, language: Language) -> String {
    let messages = language.messages();
    let unseen = match effect.smallest_shown {
        Some(_) => format!("{} {} {}", messages.below, size(effect, language), messages.would_not_show),
        None => messages.would_never_show.to_owned(),
    };
    let uncertainties = language.significant(effect.standard_uncertainties, 2);
    let reading = language.significant(effect.reading / MICRO_G, 2);
    format!(
        "{}: {unseen} {} {} {uncertainties} {} {reading} {}",
        cause(&effect.name, language),
        effect.parameter,
        messages.by,
        messages.uncertainties_and_reading,
        language.unit("ug")
    )
}

fn size(effect: &RestsOn, language: Language) -> String {
    let (factor, unit) = customary(&effect.unit, effect.group);
    match effect.smallest_shown {
        Some(size) => format!("{} {}", language.significant(size * factor, 2), language.unit(unit)),
        None => language.messages().not_shown.to_owned(),
    }
}
