//! Quantities as people write them: a number with a unit ("133.7 rpm"), or a plain number in SI; and days.

use std::borrow::Cow;
use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;
use std::time::SystemTime;

use centrical::Group;
use centrical::history::DAYS_IN_YEAR;
use jiff::civil;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{self, Deserializer, Visitor};
use serde::{Deserialize, Serialize, Serializer};

use crate::error::quoted;
use crate::units::{Dimension, writable};

/// A quantity as written, before its dimension is known.
#[derive(Debug, Clone, PartialEq)]
pub enum Quantity {
    /// A plain number, in SI.
    Number(f64),
    /// A number with a unit: `"133.7 rpm"`.
    Text(String),
}

/// An invalid quantity, or one of another dimension.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("found {found}, expected {expected}")]
pub struct NotThatQuantity {
    /// What was written.
    pub found: String,
    /// What can be written there.
    pub expected: String,
}

impl Quantity {
    /// The quantity in SI.
    ///
    /// # Errors
    /// If it is not a finite number, or its unit is not of `dimension`.
    pub fn si(&self, dimension: Dimension) -> Result<f64, NotThatQuantity> {
        let value = match self {
            Self::Number(number) => Some(*number),
            Self::Text(text) => parse(text, dimension),
        };
        let not = |expected| NotThatQuantity { found: self.to_string(), expected };
        match value {
            Some(value) if value.is_finite() => Ok(value),
            Some(_) => Err(not("a finite number".to_owned())),
            None => Err(not(dimension.expected())),
        }
    }
}

impl Quantity {
    /// Gravity at a place on Earth in SI: it is 9.76 to 9.84 m/s^2 at its surface.
    ///
    /// # Errors
    /// If it is not an acceleration from 9.7 to 9.9 m/s^2.
    pub fn gravity(&self) -> Result<f64, NotThatQuantity> {
        let expected = "gravity on Earth, 9.7 to 9.9 m/s^2, such as \"9.81523 m/s^2\"";
        self.within(Dimension::Acceleration, 9.7..=9.9, expected)
    }

    /// A sampling rate [Hz].
    ///
    /// # Errors
    /// If it is not a frequency from 1 mHz to 1 GHz.
    pub fn sampling_rate(&self) -> Result<f64, NotThatQuantity> {
        self.within(Dimension::Frequency, 1e-3..=1e9, "a rate from 1e-3 Hz to 1 GHz")
    }

    /// A largest error of readings [m/s^2].
    ///
    /// # Errors
    /// If it is not an acceleration above zero.
    pub fn largest_error(&self) -> Result<f64, NotThatQuantity> {
        self.within(Dimension::Acceleration, f64::MIN_POSITIVE..=f64::MAX, "an acceleration above zero")
    }

    /// The quantity in SI, if it is in a range.
    pub(crate) fn within(
        &self,
        dimension: Dimension,
        range: RangeInclusive<f64>,
        expected: &str,
    ) -> Result<f64, NotThatQuantity> {
        let value = self.si(dimension)?;
        let not = || NotThatQuantity { found: self.to_string(), expected: expected.to_owned() };
        range.contains(&value).then_some(value).ok_or_else(not)
    }
}

/// A quantity in the SI unit `unit` of a parameter in the group `group`: written as any quantity of its dimension, or in
/// a unit in which people are shown it.
pub(crate) fn in_parameter_unit(quantity: &Quantity, unit: &str, group: Group) -> Result<f64, NotThatQuantity> {
    match unit {
        "rad" => quantity.si(Dimension::Angle),
        "m" => quantity.si(Dimension::Length),
        "m/s^2" => quantity.si(Dimension::Acceleration),
        "1" if group == Group::Misalignment => {
            quantity.si(Dimension::Ratio).or_else(|not| quantity.si(Dimension::Angle).map_err(|_| not))
        }
        "1" => quantity.si(Dimension::Ratio),
        _ => in_derived_unit(quantity, unit, group),
    }
}

/// A coefficient in its SI unit or a unit in which people are shown it.
fn in_derived_unit(quantity: &Quantity, unit: &str, group: Group) -> Result<f64, NotThatQuantity> {
    let known = writable(unit, group);
    let factor = |written: &str| match written {
        "" => Some(1.0),
        _ => known.iter().find(|(name, _)| *name == written).map(|(_, factor)| *factor),
    };
    let value = match quantity {
        Quantity::Number(number) => Some(*number),
        Quantity::Text(text) => {
            let (number, written) = text.trim().split_once(char::is_whitespace).unwrap_or((text.trim(), ""));
            number.parse::<f64>().ok().and_then(|number| Some(number * factor(written.trim())?))
        }
    };
    let units: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
    let expected = || format!("a number in {unit} or with a unit (units: {})", units.join(", "));
    value
        .filter(|value| value.is_finite())
        .ok_or_else(|| NotThatQuantity { found: quantity.to_string(), expected: expected() })
}

