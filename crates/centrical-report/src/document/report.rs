//! The report of a calibration: verdict, session, parameters, budget, figures.

use centrical_session::{CalibrationResult, ParameterEstimate, UnitHistoryReport, ValiditySummary, customary};

use super::axes::axes;
use super::conformity::{judged_in_words, rule};
use super::content::{Align, Block, Column, Document, Fact, Margins, Opening, Row, Section, Table, TableKind, Tone};
use super::drift::drift;
use super::objection::{pattern, refusal, rival};
use super::reading_error::{error_note, error_table, headline_table};
use super::rests_on::{all_rests_on, condition_of_conformity, rests_on};
use super::switch_on::switch_on;
use super::tables::{by_group, degrees_of_freedom, nominal_output, of_arm, parameters, serial};
use crate::evaluation::{UnitStatement, UnitVerdict, equations, symbol};
use crate::figure::{Figure, positions};
use crate::language::Language;
use crate::number::grouped;

/// What a source leaves is not shown below this part of the combined uncertainty.
const NEGLIGIBLE: f64 = 1e-3;

/// The report of a result: what every reader sees, then what some will open. `unit` is what a decision says of the unit, `past`
/// what its earlier calibrations say, and `figures` are those of the result ([`crate::figures`]) and what is to stand after them.
pub fn report(
    result: &CalibrationResult,
    unit: Option<&UnitStatement>,
    past: Option<&UnitHistoryReport>,
    figures: Vec<Figure>,
    language: Language,
) -> Document {
    let (messages, session, program) = (language.messages(), &result.session, &result.program);
    let title = format!("{}: {}", messages.calibration_report, session.unit_model);
    let (drawn, rest): (Vec<_>, Vec<_>) = figures.into_iter().partition(is_of_first_layer);
    let first = [
        headline(result, language),
        error_model(result, language),
        instrument_parameters(result, language),
        axes(result, language),
        plots(messages.first_plots, drawn, language),
        rests_on(result, language),
        past.map(|past| switch_on(past, language)).unwrap_or_default(),
    ];
    let opened = [
        conduct(result, language),
        checks(result, language),
        drift(result, Block::Note, 4, language),
        reading_errors(result, language),
        geometry_parameters(result, language),
        uncertainty_budget(result, language),
        all_rests_on(result, language),
        mounting_positions(result, language),
        plots(messages.further_plots, rest, language),
        inputs(result, language),
    ];
    let is_not_empty = |blocks: &Vec<Block>| !blocks.is_empty();
    let first = first.into_iter().filter(is_not_empty).map(Section::plain);
    let opened = opened.into_iter().filter(is_not_empty).map(Section::further);
    Document {
        language,
        opening: Opening {
            kind: messages.calibration_report.to_owned(),
            title: session.unit_model.clone(),
            lines: vec![format!("{} {}", messages.serial, serial(session, language)), session.title.clone()],
            date: language.written_date(&session.date),
            picture: None,
        },
        contents: messages.contents.to_owned(),
        sections: verdicts(result, unit, language).into_iter().chain(first).chain(opened).collect(),
        margins: Margins {
            head: [title.clone(), language.written_date(&session.date)],
            foot: format!("{} {}, {}", program.name, program.version, result.schema),
            page: [messages.page, messages.of],
        },
        attachment: None,
        title,
    }
}

/// Errors before and after compensation, and their uncertainty.
fn is_of_first_layer(figure: &Figure) -> bool {
    ["attitudes", "before", "after", "prediction"].contains(&figure.name)
}

