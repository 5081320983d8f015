//! The report as one HTML file: no network, no scripts, legible on a telephone, on paper and in the dark.

mod table;

use std::fmt::Write;

use centrical_session::{CalibrationResult, ValiditySummary};

use crate::figures::{Figure, figures, positions};
use crate::groups::by_group;
use crate::language::Language;
use crate::plot::Escaped;
use crate::reading_error::{ReadingError, error_table, reading_errors};
use crate::steadiness::facts;
use crate::terminal::combination;
use crate::verdict::objections;
use table::{Table, budget, parameters};

const STYLE: &str = include_str!("html/style.css");

/// The whole page. The same result gives the same bytes.
pub fn html_report(result: &CalibrationResult, language: Language) -> String {
    html_report_with(result, &[], language)
}

/// The page with `further` figures after those of the result.
pub fn html_report_with(result: &CalibrationResult, further: &[Figure], language: Language) -> String {
    let messages = language.messages();
    let title = format!("{}: {}", messages.calibration_report, result.session.unit_model);
    let mut html = format!(
        "<!DOCTYPE html>\n<html lang=\"{}\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\
         <meta name=\"color-scheme\" content=\"light dark\"><link rel=\"icon\" href=\"data:,\">\
         <title>{}</title><style>{STYLE}</style></head>\n<body><main>\n",
        language.code(),
        Escaped(&title)
    );
    heading(&mut html, result, language);
    verdict(&mut html, result, language);
    session(&mut html, result, language);
    steadiness_section(&mut html, result, language);
    parameter_tables(&mut html, result, language);
    budget_section(&mut html, result, language);
    if let Some(figure) = positions(result, language) {
        section(&mut html, messages.positions, |html| draw(html, &figure, false));
    }
    section(&mut html, messages.plots, |html| {
        for figure in figures(result, language) {
            draw(html, &figure, true);
            if figure.name == "singular-values" {
                null_directions(html, result, language);
            }
        }
        for figure in further {
            draw(html, figure, true);
        }
    });
    inputs(&mut html, result, language);
    let _ = write!(
        html,
        "<footer>{} {}, {}</footer>\n</main></body></html>\n",
        Escaped(&result.program.name),
        Escaped(&result.program.version),
        Escaped(&result.schema)
    );
    html
}

fn section(html: &mut String, title: &str, body: impl FnOnce(&mut String)) {
    let _ = writeln!(html, "<section><h2>{}</h2>", Escaped(title));
    body(html);
    html.push_str("</section>\n");
}

fn paragraph(html: &mut String, text: &str) {
    let _ = writeln!(html, "<p>{}</p>", Escaped(text));
}

fn heading(html: &mut String, result: &CalibrationResult, language: Language) {
    let (messages, session) = (language.messages(), &result.session);
    let serial = if session.unit_serial.is_empty() { messages.not_given } else { &session.unit_serial };
    let _ = writeln!(
        html,
        "<header><p class=\"kind\">{}</p><h1>{}</h1><p>{} {}</p><p>{}, <time>{}</time></p></header>",
        messages.calibration_report,
        Escaped(&session.unit_model),
        messages.serial,
        Escaped(serial),
        Escaped(&session.title),
        Escaped(&session.date)
    );
}

