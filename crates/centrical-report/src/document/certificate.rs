//! The calibration certificate on paper: the items of ISO/IEC 17025:2017, 7.8.2 and 7.8.4, in their order.

use std::f64::consts::PI;
use std::path::PathBuf;

use centrical::STANDARD_GRAVITY;
use centrical_session::{
    Address, CalibrationResult, Condition, Contact, Date, Laboratory, ModelSummary, PositionSummary, UnitHistoryReport,
    customary,
};

use super::axes::axes;
use super::conformity::{conformity_table, rule};
use super::content::{Align, Block, Document, Margins, Opening, Picture, Section, Table};
use super::drift::drift;
use super::objection::{objection, refusal};
use super::reading_error::{error_note, error_table};
use super::rests_on::{condition_of_conformity, presuppositions, uncertainty_holds};
use super::switch_on::switch_on;
use super::tables::{by_group, nominal_output, of_arm, rows_by_group, serial};
use crate::evaluation::{UnitStatement, equations, expanded, symbol};
use crate::language::Language;

/// Who issues a certificate, and what they say of the unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Issuer {
    /// The laboratory's file.
    pub file: PathBuf,
    /// What it says.
    pub laboratory: Laboratory,
    /// What its decision says of the unit, where one was asked for.
    pub unit: Option<UnitStatement>,
    /// What its earlier calibrations say of it, where they were given.
    pub past: Option<UnitHistoryReport>,
    /// Its mark.
    pub logo: Option<Picture>,
}

impl Issuer {
    /// In words, that the file has the calibration on other days than that of the session, most often because it is of another certificate; or
    /// that the session's date is invalid and cannot be compared.
    pub fn other_days(&self, result: &CalibrationResult) -> Option<String> {
        let (begun, ended) = (self.laboratory.certificate.begun, self.laboratory.certificate.ended);
        let days = format!("found [certificate] begun = {begun} and ended = {ended}");
        match result.session.date.parse::<Date>() {
            Ok(day) if day < begun || day > ended => {
                Some(format!("{days}, expected the day of the session between them, {day}"))
            }
            Err(expected) if !result.session.date.is_empty() => {
                Some(format!("{days} beside a session whose date is invalid, {expected}"))
            }
            _ => None,
        }
    }
}

/// The certificate, with the results `before` an adjustment beside those after it if the unit was adjusted.
pub fn certificate(
    result: &CalibrationResult,
    before: Option<&CalibrationResult>,
    issuer: &Issuer,
    language: Language,
) -> Document {
    let laboratory = &issuer.laboratory;
    let (messages, number) = (language.messages(), &laboratory.certificate.number);
    let sections = [
        warning(result, language),
        parties(laboratory, language),
        item(result, laboratory, language),
        dates(laboratory, language),
        method(result, laboratory, language),
        conditions(result, laboratory, language),
        // What was observed during the calibration; also 7.8.2.1 n, samples that were left out.
        drift(result, Block::Paragraph, 13, language),
        traceability(laboratory, language),
        results(result, language),
        axes(result, language),
        adjustment(result, before, laboratory, language),
        issuer.past.as_ref().map(|past| switch_on(past, language)).unwrap_or_default(),
        issuer.unit.as_ref().map(|unit| conformity_statement(result, unit, language)).unwrap_or_default(),
        authorisation(laboratory, language),
    ];
    Document {
        language,
        title: format!("{} {number}", messages.certificate),
        opening: Opening {
            kind: String::new(),
            title: messages.certificate.to_owned(),
            lines: Vec::new(),
            date: String::new(),
            picture: issuer.logo.clone(),
        },
        contents: String::new(),
        sections: sections.into_iter().filter(|blocks| !blocks.is_empty()).map(Section::plain).collect(),
        margins: Margins {
            head: [laboratory.laboratory.name.clone(), format!("{} {number}", messages.certificate_number)],
            foot: messages.item_only.to_owned(),
            page: [messages.page, messages.of],
        },
        attachment: None,
    }
}

/// The objections to the result, before anything else.
fn warning(result: &CalibrationResult, language: Language) -> Vec<Block> {
    let objections = result.objections();
    if objections.is_empty() { Vec::new() } else { refusal(&objections, language) }
}

