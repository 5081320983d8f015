//! `laboratory.toml`: what a certificate says beyond the calibration itself (ISO/IEC 17025, 7.8.2 and 7.8.4).

mod forms;
mod limit;

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Deserialize;

pub use self::forms::{
    Address, Certificate, Condition, Contact, Customer, Environment, Item, LaboratoryTable, MethodTable, Person,
    Standard,
};
pub use self::limit::{Limit, LimitEnd, Limitable, Limited, StatedLimit};
use crate::error::{Error, Place, quoted};
use crate::settings::{from_toml, read_settings};

/// The whole file.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Laboratory {
    /// Who calibrated.
    pub laboratory: LaboratoryTable,
    /// The customer.
    pub customer: Customer,
    /// The document: number, dates, place.
    pub certificate: Certificate,
    /// The unit, beyond model and serial number, which the session has.
    #[serde(default)]
    pub item: Item,
    /// The method, beyond what the program says of itself.
    #[serde(default)]
    pub method: MethodTable,
    /// Conditions during the calibration.
    pub environment: Environment,
    /// Standards used and the documents that make them traceable.
    pub standard: Vec<Standard>,
    /// Who did it and who authorises the certificate.
    pub person: Vec<Person>,
    /// Statement of conformity, where one was asked for.
    pub decision: Option<Decision>,
}

/// A statement of conformity.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Decision {
    /// The specification: document and clause.
    pub specification: String,
    /// How the uncertainty is taken into account.
    pub rule: DecisionRule,
    /// The limits.
    pub limit: Vec<Limit>,
}

/// How a statement of conformity takes the expanded uncertainty `U` into account (ILAC-G8).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum DecisionRule {
    /// Simple acceptance: the value lies within the limits.
    Simple,
    /// Guarded acceptance: the value lies within the limits by `U` or more.
    Guarded,
}

impl Laboratory {
    /// Reads the file.
    ///
    /// # Errors
    /// [`Error`] when it is not there, has an unknown or lacks a needed key, or when a value makes no sense.
    pub fn read(file: &Path) -> Result<Self, Error> {
        let text = read_settings(file, "a laboratory.toml")?;
        let laboratory: Self = from_toml(file, &text)?;
        laboratory.check(file)?;
        Ok(laboratory)
    }

    /// The limits of the decision, each of one of `parameters` or of one axis of the compensated reading. `file` is the laboratory's.
    ///
    /// # Errors
    /// [`Error`] with the limit that names no such parameter or group, or is not a quantity of it.
    pub fn limits(&self, file: &Path, parameters: &[Limitable]) -> Result<Vec<StatedLimit>, Error> {
        let limits = self.decision.iter().flat_map(|decision| &decision.limit);
        let stated: Result<Vec<_>, _> =
            limits.enumerate().map(|(n, limit)| limit.stated(file, n, parameters)).collect();
        Ok(stated?.concat())
    }

    /// The picture that stands on a certificate; its path is that from the folder of `file`, the laboratory's.
    pub fn logo(&self, file: &Path) -> Option<PathBuf> {
        let folder = file.parent().unwrap_or(Path::new(""));
        self.laboratory.logo.as_ref().map(|logo| folder.join(logo))
    }