/// `"133.7 rpm"` or `"1 h 30 min"` in SI, or nothing.
fn parse(text: &str, dimension: Dimension) -> Option<f64> {
    let text = text.trim();
    let (number, length) = fast_float2::parse_partial::<f64, _>(text).ok()?;
    match text[length..].trim_start() {
        "" => Some(number),
        unit => match dimension.factor(unit) {
            Some(factor) => Some(number * factor),
            None if dimension == Dimension::Time => parse_duration(text),
            None => None,
        },
    }
}

/// `"1 h 30 min 5 s"`: numbers with units that become smaller, whole and from zero on but for the last one, which may have a
/// fraction. A number of anything but the largest unit is less than one of the unit before it.
fn parse_duration(text: &str) -> Option<f64> {
    let mut words = text.split_whitespace();
    let mut sum = 0.0;
    let mut above = f64::INFINITY;
    let mut was_whole = true;
    while let Some(number) = words.next() {
        let is_plain = number.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.');
        let number: f64 = number.parse().ok().filter(|_| is_plain)?;
        let factor = Dimension::Time.factor(words.next()?)?;
        let part = number * factor;
        if !was_whole || factor >= above || part >= above {
            return None;
        }
        (was_whole, above, sum) = (number.fract() == 0.0, factor, sum + part);
    }
    Some(sum)
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number:?}"),
            Self::Text(text) => f.write_str(&quoted(text.as_bytes())),
        }
    }
}

impl<'de> Deserialize<'de> for Quantity {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(QuantityVisitor)
    }
}

impl JsonSchema for Quantity {
    fn schema_name() -> Cow<'static, str> {
        "Quantity".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "A number in SI, or a string with a unit such as \"133.7 rpm\"; a duration also as \"1 h 30 min\".",
            "anyOf": [{ "type": "number" }, { "type": "string" }],
        })
    }
}

/// Takes a number or a text.
pub(crate) struct QuantityVisitor;

impl Visitor<'_> for QuantityVisitor {
    type Value = Quantity;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number in SI or a string with a unit such as \"133.7 rpm\"")
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> Result<Quantity, E> {
        Ok(Quantity::Number(value))
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> Result<Quantity, E> {
        Ok(Quantity::Number(value as f64))
    }

    fn visit_str<E: de::Error>(self, text: &str) -> Result<Quantity, E> {
        Ok(Quantity::Text(text.to_owned()))
    }
}

/// A day.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Date {
    /// Year.
    pub year: u16,
    /// Month, 1 to 12.
    pub month: u8,
    /// Day, 1 to 31.
    pub day: u8,
}

impl Date {
    /// The day of a stamp without a time.
    fn of(stamp: toml::value::Datetime) -> Option<Self> {
        let date = stamp.date.filter(|_| stamp.time.is_none())?;
        Some(Self { year: date.year, month: date.month, day: date.day })
    }

    /// Today, of the clock of this machine, in UTC.
    pub fn today() -> Self {
        let passed = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        Self { year: 1970, month: 1, day: 1 }.after((passed.as_secs() / 86_400) as f64)
    }

    /// The day in years, for the axis of a plot: 2026.76.
    pub fn in_years(self) -> f64 {
        let first = Self { year: self.year, month: 1, day: 1 };
        f64::from(self.year) + self.days_since(first).map_or(0.0, f64::from) / 366.0
    }

    /// The day a number of whole days later; the last day of the calendar where that is beyond it.
    pub(crate) fn after(self, days: f64) -> Self {
        let civil = self.civil().unwrap_or(civil::Date::MAX);
        #[expect(clippy::cast_possible_truncation, reason = "a span of days saturates")]
        let days = days.clamp(-4e6, 4e6) as i32;
        let later = civil.saturating_add(jiff::Span::new().days(days));
        let [year, month, day] =
            [later.year(), i16::from(later.month()), i16::from(later.day())].map(i16::unsigned_abs);
        let small = |number: u16| u8::try_from(number).unwrap_or(u8::MAX);
        Self { year, month: small(month), day: small(day) }
    }

    fn civil(self) -> Option<civil::Date> {
        let [month, day] = [self.month, self.day].map(|number| i8::try_from(number).ok());
        civil::Date::new(i16::try_from(self.year).ok()?, month?, day?).ok()
    }