/// 7.8.2.1 a, b, d, e.
fn parties(laboratory: &Laboratory, language: Language) -> Vec<Block> {
    let messages = language.messages();
    let of = &laboratory.laboratory;
    let accreditation = of.accreditation.as_ref().map(|number| format!("{}: {number}", messages.accreditation));
    vec![
        Block::facts([(messages.certificate_number, laboratory.certificate.number.clone())]),
        Block::facts([
            (messages.laboratory, of.name.clone()),
            ("", address(&of.address, &of.contact)),
            ("", accreditation.unwrap_or_default()),
            (messages.customer, laboratory.customer.name.clone()),
            ("", address(&laboratory.customer.address, &laboratory.customer.contact)),
            (messages.replaces, laboratory.certificate.replaces.clone().unwrap_or_default()),
        ]),
    ]
}

fn address(address: &Address, contact: &Contact) -> String {
    let place = format!("{}, {} {}, {}", address.street, address.post_code, address.city, address.country);
    [Some(place), contact.phone.clone(), contact.email.clone()].into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// 7.8.2.1 g.
fn item(result: &CalibrationResult, laboratory: &Laboratory, language: Language) -> Vec<Block> {
    let (messages, item, session) = (language.messages(), &laboratory.item, &result.session);
    let text = |value: &Option<String>| value.clone().unwrap_or_default();
    let facts = Block::facts([
        (messages.description, text(&item.description)),
        (messages.model, session.unit_model.clone()),
        (messages.serial, serial(session, language).to_owned()),
        (messages.manufacturer, text(&item.manufacturer)),
        (messages.customer_number, text(&item.customer_number)),
        (messages.condition, text(&item.condition)),
    ]);
    vec![Block::heading(messages.item, 4), facts]
}

/// 7.8.2.1 c, h, i, j.
fn dates(laboratory: &Laboratory, language: Language) -> Vec<Block> {
    let (messages, certificate) = (language.messages(), &laboratory.certificate);
    let place = certificate.place.clone().unwrap_or_else(|| messages.own_premises.to_owned());
    let calibrated = if certificate.begun == certificate.ended {
        language.date(certificate.begun)
    } else {
        format!("{} – {}", language.date(certificate.begun), language.date(certificate.ended))
    };
    let facts = Block::facts([
        (messages.received, certificate.received.map(|date| language.date(date)).unwrap_or_default()),
        (messages.calibrated, calibrated),
        (messages.issued, language.date(certificate.issued)),
        (messages.place, place),
    ]);
    vec![Block::heading(messages.date, 4), facts]
}

/// What was done: on the arm, at rest in attitudes of its own, or both.
pub(crate) fn method_text(model: &ModelSummary, language: Language) -> String {
    let messages = language.messages();
    let rests: Vec<&PositionSummary> = model.positions.iter().filter(|position| position.is_free).collect();
    if rests.is_empty() {
        return messages.method_on_arm.to_owned();
    }
    let way = if model.has_arm() {
        format!("{} {}", messages.method_on_arm, messages.method_with_rests)
    } else {
        messages.method_of_rests.to_owned()
    };
    let known: Vec<f64> = rests.iter().filter_map(|rest| rest.attitude_uncertainty).collect();
    let uncertainty = known.iter().copied().fold(0.0, f64::max);
    let uncertainty = format!("{} {}", language.scientific(uncertainty), language.unit("rad"));
    format!("{way} {}", (messages.words.known_attitudes)(known.len(), rests.len(), &uncertainty))
}

/// 7.8.2.1 f, n.
fn method(result: &CalibrationResult, laboratory: &Laboratory, language: Language) -> Vec<Block> {
    let (messages, method) = (language.messages(), &laboratory.method);
    let facts = Block::facts([
        (messages.procedure, method.procedure.clone().unwrap_or_default()),
        (messages.deviations, method.deviations.clone().unwrap_or_else(|| messages.none.to_owned())),
        (messages.software, format!("{} {}", result.program.name, result.program.version)),
        (messages.held_out_plateaus, result.held_out().join(", ")),
    ]);
    vec![Block::heading(messages.method, 6), Block::paragraph(&method_text(&result.model, language)), facts]
}

/// 7.8.4.1 b.
fn conditions(result: &CalibrationResult, laboratory: &Laboratory, language: Language) -> Vec<Block> {
    let (messages, environment) = (language.messages(), &laboratory.environment);
    let shown = |condition: Condition, unit: &str| {
        let [value, range] = [condition.value, condition.range].map(|value| language.number(&value.to_string()));
        format!("{value} ± {range} {unit}")
    };
    let gravity = format!("{} {}", language.number(&result.model.gravity.to_string()), language.unit("m/s^2"));
    let speed_uncertainty = of_arm(&result.model, language.scientific(result.model.speed_uncertainty));
    let facts = Block::facts([
        (messages.temperature, shown(environment.temperature, "°C")),
        (messages.humidity, environment.humidity.map(|c| shown(c, "%")).unwrap_or_default()),
        (messages.pressure, environment.pressure.map(|c| shown(c, &language.unit("kPa"))).unwrap_or_default()),
        (messages.unit_temperature, environment.unit_temperature.map(|c| shown(c, "°C")).unwrap_or_default()),
        (messages.gravity, gravity),
        (messages.speed_uncertainty, speed_uncertainty),
    ]);
    vec![Block::heading(messages.conditions, 5), facts, Block::facts(covered(result, language))]
}

/// What the calibration covers: specific force, speeds, radii, plateaus, latitude.
pub(crate) fn covered(result: &CalibrationResult, language: Language) -> [(&'static str, String); 5] {
    let messages = language.messages();
    let listed = |mut values: Vec<f64>, places: i32, unit: &str| {
        values.sort_by(f64::total_cmp);
        let steps = 10_f64.powi(places);
        let rounded = values.into_iter().map(|value| language.number(&((value * steps).round() / steps).to_string()));
        let mut shown: Vec<String> = rounded.collect();
        shown.dedup();
        let text = match &shown[..] {
            [first, .., last] if shown.len() > MOST_LISTED => format!("{first} … {last}"),
            all => all.join("; "),
        };
        format!("{text} {unit}")
    };
    let model = &result.model;
    let range = result.calibrated_range() / STANDARD_GRAVITY;
    let speeds = result.plateaus.iter().map(|plateau| plateau.set_speed.unwrap_or(plateau.speed).abs() * 30.0 / PI);
    let radii =
        result.mountings.iter().map(|mounting| mounting.arm[0].hypot(mounting.arm[1])).filter(|radius| *radius > 0.0);
    let latitude = model.latitude.map(|latitude| format!("{}°", language.fixed(latitude.to_degrees(), 4)));
    let force = format!("\u{b1}{} g", language.fixed(range, if range < 10.0 { 2 } else { 1 }));
    [
        (messages.force_covered, force),
        (messages.speeds_covered, of_arm(model, listed(speeds.collect(), 2, language.live().rpm))),
        (messages.radii_covered, of_arm(model, listed(radii.collect(), 4, &language.unit("m")))),
        (messages.plateaus_covered, (result.plateaus.len() - result.held_out().len()).to_string()),
        (messages.latitude, latitude.unwrap_or_default()),
    ]
}

/// As many speeds or radii are listed; of more there stand the least and the largest.
const MOST_LISTED: usize = 8;

/// 7.8.4.1 c.
fn traceability(laboratory: &Laboratory, language: Language) -> Vec<Block> {
    let messages = language.messages();
    let standards = &laboratory.standard;
    let rows = standards
        .iter()
        .map(|s| vec![s.name.clone(), s.identification.clone(), s.certificate.clone(), s.traceable_to.clone()]);
    let columns = [
        (messages.standard, 0.27, Align::Left),
        (messages.number_sign, 0.18, Align::Left),
        (messages.standard_certificate, 0.27, Align::Left),
        (messages.traceable_to, 0.28, Align::Left),
    ];
    // Four lines for each of the first standards.
    let lines = (1..=4).zip(standards).fold(6, |lines, _: (u8, _)| lines + 4);
    vec![
        Block::heading(messages.traceability, lines),
        Block::paragraph(messages.traceability_text),
        Block::Table(Table::numbers(columns, rows)),
    ]
}

/// 7.8.2.1 m and 7.8.4.1 a; EA-4/02, 6.3.
fn results(result: &CalibrationResult, language: Language) -> Vec<Block> {
    let messages = language.messages();
    let columns = [
        ("", 0.1, Align::Left),
        (messages.value, 0.25, Align::Right),
        ("", 0.1, Align::Left),
        (messages.coverage_and_degrees, 0.16, Align::Right),
        (messages.value_si, 0.29, Align::Right),
        ("", 0.1, Align::Left),
    ];
    let rows = rows_by_group(result, &by_group(result, true), language);
    let table = Table { rows, ..Table::numbers(columns, []) };
    let mut blocks = vec![Block::heading(messages.results, 14), Block::paragraph(messages.results_model)];
    blocks.extend(equations(result).map(Block::Paragraph));
    blocks.push(Block::paragraph(messages.axes_defined));
    blocks.push(Block::Table(table));
    blocks.push(Block::paragraph(messages.uncertainty_statement));
    blocks.push(Block::paragraph(&uncertainty_holds(result, language)));
    blocks.push(Block::paragraph(&presuppositions(result, language)));
    blocks.extend(nominal_output(result, language));
    blocks.push(Block::paragraph(messages.covariance_note));
    blocks
}

/// 7.8.4.1 d.
fn adjustment(
    result: &CalibrationResult,
    before: Option<&CalibrationResult>,
    laboratory: &Laboratory,
    language: Language,
) -> Vec<Block> {
    let (messages, adjustment) = (language.messages(), laboratory.item.adjustment.as_deref());
    let mut blocks =
        vec![Block::heading(messages.adjustment, 9), Block::paragraph(adjustment.unwrap_or(messages.no_adjustment))];
    if let Some(before) = before {
        blocks.push(Block::Paragraph(calibration_before(before, language)));
        blocks.push(Block::Table(results_before(result, before, language)));
    }
    if let Some(errors) = error_table(result, language) {
        if adjustment.is_none() && !result.model.nominal_found {
            blocks.push(Block::paragraph(messages.errors_of_readings));
        }
        blocks.push(Block::Table(errors));
        blocks.push(Block::paragraph(error_note(result, language)));
    }
    blocks
}

/// The day of the calibration before an adjustment, and the objections to it.
fn calibration_before(before: &CalibrationResult, language: Language) -> String {
    let messages = language.messages();
    let day = language.written_date(&before.session.date);
    let reasons: Vec<String> = before.objections().iter().map(|reason| objection(reason, language)).collect();
    let verdict = if reasons.is_empty() {
        String::new()
    } else {
        format!(". {}: {}", messages.not_acceptable, reasons.join("; "))
    };
    format!("{}: {day}{verdict}.", messages.calibrated_before_adjustment)
}

/// The parameters of the instrument before its adjustment and after.
fn results_before(result: &CalibrationResult, before: &CalibrationResult, language: Language) -> Table {
    let messages = language.messages();
    let shown = |result: &CalibrationResult, name: &str, factor: f64| {
        let estimate = result.parameter(name).and_then(|p| Some((p.value?, expanded(result, p)?.uncertainty)));
        let known = |(value, expanded)| language.plus_minus(value * factor, expanded * factor);
        estimate.map_or_else(|| messages.not_determined.to_owned(), known)
    };
    let rows = by_group(result, true).into_iter().map(|after| {
        let (factor, unit) = customary(&after.unit, after.group);
        let [was, is] = [before, result].map(|result| shown(result, &after.name, factor));
        vec![symbol(&after.name), was, is, language.unit(unit)]
    });
    let columns = [
        (messages.parameter, 0.16, Align::Left),
        (messages.before_adjustment, 0.34, Align::Right),
        (messages.after_adjustment, 0.34, Align::Right),
        (messages.unit, 0.16, Align::Left),
    ];
    Table::numbers(columns, rows)
}

/// 7.8.4.1 e and 7.8.6.
fn conformity_statement(result: &CalibrationResult, unit: &UnitStatement, language: Language) -> Vec<Block> {
    let messages = language.messages();
    let facts = [
        (messages.specification, unit.specification.clone()),
        (messages.decision_rule, rule(unit.rule, language).to_owned()),
    ];
    let table = Block::Table(conformity_table(unit, language));
    let condition = condition_of_conformity(result, language).map(Block::Paragraph);
    [Block::heading(messages.conformity, 9), Block::facts(facts), table].into_iter().chain(condition).collect()
}

/// 7.8.2.1 d, l, o.
fn authorisation(laboratory: &Laboratory, language: Language) -> Vec<Block> {
    let messages = language.messages();
    let signature = laboratory.authorised_by().map(|person| Block::Signature {
        name: person.name.clone(),
        role: person.role.clone(),
        word: messages.signature.to_owned(),
        date: messages.signed_on.to_owned(),
        mark: messages.mark_place.to_owned(),
    });
    let others = laboratory.person.iter().filter(|person| !person.authorises);
    let others = others.map(|person| format!("{}, {}", person.name, person.role)).collect::<Vec<_>>().join("; ");
    let end = [
        Block::facts([(messages.responsible, others)]),
        Block::paragraph(messages.item_only),
        Block::paragraph(messages.reproduction),
        Block::Paragraph(format!("— {} —", messages.end)),
    ];
    std::iter::once(Block::heading(messages.authorised, 16)).chain(signature).chain(end).collect()
}