/// The verdict with its reasons, and what the instrument is worth after compensation.
fn verdict(html: &mut String, result: &CalibrationResult, language: Language) {
    let messages = language.messages();
    let objections = objections(result);
    let (class, word) =
        if objections.is_empty() { ("good", messages.acceptable) } else { ("bad", messages.not_acceptable) };
    let _ = write!(html, "<section class=\"verdict {class}\"><h2>{word}</h2>");
    if objections.is_empty() {
        paragraph(html, messages.verdict_good);
    } else {
        paragraph(html, messages.verdict_bad);
        let items = objections.iter().map(|o| format!("<li>{}</li>", Escaped(&messages.objection(o, language))));
        let _ = writeln!(html, "<ul>{}</ul>", items.collect::<String>());
    }
    let (fit, seen) = (&result.fit, &result.observability);
    let mut facts = Table::new("facts");
    if fit.degrees_of_freedom > 0 {
        let dof = fit.degrees_of_freedom as f64;
        let expected = language.fixed((2.0 / dof).sqrt(), 3);
        let ratio = language.fixed(fit.chi_squared / dof, 3);
        facts.row(messages.chi_squared, &[format!("{ratio} (1 ± {expected}; ν = {})", fit.degrees_of_freedom)]);
    }
    if let Some(validity) = result.validity.as_ref().filter(|_| fit.degrees_of_freedom > 0) {
        checks(&mut facts, validity, language);
    }
    facts.row(messages.rank, &[format!("{} / {}", seen.rank, seen.columns)]);
    html.push_str(&facts.into_html());
    if let Some(errors) = reading_errors(result) {
        residual_error(html, &errors, language);
    }
    html.push_str("</section>\n");
}