/// The verdict on the calibration and, apart, what is said of the unit.
fn verdicts(result: &CalibrationResult, unit: Option<&UnitStatement>, language: Language) -> [Section; 2] {
    let messages = language.messages();
    let objections = result.objections();
    let not_checked = (messages.words.not_checked)(result.redundancy());
    let good = not_checked.map_or_else(
        || messages.verdict_good.to_owned(),
        |not_checked| format!("{} {not_checked}", messages.verdict_as_stated),
    );
    let mut blocks = if objections.is_empty() {
        vec![Block::heading(messages.acceptable, 4), Block::Paragraph(good)]
    } else {
        refusal(&objections, language)
    };
    if result.chi_squared_is_small() {
        blocks.push(Block::paragraph(messages.chi_squared_small));
    }
    let (fit, seen) = (&result.fit, &result.observability);
    let mut facts = Vec::new();
    if let Some((ratio, spread)) = fit.ratio() {
        let [ratio, expected] = [ratio, spread].map(|number| language.fixed(number, 3));
        facts.push((messages.chi_squared, format!("{ratio} (1 ± {expected}; ν = {})", fit.degrees_of_freedom)));
        let chance = result.validity.as_ref().map(|validity| language.probability(validity.probability));
        facts.push((messages.chi_squared_chance, chance.unwrap_or_default()));
    }
    facts.push((messages.rank, format!("{} / {}", seen.rank, seen.columns)));
    blocks.push(Block::facts(facts));
    let tone = if objections.is_empty() { Tone::Good } else { Tone::Bad };
    [Section { tone, ..Section::plain(blocks) }, of_unit(result, unit, language)]
}

/// What is said of the unit, which is not what is said of its calibration.
fn of_unit(result: &CalibrationResult, unit: Option<&UnitStatement>, language: Language) -> Section {
    let messages = language.messages();
    let Some(unit) = unit else {
        let blocks = vec![Block::heading(messages.unit_not_asked, 4), Block::paragraph(messages.unit_not_asked_text)];
        return Section { tone: Tone::Neutral, ..Section::plain(blocks) };
    };
    let (tone, heading, text) = match unit.verdict() {
        UnitVerdict::Within => (Tone::Good, messages.unit_within, messages.unit_within_text),
        UnitVerdict::Outside => (Tone::Bad, messages.unit_outside, messages.unit_outside_text),
        UnitVerdict::InGuardBand => (Tone::Bad, messages.unit_in_guard_band, messages.unit_in_guard_band_text),
        UnitVerdict::NotStated => (Tone::Neutral, messages.unit_not_stated, messages.unit_not_stated_text),
    };
    let mut blocks = vec![Block::heading(heading, 4), Block::paragraph(text)];
    let broken = unit.judged.iter().filter(|judged| judged.conforms == Some(false));
    let broken: Vec<String> = broken.map(|judged| judged_in_words(judged, language)).collect();
    if !broken.is_empty() {
        blocks.push(Block::List(broken));
    }
    blocks.push(Block::facts([
        (messages.specification, unit.specification.clone()),
        // What the rule asks for stands in the certificate.
        (messages.decision_rule, rule(unit.rule, language).split(':').next().unwrap_or_default().to_owned()),
        (messages.limits_judged, unit.judged.len().to_string()),
    ]));
    blocks.extend(condition_of_conformity(result, language).map(Block::Paragraph));
    Section { tone, ..Section::plain(blocks) }
}

/// What the instrument is worth before and after compensation.
fn headline(result: &CalibrationResult, language: Language) -> Vec<Block> {
    let messages = language.messages();
    let Some(table) = headline_table(result, language) else { return Vec::new() };
    let note = if result.model.has_arm() { messages.headline_note } else { messages.headline_note_of_rests };
    vec![Block::heading(messages.headline, 4), Block::Table(table), Block::Note(note.to_owned())]
}

/// The equations of the readings, and every symbol of them in words.
fn error_model(result: &CalibrationResult, language: Language) -> Vec<Block> {
    let messages = language.messages();
    let mut blocks = vec![
        Block::heading(messages.error_model, 4),
        Block::paragraph(messages.error_model_note),
        Block::Formulas(equations(result).into()),
        Block::Facts(symbols(result, language)),
    ];
    blocks.extend(nominal_output(result, language));
    blocks
}

/// Every coefficient of the error model by its group, with what it is.
fn symbols(result: &CalibrationResult, language: Language) -> Vec<Fact> {
    let named = |of: &[&ParameterEstimate]| {
        let names: Vec<String> = of.iter().map(|parameter| symbol(&parameter.name)).collect();
        (names.join(", "), (language.messages().words.meaning)(of[0].group).to_owned())
    };
    by_group(result, true).chunk_by(|a, b| a.group == b.group).map(named).collect()
}

