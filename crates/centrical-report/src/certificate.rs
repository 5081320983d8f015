//! The calibration certificate on paper: the items of ISO/IEC 17025:2017, 7.8.2 and 7.8.4, in their order.

use centrical_session::{Address, CalibrationResult, Condition, Contact, Decision, DecisionRule, Laboratory};

use crate::conformity::conformity;
use crate::customary::customary;
use crate::equation::equations;
use crate::expanded::expanded;
use crate::groups::by_group;
use crate::language::Language;
use crate::pdf::{Align, Column, Furniture, Layout, write};
use crate::reading_error::{error_table, reading_errors};
use crate::steadiness::facts;
use crate::verdict::objections;

/// The certificate as the bytes of a PDF file, with the results `before` an adjustment beside those after it if the
/// unit was adjusted. The same data give the same bytes.
pub fn pdf_certificate(
    result: &CalibrationResult,
    before: Option<&CalibrationResult>,
    laboratory: &Laboratory,
    language: Language,
) -> Vec<u8> {
    let messages = language.messages();
    let mut layout = Layout::new();
    layout.title(messages.certificate);
    warning(&mut layout, result, language);
    parties(&mut layout, laboratory, language);
    item(&mut layout, result, laboratory, language);
    dates(&mut layout, laboratory, language);
    method(&mut layout, result, laboratory, language);
    conditions(&mut layout, result, laboratory, language);
    steadiness(&mut layout, result, language);
    traceability(&mut layout, laboratory, language);
    results(&mut layout, result, language);
    adjustment(&mut layout, result, before, laboratory, language);
    if let Some(decision) = &laboratory.decision {
        conformity_statement(&mut layout, result, decision, language);
    }
    authorisation(&mut layout, laboratory, language);
    let number = format!("{} {}", messages.certificate_number, laboratory.certificate.number);
    let furniture = Furniture {
        title: &format!("{} {}", messages.certificate, laboratory.certificate.number),
        language: language.code(),
        head: (&laboratory.laboratory.name, &number),
        foot: messages.item_only,
        page_of: &|page, count| format!("{} {page} {} {count}", messages.page, messages.of),
    };
    write(layout, &furniture)
}

/// What speaks against the result, before anything else.
fn warning(layout: &mut Layout, result: &CalibrationResult, language: Language) {
    let (messages, objections) = (language.messages(), objections(result));
    if !objections.is_empty() {
        layout.heading(messages.not_acceptable, 40.0);
        layout.paragraph(messages.verdict_bad);
        for objection in &objections {
            layout.paragraph(&format!("– {}", messages.objection(objection, language)));
        }
    }
}

/// 7.8.2.1 a, b, d, e.
fn parties(layout: &mut Layout, laboratory: &Laboratory, language: Language) {
    let messages = language.messages();
    let of = &laboratory.laboratory;
    let accreditation = of.accreditation.as_ref().map(|number| format!("{}: {number}", messages.accreditation));
    layout.facts(&[(messages.certificate_number, laboratory.certificate.number.clone())]);
    layout.facts(&[
        (messages.laboratory, of.name.clone()),
        ("", address(&of.address, &of.contact)),
        ("", accreditation.unwrap_or_default()),
        (messages.customer, laboratory.customer.name.clone()),
        ("", address(&laboratory.customer.address, &laboratory.customer.contact)),
        (messages.replaces, laboratory.certificate.replaces.clone().unwrap_or_default()),
    ]);
}