/// What the residuals say of the model and of the weights.
fn checks(facts: &mut Table, validity: &ValiditySummary, language: Language) {
    let messages = language.messages();
    let listed = |items: Vec<String>| if items.is_empty() { messages.none.to_owned() } else { items.join("; ") };
    facts.row(messages.chi_squared_chance, &[language.probability(validity.probability)]);
    let outlying = validity.outlying.iter().map(|p| format!("{}:{}", p.mounting, p.index + 1)).collect();
    facts.row(&capitalised(messages.outlying_plateaus), &[listed(outlying)]);
    let patterns = validity.patterns.iter().map(|pattern| messages.pattern(pattern, language)).collect();
    facts.row(&capitalised(messages.patterns_found), &[listed(patterns)]);
    if let Some(worst) = validity.mountings.iter().min_by(|a, b| a.probability.total_cmp(&b.probability)) {
        let chance = (validity.mountings.len() as f64 * worst.probability).min(1.0);
        let chi_squared = language.fixed(worst.chi_squared, 1);
        let (nu, p) = (worst.degrees_of_freedom, language.probability(chance));
        let shown = format!("{}: χ² = {chi_squared}; ν = {nu}; p = {p}", worst.mounting);
        facts.row(messages.worst_mounting, &[shown]);
    }
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

fn residual_error(html: &mut String, errors: &[ReadingError], language: Language) {
    let messages = language.messages();
    let _ = writeln!(html, "<h3>{}</h3>", messages.residual_error);
    let axes = [1, 2, 3].map(|axis| format!("{} {axis}", messages.axis));
    let mut table =
        Table::new("numbers").with_head(&[String::new(), axes[0].clone(), axes[1].clone(), axes[2].clone()]);
    for (name, cells) in error_table(errors, language) {
        table.row(name, &cells);
    }
    html.push_str(&table.into_html());
    let _ = writeln!(html, "<p class=\"note\">{}</p>", Escaped(messages.residual_error_note));
}

fn session(html: &mut String, result: &CalibrationResult, language: Language) {
    let (messages, model) = (language.messages(), &result.model);
    section(html, messages.session, |html| {
        let mut table = Table::new("facts");
        let acceleration = language.unit("m/s^2");
        table.row(messages.gravity, &[format!("{} {acceleration}", language.number(&model.gravity.to_string()))]);
        if let Some(latitude) = model.latitude {
            table.row(messages.latitude, &[format!("{}°", language.fixed(latitude.to_degrees(), 4))]);
        }
        table.row(messages.pair_relation, &[messages.word(&model.pair_relation).to_owned()]);
        table.row(messages.reference, &[messages.word(&model.reference).to_owned()]);
        table.row(messages.speed_uncertainty, &[language.scientific(model.speed_uncertainty)]);
        let mountings = result.plateaus.iter().map(|p| p.mounting).max().unwrap_or(0);
        let samples: u64 = result.plateaus.iter().map(|p| p.samples).sum();
        let rejected: u64 = result.plateaus.iter().map(|p| p.rejected).sum();
        table.row(
            messages.data,
            &[format!(
                "{}: {mountings}; {}: {}; {}: {samples}; {}: {rejected}",
                messages.mountings_used,
                messages.plateaus_used,
                result.plateaus.len(),
                messages.samples,
                messages.rejected
            )],
        );
        let fit = &result.fit;
        table.row(
            messages.method,
            &[format!("{} ({}, {})", messages.word(&fit.method), messages.word(&fit.termination), fit.iterations)],
        );
        table.row(messages.software, &[format!("{} {}", result.program.name, result.program.version)]);
        html.push_str(&table.into_html());
        if !result.session.text.is_empty() {
            paragraph(html, &result.session.text);
        }
    });
}

/// Drift and tilt, where records tell them.
fn steadiness_section(html: &mut String, result: &CalibrationResult, language: Language) {
    let messages = language.messages();
    let facts = facts(result, language);
    if facts.is_empty() {
        return;
    }
    section(html, messages.steadiness, |html| {
        let _ = writeln!(html, "<p class=\"note\">{}</p>", Escaped(messages.steadiness_note));
        let mut table = Table::new("facts");
        for (name, said) in facts {
            table.row(name, &[said]);
        }
        html.push_str(&table.into_html());
    });
}

fn parameter_tables(html: &mut String, result: &CalibrationResult, language: Language) {
    let messages = language.messages();
    section(html, messages.parameters, |html| {
        let _ = writeln!(html, "<p class=\"note\">{}</p>", Escaped(messages.parameters_note));
        let of_instrument = |name: &str| result.model.error_model.iter().any(|term| term.name == name);
        for (title, is_shown) in [(messages.instrument, true), (messages.mounting, false)] {
            let shown: Vec<_> = result.parameters.iter().filter(|p| of_instrument(&p.name) == is_shown).collect();
            let shown = by_group(&shown);
            if !shown.is_empty() {
                let _ = writeln!(html, "<h3>{title}</h3>");
                html.push_str(&parameters(result, &shown, language));
            }
        }
    });
}

fn budget_section(html: &mut String, result: &CalibrationResult, language: Language) {
    let messages = language.messages();
    section(html, messages.budget, |html| match budget(result, language) {
        Some(table) => {
            paragraph(html, messages.budget_note);
            if result.stated_sources().is_empty() {
                paragraph(html, messages.no_budget);
            }
            html.push_str(&table);
        }
        None => paragraph(html, messages.no_budget),
    });
}

fn null_directions(html: &mut String, result: &CalibrationResult, language: Language) {
    let directions = &result.observability.null_directions;
    if directions.is_empty() {
        return;
    }
    paragraph(html, &format!("{}:", language.messages().null_directions));
    let items = directions.iter().map(|d| format!("<li><code>{}</code></li>", Escaped(&combination(d))));
    let _ = writeln!(html, "<ul>{}</ul>", items.collect::<String>());
}

fn draw(html: &mut String, figure: &Figure, has_title: bool) {
    let _ = write!(html, "<figure id=\"{}\">", figure.name);
    if has_title && figure.drawings.len() > 1 {
        let _ = write!(html, "<h3>{}</h3>", Escaped(&figure.title));
    }
    let class = if figure.drawings.len() > 1 { "strips" } else { "one" };
    let _ = writeln!(html, "<div class=\"{class}\">{}</div>", figure.drawings.concat());
    let _ = writeln!(html, "<figcaption>{}</figcaption></figure>", Escaped(&figure.caption));
}

fn inputs(html: &mut String, result: &CalibrationResult, language: Language) {
    let messages = language.messages();
    section(html, messages.inputs, |html| {
        paragraph(html, messages.inputs_note);
        let mut table = Table::new("hashes").with_head(&[messages.file.to_owned(), "SHA-256".to_owned()]);
        for input in &result.inputs {
            table.row(&input.path, std::slice::from_ref(&input.sha256));
        }
        html.push_str(&table.into_html());
    });
}