    /// The texts that stand on a certificate: table, key, text.
    pub fn texts<'a>(&'a self) -> Vec<(String, &'static str, &'a str)> {
        let Self { laboratory, customer, certificate, item, method, standard, person, decision, .. } = self;
        let mut texts = Vec::new();
        let mut add = |table: &str, entries: &[(&'static str, Option<&'a String>)]| {
            let stated =
                entries.iter().filter_map(|(key, text)| Some((table.to_owned(), *key, text.as_ref()?.as_str())));
            texts.extend(stated);
        };
        let parties = [
            ("[laboratory]", &laboratory.name, &laboratory.address, &laboratory.contact),
            ("[customer]", &customer.name, &customer.address, &customer.contact),
        ];
        for (table, name, address, contact) in parties {
            add(
                table,
                &[
                    ("name", Some(name)),
                    ("address.street", Some(&address.street)),
                    ("address.city", Some(&address.city)),
                    ("address.post_code", Some(&address.post_code)),
                    ("contact.phone", contact.phone.as_ref()),
                    ("contact.email", contact.email.as_ref()),
                ],
            );
        }
        add("[laboratory]", &[("accreditation", laboratory.accreditation.as_ref())]);
        add(
            "[certificate]",
            &[
                ("number", Some(&certificate.number)),
                ("place", certificate.place.as_ref()),
                ("replaces", certificate.replaces.as_ref()),
            ],
        );
        add(
            "[item]",
            &[
                ("manufacturer", item.manufacturer.as_ref()),
                ("description", item.description.as_ref()),
                ("condition", item.condition.as_ref()),
                ("customer_number", item.customer_number.as_ref()),
                ("adjustment", item.adjustment.as_ref()),
            ],
        );
        add("[method]", &[("procedure", method.procedure.as_ref()), ("deviations", method.deviations.as_ref())]);
        for (n, of) in (1..).zip(standard) {
            add(
                &format!("[[standard]] {n}"),
                &[
                    ("name", Some(&of.name)),
                    ("identification", Some(&of.identification)),
                    ("certificate", Some(&of.certificate)),
                    ("traceable_to", Some(&of.traceable_to)),
                ],
            );
        }
        for (n, of) in (1..).zip(person) {
            add(&format!("[[person]] {n}"), &[("name", Some(&of.name)), ("role", Some(&of.role))]);
        }
        add("[decision]", &[("specification", decision.as_ref().map(|decision| &decision.specification))]);
        texts
    }

    fn check(&self, file: &Path) -> Result<(), Error> {
        let refuse = |table: &str, key: &str, found: String, expected: &str| {
            let place = Place::Key { table: table.to_owned(), key: key.to_owned() };
            Err(Error::content(file, place, found, expected))
        };
        let must_be_filled = |key| ["name", "number", "specification"].contains(&key);
        let mut texts = self.texts().into_iter();
        if let Some((table, key, _)) = texts.find(|(_, key, text)| must_be_filled(*key) && text.trim().is_empty()) {
            return refuse(&table, key, "an empty text".to_owned(), "a text");
        }
        for (table, address) in [("[laboratory]", &self.laboratory.address), ("[customer]", &self.customer.address)] {
            let country = &address.country;
            if country.len() != 2 || !country.bytes().all(|b| b.is_ascii_uppercase()) {
                let expected = "two capital letters of ISO 3166-1, such as \"DE\"";
                return refuse(table, "address.country", quoted(country.as_bytes()), expected);
            }
        }
        let Certificate { begun, ended, issued, received, ref number, ref replaces, .. } = self.certificate;
        if let Some(received) = received.filter(|received| *received > begun) {
            return refuse("[certificate]", "received", received.to_string(), &format!("{begun} (begun) or earlier"));
        }
        if replaces.as_ref() == Some(number) {
            return refuse("[certificate]", "replaces", quoted(number.as_bytes()), "the number of another certificate");
        }
        if ended < begun {
            return refuse("[certificate]", "ended", ended.to_string(), &format!("{begun} (begun) or later"));
        }
        if issued < ended {
            return refuse("[certificate]", "issued", issued.to_string(), &format!("{ended} (ended) or later"));
        }
        if !self.person.iter().any(|person| person.authorises) {
            return refuse("[[person]]", "authorises", "nobody".to_owned(), "one person with authorises = true");
        }
        if let Some((key, found, expected)) = self.environment.impossible() {
            return refuse("[environment]", key, found, &expected);
        }
        let limits = self.decision.iter().flat_map(|decision| &decision.limit);
        limits.enumerate().try_for_each(|(n, limit)| limit.check(file, n))
    }

    /// The person who authorises the certificate.
    pub fn authorised_by(&self) -> Option<&Person> {
        self.person.iter().find(|person| person.authorises)
    }
}

