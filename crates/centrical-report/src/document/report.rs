//! The report of a calibration: verdict, session, parameters, budget, figures.

use centrical_session::{CalibrationResult, ValiditySummary};

use super::content::{Align, Block, Document, Margins, Opening, Section, Table, TableKind, Tone};
use super::drift::drift_facts;
use super::objection::{objection, pattern, rival};
use super::reading_error::error_table;
use super::rests_on::rests_on;
use super::tables::{budget, parameters};
use crate::evaluation::by_group;
use crate::figure::{Figure, figures, positions};
use crate::language::Language;

/// The report of a result, with `further` figures after its own.
pub fn report(result: &CalibrationResult, further: &[Figure], language: Language) -> Document {
    let (messages, session, program) = (language.messages(), &result.session, &result.program);
    let serial = if session.unit_serial.is_empty() { messages.not_given } else { &session.unit_serial };
    let title = format!("{}: {}", messages.calibration_report, session.unit_model);
    let further_sections = [
        conduct(result, language),
        drift(result, language),
        parameter_tables(result, language),
        uncertainty_budget(result, language),
        rests_on(result, language),
        mounting_positions(result, language),
        plots(result, further, language),
        inputs(result, language),
    ];
    let plain = |blocks| Section { tone: Tone::Plain, blocks };
    let further_sections = further_sections.into_iter().filter(|blocks| !blocks.is_empty()).map(plain);
    Document {
        language,
        opening: Opening {
            kind: messages.calibration_report.to_owned(),
            title: session.unit_model.clone(),
            lines: vec![format!("{} {serial}", messages.serial), session.title.clone()],
            date: session.date.clone(),
        },
        sections: std::iter::once(verdict(result, language)).chain(further_sections).collect(),
        margins: Margins {
            head: [title.clone(), session.date.clone()],
            foot: format!("{} {}, {}", program.name, program.version, result.schema),
            page: [messages.page, messages.of],
        },
        title,
    }
}

/// The verdict with its reasons, and what the instrument is worth after compensation.
fn verdict(result: &CalibrationResult, language: Language) -> Section {
    let messages = language.messages();
    let objections = result.objections();
    let mut blocks = if objections.is_empty() {
        vec![Block::heading(messages.acceptable, 4), Block::paragraph(messages.verdict_good)]
    } else {
        let reasons = objections.iter().map(|reason| objection(reason, language)).collect();
        let heading = Block::heading(messages.not_acceptable, 4);
        vec![heading, Block::paragraph(messages.verdict_bad), Block::List(reasons)]
    };
    let (fit, seen) = (&result.fit, &result.observability);
    let mut facts = Vec::new();
    if fit.degrees_of_freedom > 0 {
        let dof = fit.degrees_of_freedom as f64;
        let expected = language.fixed((2.0 / dof).sqrt(), 3);
        let ratio = language.fixed(fit.chi_squared / dof, 3);
        let chi_squared = format!("{ratio} (1 ± {expected}; ν = {})", fit.degrees_of_freedom);
        facts.push((messages.chi_squared.to_owned(), chi_squared));
        facts.extend(result.validity.iter().flat_map(|validity| checks(validity, language)));
    }
    facts.push((messages.rank.to_owned(), format!("{} / {}", seen.rank, seen.columns)));
    blocks.push(Block::Facts(facts));
    if let Some(errors) = error_table(result, language) {
        blocks.push(Block::Subheading(messages.residual_error.to_owned()));
        blocks.push(Block::Table(errors));
        blocks.push(Block::Note(messages.residual_error_note.to_owned()));
    }
    Section { tone: if objections.is_empty() { Tone::Good } else { Tone::Bad }, blocks }
}

