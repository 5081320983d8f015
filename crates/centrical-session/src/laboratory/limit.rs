//! Limits of a decision: of a parameter, of a group of them, or of the compensated reading, in any unit of the quantity.

use std::path::Path;

use centrical::Group;
use schemars::JsonSchema;
use serde::Deserialize;

use crate::error::{Error, Place, quoted};
use crate::quantity::{Quantity, in_parameter_unit};

/// Limits as written: a `parameter`, a `group` or a `reading`, with `low`, `high` or both, or `within` a magnitude.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Limit {
    /// Name of a parameter in the result.
    pub parameter: Option<String>,
    /// Name of a group in the result: each of its parameters has the limits.
    pub group: Option<String>,
    /// `"compensated"`: the error of the compensated reading of each axis, over the range of the calibration.
    pub reading: Option<String>,
    /// Lowest value.
    pub low: Option<Quantity>,
    /// Highest value.
    pub high: Option<Quantity>,
    /// Largest magnitude, in place of both.
    pub within: Option<Quantity>,
}

/// A parameter that limits may be of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limitable<'a> {
    /// Name.
    pub name: &'a str,
    /// Unit of SI.
    pub unit: &'a str,
    /// bias, scale, misalignment, ...
    pub group: Group,
}

/// Limits of one quantity of a result.
#[derive(Debug, Clone, PartialEq)]
pub struct StatedLimit {
    /// What they limit.
    pub of: Limited,
    /// Lowest value, if it is limited.
    pub low: Option<LimitEnd>,
    /// Highest value, if it is limited.
    pub high: Option<LimitEnd>,
}

/// What limits are of.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Limited {
    /// A parameter, by its name.
    Parameter(String),
    /// The error of the compensated reading of newtonometer 1, 2 or 3.
    CompensatedReading(usize),
}

/// An end of limits.
#[derive(Debug, Clone, PartialEq)]
pub struct LimitEnd {
    /// Value, SI.
    pub si: f64,
    /// The number as it was written.
    pub number: f64,
    /// Its unit as it was written; that of SI where none was.
    pub unit: String,
    /// Size of that unit, SI.
    pub size: f64,
}

impl Limit {
    /// Checks what can be checked without a result.
    pub(super) fn check(&self, file: &Path, n: usize) -> Result<(), Error> {
        let refuse = |key: &str, found: String, expected: &str| Err(unexpected(file, n, key, found, expected));
        let subjects = [("parameter", &self.parameter), ("group", &self.group), ("reading", &self.reading)];
        let given: Vec<&str> = subjects.iter().filter(|(_, name)| name.is_some()).map(|(key, _)| *key).collect();
        if given.len() != 1 {
            let found = if given.is_empty() { "none of them".to_owned() } else { given.join(" and ") };
            return refuse("parameter", found, "one of parameter, group and reading");
        }
        if let Some(group) = self.group.as_ref().filter(|group| named(group).is_none()) {
            return refuse("group", quoted(group.as_bytes()), &Group::ALL.map(Group::name).join(", "));
        }
        if let Some(reading) = self.reading.as_ref().filter(|reading| *reading != "compensated") {
            return refuse("reading", quoted(reading.as_bytes()), "\"compensated\"");
        }
        match (&self.within, &self.low, &self.high) {
            (None, None, None) => return refuse("high", "no limit".to_owned(), "low, high or within"),
            (Some(_), None, None) | (None, ..) => {}
            _ => return refuse("within", "low or high as well".to_owned(), "low and high, or within alone"),
        }
        for (key, end) in [("low", &self.low), ("high", &self.high), ("within", &self.within)] {
            if let Some(Quantity::Number(number)) = end
                && !number.is_finite()
            {
                return refuse(key, format!("{number}"), "a finite number");
            }
        }
        match (&self.low, &self.high) {
            (Some(Quantity::Number(low)), Some(Quantity::Number(high))) if low >= high => {
                refuse("low", low.to_string(), &format!("a number below high, {high}"))
            }
            _ => Ok(()),
        }
    }