/// Errors of the readings in full.
fn reading_errors(result: &CalibrationResult, language: Language) -> Vec<Block> {
    let messages = language.messages();
    let Some(errors) = error_table(result, language) else { return Vec::new() };
    vec![
        Block::heading(messages.residual_error, 4),
        Block::Table(errors),
        Block::Note(error_note(result, language).to_owned()),
    ]
}

/// What the residuals say of the model and of the weights.
fn checks(result: &CalibrationResult, language: Language) -> Vec<Block> {
    let Some(validity) = result.validity.as_ref().filter(|_| result.fit.degrees_of_freedom > 0) else {
        return Vec::new();
    };
    vec![Block::heading(language.messages().checks, 4), Block::Facts(check_facts(validity, language))]
}

fn check_facts(validity: &ValiditySummary, language: Language) -> Vec<(String, String)> {
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
    if let Some((worst, family_wise)) = validity.worst_mounting() {
        let (count, corrected) = (validity.mountings.len(), language.probability(family_wise));
        let chi_squared = language.fixed(worst.chi_squared, 1);
        let (nu, p) = (worst.degrees_of_freedom, language.probability(worst.probability));
        let shown = format!(
            "{}: χ² = {chi_squared}; ν = {nu}; p = {p} ({}); {} {count}: {corrected}",
            worst.mounting, messages.f_test, messages.corrected_for
        );
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
    let plateaus = result.plateaus.len() - result.held_out().len();
    // Of rests alone each is a mounting.
    let used = if model.has_arm() {
        format!("{}: {mountings}; {}: {plateaus}", messages.mountings_used, messages.plateaus_used)
    } else {
        format!("{}: {plateaus}", messages.rests_used)
    };
    let data =
        format!("{used}; {}: {}; {}: {}", messages.samples, grouped(samples), messages.rejected, grouped(rejected));
    let method =
        format!("{} ({}, {})", (words.method)(fit.method), (words.termination)(fit.termination), fit.iterations);
    let of_arm = |fact: String| of_arm(model, fact);
    let facts = Block::facts([
        (messages.gravity, gravity),
        (messages.latitude, latitude.unwrap_or_default()),
        (messages.pair_relation, of_arm((words.pair_relation)(model.pair_relation).to_owned())),
        (messages.reference, of_arm((words.reference)(model.reference).to_owned())),
        (messages.speed_uncertainty, of_arm(language.scientific(model.speed_uncertainty))),
        (messages.speeds, of_arm(speeds(result, language).join("; "))),
        (messages.data, data),
        (messages.held_out_plateaus, result.held_out().join(", ")),
        (messages.method, method),
        (messages.software, format!("{} {}", result.program.name, result.program.version)),
    ]);
    let text = (!result.session.text.is_empty()).then(|| Block::paragraph(&result.session.text));
    [Block::heading(messages.session, 4), facts].into_iter().chain(text).collect()
}

/// How the speeds are known and what contradicts them; nothing where they are set and nothing does.
pub(crate) fn speeds(result: &CalibrationResult, language: Language) -> Vec<String> {
    let words = &language.messages().words;
    let Some(speeds) = &result.speeds else { return Vec::new() };
    let measured = speeds.measured_by.as_ref().map(|_| (words.speeds_measured)(speeds));
    measured.into_iter().chain(speeds.findings.iter().map(words.speed_finding)).collect()
}

/// The coefficients of the error model.
fn instrument_parameters(result: &CalibrationResult, language: Language) -> Vec<Block> {
    let messages = language.messages();
    let note = Block::Note(messages.parameters_note.to_owned());
    let blocks = vec![Block::heading(messages.parameters_of_instrument, 4), note];
    with_parameters(blocks, result, true, language)
}

/// The unknowns of the experiment beside them.
fn geometry_parameters(result: &CalibrationResult, language: Language) -> Vec<Block> {
    with_parameters(vec![Block::heading(language.messages().mounting, 4)], result, false, language)
}

fn with_parameters(
    mut blocks: Vec<Block>,
    result: &CalibrationResult,
    coefficients: bool,
    language: Language,
) -> Vec<Block> {
    let shown = by_group(result, coefficients);
    if shown.is_empty() {
        return Vec::new();
    }
    blocks.push(Block::Table(parameters(result, &shown, language)));
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

/// Standard uncertainty by source; `None` if no budget was made.
fn budget(result: &CalibrationResult, language: Language) -> Option<Table> {
    let messages = language.messages();
    let budget = result.budget.as_ref()?;
    let mut titles = vec![messages.parameter, messages.unit];
    titles.extend(budget.sources.iter().map(|source| (messages.words.source)(source.name)));
    titles.extend([messages.combined, messages.degrees_word]);
    let share = 1.0 / titles.len() as f32;
    let column = |(n, title): (usize, &str)| {
        let align = if n < 2 { Align::Left } else { Align::Right };
        Column { title: title.to_owned(), share, align }
    };
    let columns = titles.into_iter().enumerate().map(column).collect();
    let row = |(j, parameter): (usize, &ParameterEstimate)| {
        let (factor, unit) = customary(&parameter.unit, parameter.group);
        let shown = |value: Option<f64>| value.map_or(String::new(), |value| language.significant(value * factor, 2));
        let of_parameter = |numbers: &[Option<f64>]| numbers.get(j).copied().flatten();
        let combined = of_parameter(&budget.combined);
        let negligible = NEGLIGIBLE * combined.unwrap_or(0.0);
        let of_source = |value: Option<f64>| {
            if value.is_some_and(|value| value < negligible) { "–".to_owned() } else { shown(value) }
        };
        let mut cells = vec![symbol(&parameter.name), language.unit(unit)];
        cells.extend(budget.sources.iter().map(|source| of_source(of_parameter(&source.standard_uncertainty))));
        if combined.is_some() {
            let degrees = of_parameter(&budget.degrees_of_freedom)
                .map_or("∞".to_owned(), |nu| degrees_of_freedom(nu, language));
            cells.extend([shown(combined), degrees]);
        } else {
            cells.extend([messages.not_determined.to_owned(), String::new()]);
        }
        Row::Cells(cells)
    };
    let rows = result.parameters.iter().enumerate().map(row).collect();
    Some(Table { kind: TableKind::Numbers, columns, rows })
}

fn mounting_positions(result: &CalibrationResult, language: Language) -> Vec<Block> {
    // The section's heading is the figure's title.
    let figure = positions(result, language).map(|figure| Figure { title: String::new(), ..figure });
    let heading = || Block::heading(language.messages().positions, 4);
    figure.map(|figure| vec![heading(), Block::Figure(figure)]).unwrap_or_default()
}

/// Figures, each with the combinations that it shows as undetermined.
fn plots(heading: &str, figures: Vec<Figure>, language: Language) -> Vec<Block> {
    let messages = language.messages();
    if figures.is_empty() {
        return Vec::new();
    }
    let mut blocks = vec![Block::heading(heading, 4)];
    for figure in figures {
        let combinations = figure.combinations.clone();
        blocks.push(Block::Figure(figure));
        if !combinations.is_empty() {
            blocks.push(Block::Paragraph(format!("{}:", messages.null_directions)));
            blocks.push(Block::Formulas(combinations));
        }
    }
    blocks
}

fn inputs(result: &CalibrationResult, language: Language) -> Vec<Block> {
    let messages = language.messages();
    let columns = [(messages.file, 0.4, Align::Left), ("SHA-256", 0.6, Align::Left)];
    let rows = result.inputs.iter().map(|input| vec![input.path.clone(), input.sha256.clone()]);
    let table = Table { kind: TableKind::Files, ..Table::numbers(columns, rows) };
    vec![Block::heading(messages.inputs, 4), Block::paragraph(messages.inputs_note), Block::Table(table)]
}
