//! Administrative data: software, dates, item, laboratory, persons, customer, statements.

use centrical_session::{Address, CalibrationResult, Contact, Laboratory};

use super::xml::Xml;
use crate::document::{
    Issuer, condition_of_conformity, drift_facts, judged_in_words, objection, presuppositions, rule, serial,
    switch_on_sentence, uncertainty_holds,
};
use crate::evaluation::{UnitStatement, UnitVerdict};
use crate::language::Language;

pub(super) fn data(xml: &mut Xml, result: &CalibrationResult, issuer: &Issuer, language: Language) {
    let laboratory = &issuer.laboratory;
    xml.element("dcc:administrativeData", |xml| {
        xml.element("dcc:dccSoftware", |xml| software(xml, result, language));
        core_data(xml, laboratory, language);
        items(xml, result, laboratory, language);
        xml.element("dcc:calibrationLaboratory", |xml| {
            xml.optional("dcc:calibrationLaboratoryCode", laboratory.laboratory.accreditation.as_deref());
            let of = &laboratory.laboratory;
            contact(xml, "dcc:contact", (&of.name, &of.address, &of.contact), language);
        });
        persons(xml, laboratory, language);
        let of = &laboratory.customer;
        contact(xml, "dcc:customer", (&of.name, &of.address, &of.contact), language);
        statements(xml, result, issuer, language);
    });
}

/// The program that made result and certificate.
pub(super) fn software(xml: &mut Xml, result: &CalibrationResult, language: Language) {
    xml.element("dcc:software", |xml| {
        xml.content("dcc:name", &result.program.name, language);
        xml.leaf("dcc:release", &result.program.version);
    });
}

fn core_data(xml: &mut Xml, laboratory: &Laboratory, language: Language) {
    let certificate = &laboratory.certificate;
    xml.element("dcc:coreData", |xml| {
        xml.leaf("dcc:countryCodeISO3166_1", &laboratory.laboratory.address.country);
        xml.leaf("dcc:usedLangCodeISO639_1", language.code());
        xml.leaf("dcc:mandatoryLangCodeISO639_1", language.code());
        xml.leaf("dcc:uniqueIdentifier", &certificate.number);
        xml.optional("dcc:receiptDate", certificate.received.map(|date| date.to_string()).as_deref());
        xml.leaf("dcc:beginPerformanceDate", &certificate.begun.to_string());
        xml.leaf("dcc:endPerformanceDate", &certificate.ended.to_string());
        xml.leaf("dcc:performanceLocation", if certificate.place.is_none() { "laboratory" } else { "other" });
        xml.leaf("dcc:issueDate", &certificate.issued.to_string());
        if let Some(replaced) = &certificate.replaces {
            xml.element("dcc:reportAmendedSubstituted", |xml| {
                xml.leaf("dcc:typeOfChange", "substituted");
                xml.leaf("dcc:replacedUniqueIdentifier", replaced);
            });
        }
    });
}

fn items(xml: &mut Xml, result: &CalibrationResult, laboratory: &Laboratory, language: Language) {
    let (messages, item, session) = (language.messages(), &laboratory.item, &result.session);
    let name = item.description.as_deref().unwrap_or(&session.unit_model);
    let mut identifications = vec![("manufacturer", serial(session, language))];
    identifications.extend(item.customer_number.as_deref().map(|number| ("customer", number)));
    xml.element("dcc:items", |xml| {
        xml.element("dcc:item", |xml| {
            xml.content("dcc:name", name, language);
            if let Some(condition) = &item.condition {
                xml.content("dcc:description", &format!("{}: {condition}", messages.condition), language);
            }
            if let Some(manufacturer) = &item.manufacturer {
                xml.element("dcc:manufacturer", |xml| xml.content("dcc:name", manufacturer, language));
            }
            xml.optional("dcc:model", Some(&session.unit_model));
            xml.element("dcc:identifications", |xml| {
                for (issuer, value) in identifications {
                    identification(xml, issuer, value);
                }
            });
        });
    });
}

