//! Quantities as people write them: a number with a unit ("133.7 rpm"), or a plain number in SI; and days.

mod date;
mod dimension;

use std::borrow::Cow;
use std::fmt;
use std::ops::RangeInclusive;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{self, Deserialize, Deserializer, Visitor};

pub use self::date::{Date, NotADay};
pub use self::dimension::Dimension;
use crate::error::quoted;

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
