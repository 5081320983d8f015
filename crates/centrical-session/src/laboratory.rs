//! `laboratory.toml`: what a certificate says beyond the calibration itself (ISO/IEC 17025, 7.8.2 and 7.8.4).

use std::borrow::Cow;
use std::fmt;
use std::path::Path;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{self, Deserializer};
use serde::{Deserialize, Serialize};

use crate::document::CalibrationResult;
use crate::error::{Error, Place, quoted};
use crate::settings::{from_toml, read_settings};

/// The whole file.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Laboratory {
    /// Who calibrated.
    pub laboratory: LaboratoryTable,
    /// For whom.
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

/// Who calibrated.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LaboratoryTable {
    /// Name.
    pub name: String,
    /// Address.
    pub address: Address,
    /// Telephone, e-mail.
    #[serde(default)]
    pub contact: Contact,
    /// Number of its accreditation.
    pub accreditation: Option<String>,
}

/// For whom.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Customer {
    /// Name.
    pub name: String,
    /// Address.
    pub address: Address,
    /// Telephone, e-mail.
    #[serde(default)]
    pub contact: Contact,
}

/// A postal address.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Address {
    /// Street and number.
    pub street: String,
    /// City.
    pub city: String,
    /// Postal code.
    pub post_code: String,
    /// Country, two letters of ISO 3166-1.
    pub country: String,
}

/// How to reach someone.
#[derive(Debug, Clone, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Contact {
    /// Telephone.
    pub phone: Option<String>,
    /// E-mail.
    pub email: Option<String>,
}

/// The document.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Certificate {
    /// Its unique number, on every page.
    pub number: String,
    /// Day of issue.
    pub issued: Date,
    /// Day the unit was received.
    pub received: Option<Date>,
    /// First day of the calibration.
    pub begun: Date,
    /// Last day of the calibration.
    pub ended: Date,
    /// Where it was done, if not on the laboratory's own premises.
    pub place: Option<String>,
    /// Number of the certificate that this one replaces.
    pub replaces: Option<String>,
}

/// The unit.
#[derive(Debug, Clone, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Item {
    /// Manufacturer.
    pub manufacturer: Option<String>,
    /// What it is: "three-axis newtonometer unit".
    pub description: Option<String>,
    /// Its state on receipt.
    pub condition: Option<String>,
    /// The customer's own number for it.
    pub customer_number: Option<String>,
    /// What was adjusted between the results before and after, if anything.
    pub adjustment: Option<String>,
}

/// The method.
#[derive(Debug, Clone, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct MethodTable {
    /// The laboratory's procedure.
    pub procedure: Option<String>,
    /// Additions to, deviations or exclusions from it.
    pub deviations: Option<String>,
}

/// Conditions during the calibration.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Environment {
    /// Air temperature [degrees Celsius].
    pub temperature: Condition,
    /// Relative humidity [%].
    pub humidity: Option<Condition>,
    /// Air pressure [kPa].
    pub pressure: Option<Condition>,
}

/// A condition: its mean value and how far it went from it.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Condition {
    /// Value.
    pub value: f64,
    /// Half the range.
    pub range: f64,
}

/// A standard.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Standard {
    /// What it is.
    pub name: String,
    /// Its number.
    pub identification: String,
    /// Its certificate.
    pub certificate: String,
    /// To what it is traceable: a national standard, an institute.
    pub traceable_to: String,
}

/// Someone responsible.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Person {
    /// Name.
    pub name: String,
    /// Role.
    pub role: String,
    /// Whether this person authorises the certificate.
    #[serde(default)]
    pub authorises: bool,
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

/// Limits of a parameter.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Limit {
    /// Name of the parameter in the result.
    pub parameter: String,
    /// Lowest value, SI.
    pub low: f64,
    /// Highest value, SI.
    pub high: f64,
}

