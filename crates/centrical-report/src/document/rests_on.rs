//! What a result rests on: effects whose absence it presupposes.

use centrical::Source;
use centrical_session::{CalibrationResult, MICRO_G, RestsOn, customary};

use super::content::{Align, Block, Table};
use super::objection::cause;
use crate::evaluation::symbol;
use crate::language::Language;

/// Effects that a certificate and the first layer of a report name: more than these tell a hurried reader no more.
const WORST: usize = 3;

/// Rows of the table in full.
const ROWS: usize = 12;

/// What counts as exact, what is presupposed, and the worst effects whose absence is.
pub(super) fn rests_on(result: &CalibrationResult, language: Language) -> Vec<Block> {
    let messages = language.messages();
    let mut blocks = vec![
        Block::heading(messages.rests_on, 4),
        Block::paragraph(&uncertainty_holds(result, language)),
        Block::paragraph(&presupposed(result, language)),
    ];
    if !result.rests_on.is_empty() {
        blocks.push(Block::Subheading(messages.effects_absent.to_owned()));
        blocks.push(Block::Table(table(result, WORST, language)));
        blocks.push(Block::Note(messages.rests_on_note.to_owned()));
    }
    blocks
}

/// The table in full, the worst effect first; nothing where the first layer has it all.
pub(super) fn all_rests_on(result: &CalibrationResult, language: Language) -> Vec<Block> {
    if result.rests_on.len() <= WORST {
        return Vec::new();
    }
    vec![Block::heading(language.messages().all_rests_on, 4), Block::Table(table(result, ROWS, language))]
}

/// The quantities that count as exact, by name; `None` where all are stated.
pub(crate) fn counts_as_exact(result: &CalibrationResult, language: Language) -> Option<String> {
    let exact = exact(result);
    (!exact.is_empty()).then(|| named(exact, language))
}

/// What the expanded uncertainties hold: all that the GUM asks for, or some sources beside quantities that count as exact.
pub(crate) fn uncertainty_holds(result: &CalibrationResult, language: Language) -> String {
    let messages = language.messages();
    let Some(exact) = counts_as_exact(result, language) else {
        return format!("{} {}", messages.evaluated_by_gum, messages.nothing_exact);
    };
    let weighed = [Some(Source::Noise), result.model.has_arm().then_some(Source::PlateauSpeed)];
    let held = match &result.budget {
        Some(budget) => budget.sources.iter().map(|source| source.name).collect(),
        None => weighed.into_iter().flatten().collect(),
    };
    format!("{}: {}. {}: {exact}.", messages.uncertainty_holds, named(held, language), messages.taken_as_exact)
}

/// On which condition a statement of conformity holds; `None` if no quantity counts as exact.
pub(crate) fn condition_of_conformity(result: &CalibrationResult, language: Language) -> Option<String> {
    let exact = counts_as_exact(result, language)?;
    Some(format!("{}: {exact}.", language.messages().conformity_presupposes))
}

fn named(sources: Vec<Source>, language: Language) -> String {
    let name = |source| (language.messages().words.source)(source).to_lowercase();
    sources.into_iter().map(name).collect::<Vec<_>>().join(", ")
}

/// Quantities that an uncertainty may be stated of, and that this session states none of.
fn exact(result: &CalibrationResult) -> Vec<Source> {
    let stated = result.stated_sources();
    let of_quantity = [
        Source::Gravity,
        Source::Latitude,
        Source::Radius,
        Source::SpeedScale,
        Source::RestAngle,
        Source::ProofMasses,
        Source::Attitude,
    ];
    let is_exact = |source: &Source| {
        let is_in_model = *source != Source::Latitude || result.model.latitude.is_some();
        let acts = result.model.has_arm() || *source == Source::Gravity;
        acts && is_in_model && !stated.contains(source)
    };
    of_quantity.into_iter().filter(is_exact).collect()
}

