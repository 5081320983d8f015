//! What the earlier calibrations of a unit say of a reading after its next switch-on.

use centrical_session::{
    MICRO_G, ReadingHistory, STANDARD_GRAVITY, UnitHistoryReport, UnitHistoryRequest, UnitParameter,
};

use super::content::{Align, Block, Table};
use crate::evaluation::symbol;
use crate::language::Language;
use crate::number::unsigned_zero;

/// The heading, what changed between the calibrations, and the uncertainty of compensated readings.
pub(super) fn switch_on(history: &UnitHistoryReport, language: Language) -> Vec<Block> {
    let messages = language.messages();
    let mut blocks = vec![
        Block::heading(messages.switch_on, 12),
        Block::paragraph(messages.switch_on_text),
        Block::facts([
            (messages.calibrations_of_unit, calibrations(history, language)),
            (messages.same_unit, sameness(history, language)),
            (messages.parameters_scatter, named(history, |p| p.scatters, language)),
            (messages.parameters_drift, named(history, |p| p.drifts, language)),
        ]),
    ];
    if !history.readings.is_empty() {
        blocks.push(Block::Table(readings(history, language)));
        blocks.push(Block::Note(messages.switch_on_note.to_owned()));
    }
    blocks
}

/// The same in a sentence: the reading that is least certain. `None` without readings.
pub(crate) fn switch_on_sentence(history: &UnitHistoryReport, language: Language) -> Option<String> {
    let messages = language.messages();
    let worst = history.readings.iter().max_by(|a, b| a.after_switch_on.total_cmp(&b.after_switch_on))?;
    let expanded =
        worst.expanded_after_switch_on.map(|u| format!(", {} = {}", expanded_title(language), micro_g(u, language)));
    let after = format!("{}{}", micro_g(worst.after_switch_on, language), expanded.unwrap_or_default());
    Some(format!(
        "{} {}: u = {after} {ug}; {} {}, {} {} g; {}: {} {ug}; {}: {}",
        messages.switch_on_text,
        messages.after_switch_on,
        messages.newtonometer,
        worst.axis,
        messages.specific_force,
        force(worst, language),
        messages.between_calibrations,
        between_with_interval(worst, language),
        messages.calibrations_of_unit,
        calibrations(history, language),
        ug = language.unit("ug"),
    ))
}

/// How many, from which day to which, and how many besides that do not determine the same parameters.
fn calibrations(history: &UnitHistoryReport, language: Language) -> String {
    let days = history.sessions.iter().map(|session| session.date);
    let ends = days.clone().min().zip(days.max());
    let ends = ends.map(|(first, last)| format!(" ({} – {})", language.date(first), language.date(last)));
    let left_out = match history.left_out.len() {
        0 => String::new(),
        count => format!("; {}: {count}", language.messages().calibrations_left_out),
    };
    let refused = match history.sessions.iter().filter(|session| !session.acceptable).count() {
        0 => String::new(),
        count => format!("; {}: {count}", language.messages().calibrations_not_acceptable),
    };
    format!("{}{}{refused}{left_out}", history.sessions.len(), ends.unwrap_or_default())
}

fn sameness(history: &UnitHistoryReport, language: Language) -> String {
    history.sameness.as_ref().map_or_else(String::new, |test| {
        let (chi_squared, chance) = (language.fixed(test.chi_squared, 1), language.probability(test.probability));
        format!("χ² = {chi_squared}; ν = {}; p: {chance}", test.degrees_of_freedom)
    })
}

/// Symbols of the selected parameters.
fn named(history: &UnitHistoryReport, is_meant: impl Fn(&UnitParameter) -> bool, language: Language) -> String {
    let names: Vec<String> = history.parameters.iter().filter(|p| is_meant(p)).map(|p| symbol(&p.name)).collect();
    let messages = language.messages();
    if !names.is_empty() {
        names.join(", ")
    } else if history.is_unexplained() {
        messages.not_told_apart.to_owned()
    } else {
        messages.none.to_owned()
    }
}

/// The only expanded uncertainty of the documents whose probability is not 95.45 %: that of a history.
fn expanded_title(language: Language) -> String {
    format!("U ({} %)", language.fixed(100.0 * UnitHistoryRequest::COVERAGE, 2))
}

fn readings(history: &UnitHistoryReport, language: Language) -> Table {
    let messages = language.messages();
    let ug = language.unit("ug");
    let [stated, between, after] = [messages.this_calibration, messages.between_calibrations, messages.after_switch_on]
        .map(|m| format!("{m}, {ug}"));
    let columns = [
        (messages.newtonometer, 0.19, Align::Left),
        (&format!("{}, g", messages.specific_force), 0.16, Align::Left),
        (&stated, 0.15, Align::Right),
        (&between, 0.21, Align::Right),
        (&after, 0.14, Align::Right),
        (&expanded_title(language), 0.15, Align::Right),
    ];
    let row = |r: &ReadingHistory| {
        vec![
            r.axis.to_string(),
            force(r, language),
            micro_g(r.stated, language),
            between_with_interval(r, language),
            micro_g(r.after_switch_on, language),
            r.expanded_after_switch_on.map_or_else(String::new, |u| micro_g(u, language)),
        ]
    };
    Table::numbers(columns, history.shown_readings().into_iter().map(row))
}

/// The standard deviation between calibrations with its interval. Where they scatter less than nearly all would that state such
/// uncertainties, the interval has no length.
fn between_with_interval(reading: &ReadingHistory, language: Language) -> String {
    let [low, high] = reading.between_interval.map(|u| micro_g(u, language));
    let interval = match reading.between_interval {
        [_, 0.0] => language.messages().less_than_stated.to_owned(),
        _ => format!("{low} … {high}"),
    };
    format!("{} ({interval})", micro_g(reading.between, language))
}

fn micro_g(u: f64, language: Language) -> String {
    if u == 0.0 { "0".to_owned() } else { language.significant(u / MICRO_G, 2) }
}

fn force(reading: &ReadingHistory, language: Language) -> String {
    let parts = reading.force.map(|f| language.number(&unsigned_zero(format!("{:.0}", f / STANDARD_GRAVITY))));
    format!("({})", parts.join("; "))
}
