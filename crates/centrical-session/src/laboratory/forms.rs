//! The tables of `laboratory.toml`.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Deserialize;

use crate::quantity::Date;

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
    /// Picture for its certificates, a PNG file, beside the laboratory's file.
    pub logo: Option<PathBuf>,
}

/// The customer.
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
    /// Temperature of the unit, where it is known [degrees Celsius].
    pub unit_temperature: Option<Condition>,
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