/// What the stated uncertainties presuppose of the machine, or of the rests; and what they include because residuals do not exclude it.
fn presupposed(result: &CalibrationResult, language: Language) -> String {
    let messages = language.messages();
    let presupposed = if result.model.has_arm() { messages.presupposed } else { messages.presupposed_of_rests };
    let size = |size: f64| micro_g(size, language);
    let mut sentences = vec![presupposed.to_owned()];
    if let Some(between) = &result.between_rests {
        sentences.push((messages.words.between_rests)(&size(between.scatter), &size(between.drift)));
    }
    if let Some(turning) = &result.turning {
        let in_unit = |value: f64, unit: &str| format!("{} {}", language.significant(value, 2), language.unit(unit));
        let (rate, radius) = (in_unit(turning.rate.to_degrees(), "deg/s"), in_unit(1e3 * turning.radius, "mm"));
        let share = language.significant(100.0 * turning.share, 2);
        sentences.push((messages.words.turning)(turning.arcs, &share, [&rate, &radius, &size(turning.acceleration)]));
    }
    sentences.join(" ")
}

/// What no reading checks, and what the stated uncertainties presuppose, in a sentence for each of the worst effects.
pub(crate) fn presuppositions(result: &CalibrationResult, language: Language) -> String {
    let messages = language.messages();
    let worst = result.rests_on.iter().take(WORST).map(|effect| rests_on_sentence(effect, language));
    let worst: Vec<String> = worst.collect();
    let effects = if worst.is_empty() {
        String::new()
    } else {
        format!(" {}: {}.", messages.rests_on_sentence, worst.join("; "))
    };
    let not_checked = (messages.words.not_checked)(result.redundancy()).map(|sentence| sentence + " ");
    format!("{}{}{effects}", not_checked.unwrap_or_default(), presupposed(result, language))
}

fn table(result: &CalibrationResult, rows: usize, language: Language) -> Table {
    let messages = language.messages();
    let columns = [
        (messages.rests_on_effect, 0.4, Align::Left),
        (messages.rests_on_size, 0.22, Align::Right),
        (messages.rests_on_moves, 0.22, Align::Right),
        (messages.rests_on_reading, 0.16, Align::Right),
    ];
    let row = |effect: &RestsOn| {
        let shift = language.significant(effect.standard_uncertainties, 2);
        let moved = format!("{}: {shift}\u{a0}u", symbol(&effect.parameter));
        vec![cause(&effect.name, language), size(effect, language), moved, micro_g(effect.reading, language)]
    };
    Table::numbers(columns, result.rests_on.iter().take(rows).map(row))
}

/// One effect in a sentence: the size below which it would not show, and what that size does.
pub(crate) fn rests_on_sentence(effect: &RestsOn, language: Language) -> String {
    let messages = language.messages();
    let unseen = match effect.smallest_shown {
        Some(_) => format!("{} {} {}", messages.below, size(effect, language), messages.would_not_show),
        None => messages.would_never_show.to_owned(),
    };
    let uncertainties = language.significant(effect.standard_uncertainties, 2);
    format!(
        "{}: {unseen} {} {} {}{} {} {}",
        cause(&effect.name, language),
        symbol(&effect.parameter),
        messages.by,
        (messages.words.standard_uncertainties)(&uncertainties),
        if language == Language::Russian { "," } else { "" },
        messages.and_reading_by,
        micro_g(effect.reading, language)
    )
}

/// In the first unit in which it has four digits at most before the point.
fn micro_g(acceleration: f64, language: Language) -> String {
    let units = [(MICRO_G, "ug"), (1e3 * MICRO_G, "mg"), (1e6 * MICRO_G, "g")];
    let (size, unit) = units.into_iter().find(|(size, _)| acceleration < 1e4 * size).unwrap_or(units[2]);
    format!("{} {}", language.significant(acceleration / size, 2), language.unit(unit))
}

fn size(effect: &RestsOn, language: Language) -> String {
    let (factor, unit) = customary(&effect.unit, effect.group);
    match effect.smallest_shown {
        Some(size) => format!("{} {}", language.two_digits(size * factor), language.unit(unit)),
        None => language.messages().not_shown.to_owned(),
    }
}