    /// Days from an earlier day to this one; none where one of them is not in the calendar.
    pub(crate) fn days_since(self, earlier: Self) -> Option<i32> {
        Some((self.civil()? - earlier.civil()?).get_days())
    }

    /// The same in years.
    pub(crate) fn years_since(self, earlier: Self) -> Option<f64> {
        Some(f64::from(self.days_since(earlier)?) / DAYS_IN_YEAR)
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

impl Serialize for Date {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Date {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let stamp = toml::value::Datetime::deserialize(deserializer)?;
        Self::of(stamp).ok_or_else(|| de::Error::custom(format!("{stamp}, expected a date such as 2026-10-05")))
    }
}

impl FromStr for Date {
    type Err = String;

    /// A day of ISO 8601, or the day of a time there.
    fn from_str(text: &str) -> Result<Self, String> {
        let stamp = text.trim().parse::<toml::value::Datetime>().ok();
        let day = stamp.and_then(|stamp| Self::of(toml::value::Datetime { time: None, ..stamp }));
        day.ok_or_else(|| "expected a day such as 2026-10-05".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn read(text: &str, dimension: Dimension) -> Option<f64> {
        Quantity::Text(text.to_owned()).si(dimension).ok()
    }

    proptest! {
        /// Hours, minutes and seconds are whole numbers, and their sum is exact.
        #[test]
        fn a_duration_is_read_as_it_is_printed(hours in 0_u32..10_000, minutes in 0_u32..60, seconds in 0_u32..60) {
            let whole = f64::from(3600 * hours + 60 * minutes);
            prop_assert_eq!(read(&format!("{hours} h {minutes:02} min"), Dimension::Time), Some(whole));
            let text = format!("{hours} h {minutes} min {seconds} s");
            prop_assert_eq!(read(&text, Dimension::Time), Some(whole + f64::from(seconds)));
            prop_assert_eq!(read(&format!("{minutes} min {seconds} s"), Dimension::Time), Some(f64::from(60 * minutes + seconds)));
        }

        /// What a person wrote with up to six decimals is written back letter by letter.
        #[test]
        fn a_number_in_a_unit_is_written_as_it_was_read(millionths in -10_000_000_000_i64..10_000_000_000) {
            for (dimension, unit) in [(Dimension::Speed, "rpm"), (Dimension::Angle, "deg"), (Dimension::Time, "s")] {
                let text = format!("{} {unit}", millionths as f64 / 1e6);
                let value = read(&text, dimension).unwrap();
                prop_assert_eq!(dimension.written(value, unit), Some(text));
            }
        }

        /// Two roundings of one part in 2^53, the quotient and its product with the factor; a third one is that of the test.
        #[test]
        fn any_number_is_read_back_to_two_roundings(value in prop::num::f64::NORMAL.prop_filter("a speed", |v| (1e-9..1e9).contains(&v.abs()))) {
            for (dimension, unit) in [(Dimension::Speed, "rpm"), (Dimension::Angle, "deg"), (Dimension::Time, "s")] {
                let back = read(&dimension.written(value, unit).unwrap(), dimension).unwrap();
                prop_assert!((back / value - 1.0).abs() <= 1.5 * f64::EPSILON, "{} for {}", back, value);
            }
        }
    }

    #[test]
    fn gravity_is_that_of_the_earth() {
        for text in ["9.81523", "9.7 m/s^2", "9.9 m/s^2", "1 g", "980.665 Gal"] {
            assert!(Quantity::Text(text.to_owned()).gravity().is_ok(), "{text}");
        }
        for text in ["98", "0", "-9.81", "9.69", "9.91 m/s^2", "9.81 g", "981 mGal"] {
            let not = Quantity::Text(text.to_owned()).gravity().unwrap_err();
            assert!(not.expected.starts_with("gravity on Earth, 9.7 to 9.9 m/s^2"), "{text}");
        }
    }

    #[test]
    fn what_is_no_duration_is_refused() {
        for text in [
            "1 h 90 min",
            "1.5 h 3 min",
            "30 min 1 h",
            "1 h 1 h",
            "-1 h 30 min",
            "1 h -30 min",
            "1 h 30",
            "1 h min",
            "h",
            "1 h 3 m",
            "1 h 1e1 min",
            "1 h nan s",
        ] {
            assert_eq!(read(text, Dimension::Time), None, "{text}");
        }
        assert_eq!(read("1 min 30 s", Dimension::Angle), None);
        assert_eq!(read("1 min 0.25 s", Dimension::Time), Some(60.25));
        assert_eq!(read("-1.5 h", Dimension::Time), Some(-5400.0));
    }
}