impl Environment {
    /// A condition that no laboratory has, by its value or as far as it went from it: its key, what was found and what was expected.
    fn impossible(&self) -> Option<(&'static str, String, String)> {
        let conditions = [
            ("temperature", Some(&self.temperature), (-50.0, 100.0), "degrees Celsius from -50 to 100"),
            ("humidity", self.humidity.as_ref(), (1.0, 100.0), "% of relative humidity from 1 to 100"),
            ("pressure", self.pressure.as_ref(), (30.0, 120.0), "kPa from 30 to 120"),
            ("unit_temperature", self.unit_temperature.as_ref(), (-100.0, 200.0), "degrees Celsius from -100 to 200"),
        ];
        for (key, condition, (low, high), meaning) in conditions {
            let Some(Condition { value, range }) = condition else { continue };
            let can_be = value.is_finite() && *range >= 0.0 && value - range >= low && value + range <= high;
            if !can_be {
                let expected = format!("a value with a range of zero or more around it, {meaning}");
                return Some((key, format!("value {value}, range {range}"), expected));
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::Laboratory;

    const EXAMPLE: &str = include_str!("../../../examples/ta-200/laboratory.toml");

    fn read(text: &str) -> Result<Laboratory, String> {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        file.write_all(text.as_bytes()).unwrap();
        Laboratory::read(file.path()).map_err(|error| error.to_string())
    }

    #[test]
    fn the_example_is_read() {
        let laboratory = read(EXAMPLE).unwrap();
        assert_eq!(laboratory.certificate.begun.to_string(), "2026-10-05");
        assert!(laboratory.authorised_by().is_some());
    }

    /// Each change of the example is refused with the place, what was found and what was expected.
    #[test]
    fn mistakes_are_named() {
        let cases: [(&str, &str, &[&str]); 20] = [
            ("[customer]", "[costumer]", &["line", "costumer"]),
            ("post_code", "postcode", &["line", "postcode"]),
            ("country = \"RU\"", "country = \"Russia\"", &["address.country", "Russia", "ISO 3166-1"]),
            ("ended = 2026-10-07", "ended = 2026-09-07", &["[certificate], ended", "2026-09-07", "2026-10-05"]),
            (
                "ended = 2026-10-07",
                "ended = 2026-10-07T10:00:00",
                &["line", "found 2026-10-07T10:00:00, expected a date such as"],
            ),
            ("value = 20.3", "value = 293.3", &["[environment], temperature", "293.3", "-50 to 100"]),
            ("value = 45", "value = 0.45", &["[environment], humidity", "0.45", "1 to 100"]),
            ("value = 100.9", "value = 757", &["[environment], pressure", "757", "30 to 120"]),
            (
                "received = 2026-10-01",
                "received = 2026-10-06",
                &["[certificate], received", "2026-10-05 (begun) or earlier"],
            ),
            ("issued = 2026-10-09", "issued = 2026-10-06", &["[certificate], issued", "2026-10-06", "2026-10-07"]),
            ("name = \"B. Petrov\"", "name = \" \"", &["[[person]] 2, name", "an empty text"]),
            ("number = \"CL-2026-0117\"", "number = \"\"", &["[certificate], number", "an empty text"]),
            ("authorises = true", "authorises = false", &["[[person]]", "nobody"]),
            ("low = -0.15", "low = 0.2", &["[[decision.limit]] 1, low", "0.2", "below high"]),
            ("low = -0.15", "low = nan", &["[[decision.limit]] 1, low", "NaN", "finite"]),
            ("high = 0.15", "high = inf", &["[[decision.limit]] 1, high", "inf", "finite"]),
            ("high = 0.15", "within = 0.15", &["[[decision.limit]] 1, within", "low", "within alone"]),
            ("parameter = \"df_1\"", "group = \"biases\"", &["[[decision.limit]] 1, group", "biases", "bias, "]),
            ("parameter = \"df_1\"", "reading = \"raw\"", &["[[decision.limit]] 1, reading", "raw", "compensated"]),
            ("parameter = \"df_1\"", "group = \"bias\"\nreading = \"compensated\"", &["group and reading", "one of"]),
        ];
        for (from, to, parts) in cases {
            assert!(EXAMPLE.contains(from), "{from}");
            let message = read(&EXAMPLE.replacen(from, to, 1)).unwrap_err();
            for part in parts {
                assert!(message.contains(part), "{part:?} is not in {message}");
            }
        }
    }
}