/// A day.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Date {
    /// Year.
    pub year: u16,
    /// Month, 1 to 12.
    pub month: u8,
    /// Day, 1 to 31.
    pub day: u8,
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

    /// Checks that every limit of the decision is one of a parameter of `result`. `file` is the laboratory's.
    ///
    /// # Errors
    /// [`Error::Table`] with the limit that is not.
    pub fn check_limits(&self, file: &Path, result: &CalibrationResult) -> Result<(), Error> {
        let mut limits = self.decision.iter().flat_map(|decision| &decision.limit);
        let Some(unknown) = limits.find(|limit| result.parameter(&limit.parameter).is_none()) else { return Ok(()) };
        let place = Place::Key { table: "[[decision.limit]]".to_owned(), key: "parameter".to_owned() };
        let known = result.parameters.iter().map(|p| p.name.as_str()).collect::<Vec<_>>().join(", ");
        Err(Error::content(file, place, quoted(unknown.parameter.as_bytes()), format!("one of {known}")))
    }

    fn check(&self, file: &Path) -> Result<(), Error> {
        let refuse = |table: &str, key: &str, found: String, expected: &str| {
            let place = Place::Key { table: table.to_owned(), key: key.to_owned() };
            Err(Error::content(file, place, found, expected))
        };
        let filled = [
            ("[laboratory]", "name", &self.laboratory.name),
            ("[customer]", "name", &self.customer.name),
            ("[certificate]", "number", &self.certificate.number),
        ];
        if let Some((table, key, _)) = filled.into_iter().find(|(_, _, text)| text.trim().is_empty()) {
            return refuse(table, key, "an empty text".to_owned(), "a text");
        }
        for (table, address) in [("[laboratory]", &self.laboratory.address), ("[customer]", &self.customer.address)] {
            let country = &address.country;
            if country.len() != 2 || !country.bytes().all(|b| b.is_ascii_uppercase()) {
                let expected = "two capital letters of ISO 3166-1, such as \"DE\"";
                return refuse(table, "address.country", quoted(country.as_bytes()), expected);
            }
        }
        let Certificate { begun, ended, issued, .. } = self.certificate;
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
        match limits
            .into_iter()
            .find(|limit| !(limit.low.is_finite() && limit.high.is_finite() && limit.low < limit.high))
        {
            Some(Limit { parameter, low, high }) => refuse(
                "[[decision.limit]]",
                parameter,
                format!("low {low}, high {high}"),
                "finite numbers, low below high",
            ),
            None => Ok(()),
        }
    }

    /// The person who authorises the certificate.
    pub fn authorised_by(&self) -> Option<&Person> {
        self.person.iter().find(|person| person.authorises)
    }
}

impl Environment {
    /// A condition that cannot be, by its value or as far as it went from it: its key, what was found and what was expected.
    fn impossible(&self) -> Option<(&'static str, String, String)> {
        let conditions = [
            ("temperature", Some(&self.temperature), (-273.15, 1e3), "degrees Celsius from -273.15 to 1000"),
            ("humidity", self.humidity.as_ref(), (0.0, 100.0), "% of relative humidity from 0 to 100"),
            ("pressure", self.pressure.as_ref(), (0.0, 1e3), "kPa from 0 to 1000"),
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

impl fmt::Display for Date {
    /// ISO 8601.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:04}-{:02}-{:02}", self.year, self.month, self.day)
    }
}

impl JsonSchema for Date {
    fn schema_name() -> Cow<'static, str> {
        "Date".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "description": "A day such as 2026-10-05.", "type": "string", "format": "date" })
    }
}

impl<'de> Deserialize<'de> for Date {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let stamp = toml::value::Datetime::deserialize(deserializer)?;
        match (stamp.date, stamp.time) {
            (Some(date), None) => Ok(Self { year: date.year, month: date.month, day: date.day }),
            _ => Err(de::Error::custom(format!("{stamp} is no day, expected one such as 2026-10-05"))),
        }
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
        let cases: [(&str, &str, &[&str]); 10] = [
            ("[customer]", "[costumer]", &["line", "costumer"]),
            ("post_code", "postcode", &["line", "postcode"]),
            ("country = \"RU\"", "country = \"Russia\"", &["address.country", "Russia", "ISO 3166-1"]),
            ("ended = 2026-10-07", "ended = 2026-09-07", &["[certificate], ended", "2026-09-07", "2026-10-05"]),
            ("ended = 2026-10-07", "ended = 2026-10-07T10:00:00", &["line", "no day"]),
            ("issued = 2026-10-09", "issued = 2026-10-06", &["[certificate], issued", "2026-10-06", "2026-10-07"]),
            ("authorises = true", "authorises = false", &["[[person]]", "nobody"]),
            ("low = -0.15", "low = 0.2", &["df_1", "low 0.2", "low below high"]),
            ("low = -0.15", "low = nan", &["df_1", "low NaN", "finite"]),
            ("high = 0.15", "high = inf", &["df_1", "high inf", "finite"]),
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