    /// The limits of each quantity that is meant, of the compensated reading or one of `parameters`.
    pub(super) fn stated(&self, file: &Path, n: usize, parameters: &[Limitable]) -> Result<Vec<StatedLimit>, Error> {
        if self.reading.is_some() {
            let ends = |axis| self.ends(file, n, Limited::CompensatedReading(axis), "m/s^2", Group::Bias);
            return [1, 2, 3].into_iter().map(ends).collect();
        }
        let is_meant = |p: &&Limitable| match (&self.parameter, &self.group) {
            (Some(name), _) => p.name == *name,
            (None, group) => group.as_deref().and_then(named) == Some(p.group),
        };
        let meant: Vec<_> = parameters.iter().filter(is_meant).collect();
        if meant.is_empty() {
            return Err(self.unknown(file, n, parameters));
        }
        let ends = |p: &&Limitable| self.ends(file, n, Limited::Parameter(p.name.to_owned()), p.unit, p.group);
        meant.iter().map(ends).collect()
    }

    fn unknown(&self, file: &Path, n: usize, parameters: &[Limitable]) -> Error {
        let parameters = parameters.iter();
        let (key, found, mut known): (_, _, Vec<&str>) = match (&self.parameter, &self.group) {
            (None, Some(group)) => ("group", group.as_str(), parameters.map(|p| p.group.name()).collect()),
            (name, _) => ("parameter", name.as_deref().unwrap_or_default(), parameters.map(|p| p.name).collect()),
        };
        known.dedup();
        unexpected(file, n, key, quoted(found.as_bytes()), &format!("one of {}", known.join(", ")))
    }

    fn ends(&self, file: &Path, n: usize, of: Limited, unit: &str, group: Group) -> Result<StatedLimit, Error> {
        let end = |key: &str, quantity: &Option<Quantity>| {
            let read = |quantity: &Quantity| LimitEnd::read(quantity, unit, group);
            let end = quantity.as_ref().map(read).transpose();
            end.map_err(|(found, expected)| unexpected(file, n, key, found, &expected))
        };
        if let Some(most) = end("within", &self.within)? {
            if most.si <= 0.0 {
                return Err(unexpected(file, n, "within", most.number.to_string(), "a magnitude above zero"));
            }
            let least = LimitEnd { si: -most.si, number: -most.number, ..most.clone() };
            return Ok(StatedLimit { of, low: Some(least), high: Some(most) });
        }
        let (low, high) = (end("low", &self.low)?, end("high", &self.high)?);
        if let (Some(low), Some(high)) = (&low, &high)
            && low.si >= high.si
        {
            let expected = format!("a value below high, {} {}", high.number, high.unit);
            return Err(unexpected(file, n, "low", format!("{} {}", low.number, low.unit), &expected));
        }
        Ok(StatedLimit { of, low, high })
    }
}

impl LimitEnd {
    /// The end with its number and unit as they were written; of an invalid one, what was found and expected.
    fn read(quantity: &Quantity, unit: &str, group: Group) -> Result<Self, (String, String)> {
        let si = in_parameter_unit(quantity, unit, group).map_err(|not| (not.found, not.expected))?;
        if !si.is_finite() {
            return Err((quantity.to_string(), "a finite number".to_owned()));
        }
        let Quantity::Text(text) = quantity else {
            return Ok(Self { si, number: si, unit: unit.to_owned(), size: 1.0 });
        };
        let text = text.trim();
        let (number, length) = fast_float2::parse_partial::<f64, _>(text).unwrap_or((si, text.len()));
        let written = Some(text[length..].trim()).filter(|written| !written.is_empty()).unwrap_or(unit);
        let one = in_parameter_unit(&Quantity::Text(format!("1 {written}")), unit, group);
        Ok(Self { si, number, unit: written.to_owned(), size: one.unwrap_or(1.0) })
    }
}

fn named(group: &str) -> Option<Group> {
    Group::ALL.into_iter().find(|known| known.name() == group)
}

fn unexpected(file: &Path, n: usize, key: &str, found: String, expected: &str) -> Error {
    let place = Place::Key { table: format!("[[decision.limit]] {}", n + 1), key: key.to_owned() };
    Error::content(file, place, found, expected)
}