/// A number and who gave it.
pub(super) fn identification(xml: &mut Xml, issuer: &str, value: &str) {
    xml.element("dcc:identification", |xml| {
        xml.leaf("dcc:issuer", issuer);
        xml.leaf("dcc:value", value);
    });
}

fn contact(xml: &mut Xml, element: &str, (name, address, how): (&str, &Address, &Contact), language: Language) {
    xml.element(element, |xml| {
        xml.content("dcc:name", name, language);
        xml.optional("dcc:eMail", how.email.as_deref());
        xml.optional("dcc:phone", how.phone.as_deref());
        xml.element("dcc:location", |xml| {
            xml.leaf("dcc:countryCode", &address.country);
            xml.optional("dcc:city", Some(&address.city));
            xml.optional("dcc:postCode", Some(&address.post_code));
            xml.optional("dcc:street", Some(&address.street));
        });
    });
}

fn persons(xml: &mut Xml, laboratory: &Laboratory, language: Language) {
    xml.element("dcc:respPersons", |xml| {
        for person in &laboratory.person {
            xml.element("dcc:respPerson", |xml| {
                xml.element("dcc:person", |xml| xml.content("dcc:name", &person.name, language));
                xml.optional("dcc:role", Some(&person.role));
                xml.leaf("dcc:mainSigner", if person.authorises { "true" } else { "false" });
            });
        }
    });
}

fn statements(xml: &mut Xml, result: &CalibrationResult, issuer: &Issuer, language: Language) {
    let messages = language.messages();
    xml.element("dcc:statements", |xml| {
        let statement = |xml: &mut Xml, reference: &str, text: &str| {
            xml.element("dcc:statement", |xml| {
                xml.leaf("dcc:norm", "ISO/IEC 17025:2017");
                xml.leaf("dcc:reference", reference);
                xml.content("dcc:declaration", text, language);
            });
        };
        for reason in result.objections() {
            let text = format!("{}: {}", messages.not_acceptable, objection(&reason, language));
            statement(xml, "7.8.2.1 m", &text);
        }
        statement(xml, "7.8.2.1 l", messages.item_only);
        statement(xml, "7.8.2.1", messages.reproduction);
        statement(xml, "7.8.4.1 c", messages.traceability_text);
        if let Some(unit) = &issuer.unit {
            xml.kind("dcc:statement", "basic_conformity", |xml| {
                xml.leaf("dcc:norm", &unit.specification);
                xml.content("dcc:declaration", &declaration(result, unit, language), language);
                match unit.verdict() {
                    UnitVerdict::Within => xml.leaf("dcc:conformity", "pass"),
                    UnitVerdict::Outside => xml.leaf("dcc:conformity", "fail"),
                    UnitVerdict::InGuardBand => xml.leaf("dcc:conformity", "noPass"),
                    UnitVerdict::NotStated => {}
                }
            });
        }
        statement(xml, "7.8.4.1 a", &uncertainty_holds(result, language));
        statement(xml, "7.8.4.1 a", &presuppositions(result, language));
        for (name, text) in drift_facts(result, language) {
            statement(xml, "7.8.2.1 m", &format!("{name}: {text}"));
        }
        let adjustment = issuer.laboratory.item.adjustment.as_deref();
        statement(xml, "7.8.4.1 d", adjustment.unwrap_or(messages.no_adjustment));
        if let Some(text) = issuer.past.as_ref().and_then(|past| switch_on_sentence(past, language)) {
            statement(xml, "7.8.4.1 a", &text);
        }
    });
}

/// The rule, the limits judged with their values (7.8.6.2 a), and the condition on which the statement holds.
fn declaration(result: &CalibrationResult, unit: &UnitStatement, language: Language) -> String {
    let messages = language.messages();
    let judged: Vec<String> = unit.judged.iter().map(|judged| judged_in_words(judged, language)).collect();
    let condition = condition_of_conformity(result, language).map(|condition| format!(" {condition}"));
    let rule = rule(unit.rule, language);
    format!("{}: {rule}. {}.{}", messages.decision_rule, judged.join(". "), condition.unwrap_or_default())
}