/// What the residuals say of the model and of the weights.
fn checks(validity: &ValiditySummary, language: Language) -> Vec<(String, String)> {
    let messages = language.messages();
    let listed = |items: Vec<String>| if items.is_empty() { messages.none.to_owned() } else { items.join("; ") };
    let outlying = validity.outlying.iter().map(|p| format!("{}:{}", p.mounting, p.index + 1)).collect();
    let patterns = validity.patterns.iter().map(|found| pattern(found, language)).collect();
    let mut facts = vec![
        (messages.chi_squared_chance.to_owned(), language.probability(validity.probability)),
        (capitalised(messages.outlying_plateaus), listed(outlying)),
        (capitalised(messages.patterns_found), listed(patterns)),
    ];
    if validity.rivals_tested > 0 {
        let shown =
            validity.rivals.iter().filter(|shown| shown.explains_most).map(|shown| rival(shown, language)).collect();
        facts.push((format!("{} ({})", messages.rivals_tested, validity.rivals_tested), listed(shown)));
    }
    if let Some(worst) = validity.mountings.iter().min_by(|a, b| a.probability.total_cmp(&b.probability)) {
        let chance = (validity.mountings.len() as f64 * worst.probability).min(1.0);
        let chi_squared = language.fixed(worst.chi_squared, 1);
        let (nu, p) = (worst.degrees_of_freedom, language.probability(chance));
        let shown = format!("{}: χ² = {chi_squared}; ν = {nu}; p = {p}", worst.mounting);
        facts.push((messages.worst_mounting.to_owned(), shown));
    }
    facts
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// Model, data and method.
fn conduct(result: &CalibrationResult, language: Language) -> Vec<Block> {
    let (messages, model, fit) = (language.messages(), &result.model, &result.fit);
    let words = &messages.words;
    let gravity = format!("{} {}", language.number(&model.gravity.to_string()), language.unit("m/s^2"));
    let latitude = model.latitude.map(|latitude| format!("{}°", language.fixed(latitude.to_degrees(), 4)));
    let mountings = result.plateaus.iter().map(|p| p.mounting).max().unwrap_or(0);
    let samples: u64 = result.plateaus.iter().map(|p| p.samples).sum();
    let rejected: u64 = result.plateaus.iter().map(|p| p.rejected).sum();
    let data = format!(
        "{}: {mountings}; {}: {}; {}: {samples}; {}: {rejected}",
        messages.mountings_used,
        messages.plateaus_used,
        result.plateaus.len(),
        messages.samples,
        messages.rejected
    );
    let method =
        format!("{} ({}, {})", (words.method)(fit.method), (words.termination)(fit.termination), fit.iterations);
    let facts = Block::facts([
        (messages.gravity, gravity),
        (messages.latitude, latitude.unwrap_or_default()),
        (messages.pair_relation, (words.pair_relation)(model.pair_relation).to_owned()),
        (messages.reference, (words.reference)(model.reference).to_owned()),
        (messages.speed_uncertainty, language.scientific(model.speed_uncertainty)),
        (messages.speeds, speeds(result, language)),
        (messages.data, data),
        (messages.method, method),
        (messages.software, format!("{} {}", result.program.name, result.program.version)),
    ]);
    let text = (!result.session.text.is_empty()).then(|| Block::paragraph(&result.session.text));
    [Block::heading(messages.session, 4), facts].into_iter().chain(text).collect()
}

/// How the speeds are known and what contradicts them; empty where they are set and nothing does.
fn speeds(result: &CalibrationResult, language: Language) -> String {
    let words = &language.messages().words;
    let Some(speeds) = &result.speeds else { return String::new() };
    let measured = speeds.measured_by.as_ref().map(|_| (words.speeds_measured)(speeds));
    let found = speeds.findings.iter().map(words.speed_finding);
    measured.into_iter().chain(found).collect::<Vec<_>>().join("; ")
}

/// Drift and tilt, where the records show them.
fn drift(result: &CalibrationResult, language: Language) -> Vec<Block> {
    let messages = language.messages();
    let facts = drift_facts(result, language);
    if facts.is_empty() {
        return Vec::new();
    }
    let note = Block::Note(messages.steadiness_note.to_owned());
    vec![Block::heading(messages.steadiness, 4), note, Block::facts(facts)]
}

fn parameter_tables(result: &CalibrationResult, language: Language) -> Vec<Block> {
    let messages = language.messages();
    let mut blocks = vec![Block::heading(messages.parameters, 4), Block::Note(messages.parameters_note.to_owned())];
    let of_instrument = |name: &str| result.model.error_model.iter().any(|term| term.name == name);
    for (title, is_shown) in [(messages.instrument, true), (messages.mounting, false)] {
        let shown: Vec<_> = result.parameters.iter().filter(|p| of_instrument(&p.name) == is_shown).collect();
        let shown = by_group(&shown);
        if !shown.is_empty() {
            blocks.push(Block::Subheading(title.to_owned()));
            blocks.push(Block::Table(parameters(result, &shown, language)));
        }
    }
    blocks
}

fn uncertainty_budget(result: &CalibrationResult, language: Language) -> Vec<Block> {
    let messages = language.messages();
    let heading = Block::heading(messages.budget, 4);
    let Some(table) = budget(result, language) else { return vec![heading, Block::paragraph(messages.no_budget)] };
    let mut blocks = vec![heading, Block::paragraph(messages.budget_note)];
    if result.stated_sources().is_empty() {
        blocks.push(Block::paragraph(messages.no_budget));
    }
    blocks.push(Block::Table(table));
    blocks
}

fn mounting_positions(result: &CalibrationResult, language: Language) -> Vec<Block> {
    // The section's heading is the figure's title.
    let figure = positions(result, language).map(|figure| Figure { title: String::new(), ..figure });
    let heading = || Block::heading(language.messages().positions, 4);
    figure.map(|figure| vec![heading(), Block::Figure(figure)]).unwrap_or_default()
}

/// The figures, each with the combinations that it shows as undetermined.
fn plots(result: &CalibrationResult, further: &[Figure], language: Language) -> Vec<Block> {
    let messages = language.messages();
    let mut blocks = vec![Block::heading(messages.plots, 4)];
    for figure in figures(result, language) {
        let combinations = figure.combinations.clone();
        blocks.push(Block::Figure(figure));
        if !combinations.is_empty() {
            blocks.push(Block::Paragraph(format!("{}:", messages.null_directions)));
            blocks.push(Block::Formulas(combinations));
        }
    }
    blocks.extend(further.iter().cloned().map(Block::Figure));
    blocks
}

fn inputs(result: &CalibrationResult, language: Language) -> Vec<Block> {
    let messages = language.messages();
    let columns = [(messages.file, 0.4, Align::Left), ("SHA-256", 0.6, Align::Left)];
    let rows = result.inputs.iter().map(|input| vec![input.path.clone(), input.sha256.clone()]);
    let table = Table { kind: TableKind::Files, ..Table::numbers(columns, rows) };
    vec![Block::heading(messages.inputs, 4), Block::paragraph(messages.inputs_note), Block::Table(table)]
}