fn address(address: &Address, contact: &Contact) -> String {
    let place = format!("{}, {} {}, {}", address.street, address.post_code, address.city, address.country);
    [Some(place), contact.phone.clone(), contact.email.clone()].into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// 7.8.2.1 g.
fn item(layout: &mut Layout, result: &CalibrationResult, laboratory: &Laboratory, language: Language) {
    let (messages, item, session) = (language.messages(), &laboratory.item, &result.session);
    let text = |value: &Option<String>| value.clone().unwrap_or_default();
    let serial = if session.unit_serial.is_empty() { messages.not_given } else { &session.unit_serial };
    layout.heading(messages.item, 40.0);
    layout.facts(&[
        (messages.description, text(&item.description)),
        (messages.model, session.unit_model.clone()),
        (messages.serial, serial.to_owned()),
        (messages.manufacturer, text(&item.manufacturer)),
        (messages.customer_number, text(&item.customer_number)),
        (messages.condition, text(&item.condition)),
    ]);
}

/// 7.8.2.1 c, h, i, j.
fn dates(layout: &mut Layout, laboratory: &Laboratory, language: Language) {
    let (messages, certificate) = (language.messages(), &laboratory.certificate);
    let place = certificate.place.clone().unwrap_or_else(|| messages.own_premises.to_owned());
    let calibrated = if certificate.begun == certificate.ended {
        language.date(certificate.begun)
    } else {
        format!("{} – {}", language.date(certificate.begun), language.date(certificate.ended))
    };
    layout.heading(messages.date, 40.0);
    layout.facts(&[
        (messages.received, certificate.received.map(|date| language.date(date)).unwrap_or_default()),
        (messages.calibrated, calibrated),
        (messages.issued, language.date(certificate.issued)),
        (messages.place, place),
    ]);
}

/// 7.8.2.1 f, n.
fn method(layout: &mut Layout, result: &CalibrationResult, laboratory: &Laboratory, language: Language) {
    let (messages, method) = (language.messages(), &laboratory.method);
    layout.heading(messages.method, 60.0);
    layout.paragraph(messages.method_text);
    layout.facts(&[
        (messages.procedure, method.procedure.clone().unwrap_or_default()),
        (messages.deviations, method.deviations.clone().unwrap_or_else(|| messages.none.to_owned())),
        (messages.software, format!("{} {}", result.program.name, result.program.version)),
    ]);
}

/// 7.8.4.1 b.
fn conditions(layout: &mut Layout, result: &CalibrationResult, laboratory: &Laboratory, language: Language) {
    let (messages, environment) = (language.messages(), &laboratory.environment);
    let shown = |condition: Condition, unit: &str| {
        let [value, range] = [condition.value, condition.range].map(|value| language.number(&value.to_string()));
        format!("{value} ± {range} {unit}")
    };
    let pascal = match language {
        Language::English => "kPa",
        Language::Russian => "кПа",
    };
    let gravity = format!("{} {}", language.number(&result.model.gravity.to_string()), language.unit("m/s^2"));
    layout.heading(messages.conditions, 50.0);
    layout.facts(&[
        (messages.temperature, shown(environment.temperature, "°C")),
        (messages.humidity, environment.humidity.map(|c| shown(c, "%")).unwrap_or_default()),
        (messages.pressure, environment.pressure.map(|c| shown(c, pascal)).unwrap_or_default()),
        (messages.gravity, gravity),
        (messages.speed_uncertainty, language.scientific(result.model.speed_uncertainty)),
    ]);
}

/// What was observed during the calibration, where records show it; also 7.8.2.1 n, samples that were left out.
fn steadiness(layout: &mut Layout, result: &CalibrationResult, language: Language) {
    let messages = language.messages();
    let facts = facts(result, language);
    if !facts.is_empty() {
        layout.heading(messages.steadiness, 130.0);
        layout.paragraph(messages.steadiness_note);
        layout.facts(&facts);
    }
}

/// 7.8.4.1 c.
fn traceability(layout: &mut Layout, laboratory: &Laboratory, language: Language) {
    let messages = language.messages();
    layout.heading(messages.traceability, 60.0 + 40.0 * laboratory.standard.len().min(4) as f32);
    layout.paragraph(messages.traceability_text);
    let columns = [0.27, 0.18, 0.27, 0.28].map(|share| Column { share, align: Align::Left });
    let rows: Vec<Vec<String>> = laboratory
        .standard
        .iter()
        .map(|s| vec![s.name.clone(), s.identification.clone(), s.certificate.clone(), s.traceable_to.clone()])
        .collect();
    let head = [messages.standard, messages.number_sign, messages.standard_certificate, messages.traceable_to];
    layout.table(&columns, &head, &rows);
}

/// 7.8.2.1 m and 7.8.4.1 a.
fn results(layout: &mut Layout, result: &CalibrationResult, language: Language) {
    let messages = language.messages();
    layout.heading(messages.results, 80.0);
    layout.paragraph(messages.results_model);
    for equation in equations(result) {
        layout.paragraph(&equation);
    }
    let terms: Vec<_> = result.model.error_model.iter().filter_map(|term| result.parameter(&term.name)).collect();
    let rows: Vec<Vec<String>> = by_group(&terms)
        .into_iter()
        .map(|parameter| {
            let (factor, unit) = customary(&parameter.unit, &parameter.group);
            let [shown, si] = match (parameter.value, expanded(result, parameter)) {
                (Some(value), Some(expanded)) => {
                    let expanded = expanded.uncertainty;
                    let shown = language.plus_minus(value * factor, expanded * factor);
                    [shown, language.plus_minus_scientific(value, expanded)]
                }
                _ => [messages.not_determined.to_owned(), String::new()],
            };
            let group = messages.word(&parameter.group).to_owned();
            vec![parameter.name.clone(), group, shown, language.unit(unit), si, language.unit(&parameter.unit)]
        })
        .collect();
    let aligned = [
        (0.08, Align::Left),
        (0.25, Align::Left),
        (0.23, Align::Right),
        (0.09, Align::Left),
        (0.26, Align::Right),
        (0.09, Align::Left),
    ];
    let columns = aligned.map(|(share, align)| Column { share, align });
    layout.table(&columns, &["", "", messages.value, "", messages.value_si, ""], &rows);
    layout.paragraph(messages.uncertainty_statement);
    layout.paragraph(messages.covariance_note);
}

/// 7.8.4.1 d.
fn adjustment(
    layout: &mut Layout,
    result: &CalibrationResult,
    before: Option<&CalibrationResult>,
    laboratory: &Laboratory,
    language: Language,
) {
    let messages = language.messages();
    layout.heading(messages.adjustment, 90.0);
    layout.paragraph(laboratory.item.adjustment.as_deref().unwrap_or(messages.no_adjustment));
    if let Some(before) = before {
        results_before(layout, result, before, language);
    }
    let Some(errors) = reading_errors(result) else { return };
    if laboratory.item.adjustment.is_none() {
        layout.paragraph(messages.errors_of_readings);
    }
    let rows = error_table(&errors, language)
        .map(|(name, cells)| std::iter::once(name.to_owned()).chain(cells).collect::<Vec<String>>());
    let axes = [1, 2, 3].map(|axis| format!("{} {axis}", messages.axis));
    let columns = [(0.34, Align::Left), (0.22, Align::Right), (0.22, Align::Right), (0.22, Align::Right)]
        .map(|(share, align)| Column { share, align });
    layout.table(&columns, &["", &axes[0], &axes[1], &axes[2]], &rows);
    layout.paragraph(messages.residual_error_note);
}

/// The parameters of the instrument before its adjustment and after.
fn results_before(layout: &mut Layout, result: &CalibrationResult, before: &CalibrationResult, language: Language) {
    let messages = language.messages();
    let terms: Vec<_> = result.model.error_model.iter().filter_map(|term| result.parameter(&term.name)).collect();
    let shown = |result: &CalibrationResult, name: &str, factor: f64| {
        let estimate = result.parameter(name).and_then(|p| Some((p.value?, expanded(result, p)?.uncertainty)));
        let known = |(value, expanded)| language.plus_minus(value * factor, expanded * factor);
        estimate.map_or_else(|| messages.not_determined.to_owned(), known)
    };
    let rows: Vec<Vec<String>> = by_group(&terms)
        .into_iter()
        .map(|after| {
            let (factor, unit) = customary(&after.unit, &after.group);
            let [was, is] = [before, result].map(|result| shown(result, &after.name, factor));
            vec![after.name.clone(), was, is, language.unit(unit)]
        })
        .collect();
    let columns = [(0.16, Align::Left), (0.34, Align::Right), (0.34, Align::Right), (0.16, Align::Left)]
        .map(|(share, align)| Column { share, align });
    let head = [messages.parameter, messages.before_adjustment, messages.after_adjustment, messages.unit];
    layout.table(&columns, &head, &rows);
}

/// 7.8.4.1 e and 7.8.6.
fn conformity_statement(layout: &mut Layout, result: &CalibrationResult, decision: &Decision, language: Language) {
    let messages = language.messages();
    let rule = match decision.rule {
        DecisionRule::Simple => messages.rule_simple,
        DecisionRule::Guarded => messages.rule_guarded,
    };
    layout.heading(messages.conformity, 90.0);
    layout
        .facts(&[(messages.specification, decision.specification.clone()), (messages.decision_rule, rule.to_owned())]);
    let rows: Vec<Vec<String>> = conformity(result, decision)
        .into_iter()
        .map(|judged| {
            let limit = judged.limit;
            let parameter = result.parameter(&limit.parameter);
            let (factor, unit) = parameter.map_or((1.0, ""), |p| customary(&p.unit, &p.group));
            let [low, high] = [limit.low, limit.high].map(|end| language.significant(end * factor, 4));
            let value = judged.value.map_or_else(
                || messages.not_determined.to_owned(),
                |(value, expanded)| language.plus_minus(value * factor, expanded * factor),
            );
            let verdict = match judged.conforms {
                Some(true) => messages.conforms,
                Some(false) => messages.does_not_conform,
                None => messages.conformity_not_stated,
            };
            let range = format!("{low} … {high}");
            vec![limit.parameter.clone(), range, value, language.unit(unit), verdict.to_owned()]
        })
        .collect();
    let columns =
        [(0.16, Align::Left), (0.24, Align::Right), (0.26, Align::Right), (0.12, Align::Left), (0.22, Align::Left)]
            .map(|(share, align)| Column { share, align });
    let head = [messages.parameter, messages.limits, messages.value, messages.unit, ""];
    layout.table(&columns, &head, &rows);
}

/// 7.8.2.1 d, l, o.
fn authorisation(layout: &mut Layout, laboratory: &Laboratory, language: Language) {
    let messages = language.messages();
    layout.heading(messages.authorised, 120.0);
    if let Some(person) = laboratory.authorised_by() {
        layout.signature(&person.name, &person.role, messages.signature);
    }
    let others = laboratory.person.iter().filter(|person| !person.authorises);
    let others = others.map(|person| format!("{}, {}", person.name, person.role)).collect::<Vec<_>>().join("; ");
    layout.facts(&[(messages.responsible, others)]);
    layout.paragraph(messages.item_only);
    layout.paragraph(messages.reproduction);
    layout.paragraph(&format!("— {} —", messages.end));
}
