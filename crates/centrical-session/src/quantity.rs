//! Quantities as people write them: a number with a unit ("133.7 rpm"), or a plain number in SI.

use std::borrow::Cow;
use std::f64::consts::{PI, TAU};
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{self, Deserialize, Deserializer, Visitor};

use centrical::STANDARD_GRAVITY;

use crate::error::quoted;

/// A quantity as written, before its dimension is known.
#[derive(Debug, Clone, PartialEq)]
pub enum Quantity {
    /// A plain number, in SI.
    Number(f64),
    /// A number with a unit: `"133.7 rpm"`.
    Text(String),
}

/// What a quantity measures, which decides the units it may have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// In m.
    Length,
    /// In rad.
    Angle,
    /// In rad/s.
    Speed,
    /// In m/s^2.
    Acceleration,
    /// In s.
    Time,
    /// In 1/s.
    Frequency,
    /// Square root of a one-sided spectral density, in m/s^2/sqrt(Hz).
    NoiseDensity,
    /// Dimensionless.
    Ratio,
}

/// A quantity that is none, or not of the dimension asked for.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("found {found}, expected {expected}")]
pub struct NotThatQuantity {
    /// What was written.
    pub found: String,
    /// What can be written there.
    pub expected: String,
}

impl Dimension {
    /// `value` [SI] as a number in `unit`: the one with the fewest digits that is read as the same `f64`. Where the factor of
    /// the unit skips that `f64`, the nearest number, which is read to within one part in 2^52. `None` if `unit` is no unit
    /// of this dimension.
    pub(crate) fn written(self, value: f64, unit: &str) -> Option<String> {
        let factor = self.factor(unit)?;
        // Without the sign of a negative zero.
        let (nearest, value) = (value / factor + 0.0, value + 0.0);
        let rounded = (0..17).filter_map(|digits| format!("{nearest:.digits$e}").parse::<f64>().ok());
        let neighbours = [nearest, nearest.next_down(), nearest.next_up()];
        let number = rounded.chain(neighbours).find(|number| number * factor == value).unwrap_or(nearest);
        Some(format!("{number} {unit}"))
    }

    /// Factor that takes a number in `unit` to SI; `None` if `unit` is no unit of this dimension.
    pub fn factor(self, unit: &str) -> Option<f64> {
        self.units().iter().find(|(name, _)| *name == unit).map(|(_, factor)| *factor)
    }

    /// Units and their factors to SI, the SI unit first.
    fn units(self) -> &'static [(&'static str, f64)] {
        const DEGREE: f64 = PI / 180.0;
        match self {
            Self::Length => {
                &[("m", 1.0), ("cm", 1e-2), ("mm", 1e-3), ("um", 1e-6), ("µm", 1e-6), ("μm", 1e-6), ("in", 0.0254)]
            }
            Self::Angle => &[
                ("rad", 1.0),
                ("mrad", 1e-3),
                ("urad", 1e-6),
                ("µrad", 1e-6),
                ("μrad", 1e-6),
                ("deg", DEGREE),
                ("°", DEGREE),
                ("arcmin", DEGREE / 60.0),
                ("arcsec", DEGREE / 3600.0),
                ("rev", TAU),
            ],
            Self::Speed => &[
                ("rad/s", 1.0),
                ("rpm", TAU / 60.0),
                ("rev/min", TAU / 60.0),
                ("rev/s", TAU),
                ("Hz", TAU),
                ("deg/s", DEGREE),
                ("°/s", DEGREE),
            ],
            Self::Acceleration => &[
                ("m/s^2", 1.0),
                ("m/s2", 1.0),
                ("m/s²", 1.0),
                ("mm/s^2", 1e-3),
                ("g", STANDARD_GRAVITY),
                ("mg", 1e-3 * STANDARD_GRAVITY),
                ("ug", 1e-6 * STANDARD_GRAVITY),
                ("µg", 1e-6 * STANDARD_GRAVITY),
                ("μg", 1e-6 * STANDARD_GRAVITY),
                ("Gal", 1e-2),
                ("mGal", 1e-5),
            ],
            Self::Time => &[
                ("s", 1.0),
                ("ms", 1e-3),
                ("us", 1e-6),
                ("µs", 1e-6),
                ("μs", 1e-6),
                ("ns", 1e-9),
                ("min", 60.0),
                ("h", 3600.0),
            ],
            Self::NoiseDensity => &[
                ("m/s^2/sqrt(Hz)", 1.0),
                ("mg/sqrt(Hz)", 1e-3 * STANDARD_GRAVITY),
                ("ug/sqrt(Hz)", 1e-6 * STANDARD_GRAVITY),
                ("µg/√Hz", 1e-6 * STANDARD_GRAVITY),
                ("μg/√Hz", 1e-6 * STANDARD_GRAVITY),
            ],
            Self::Frequency => &[("Hz", 1.0), ("kHz", 1e3), ("MHz", 1e6), ("1/s", 1.0)],
            Self::Ratio => &[("1", 1.0), ("%", 1e-2), ("ppm", 1e-6), ("ppb", 1e-9)],
        }
    }

    /// What can be written for this dimension.
    fn expected(self) -> String {
        let example = match self {
            Self::Length => "a length such as \"0.5 m\" or a number in m",
            Self::Angle => "an angle such as \"180 deg\" or a number in rad",
            Self::Speed => "a speed such as \"133.7 rpm\" or a number in rad/s",
            Self::Acceleration => "an acceleration such as \"9.81523 m/s^2\" or a number in m/s^2",
            Self::Time => "a time such as \"10 ms\" or \"1 h 30 min\", or a number in s",
            Self::NoiseDensity => "a density such as \"20 ug/sqrt(Hz)\" or a number in m/s^2/sqrt(Hz)",
            Self::Frequency => "a frequency such as \"1 kHz\" or a number in Hz",
            Self::Ratio => "a ratio such as \"10 ppm\" or a plain number",
        };
        format!("{example} (units: {})", self.unit_list())
    }

    /// The units of this dimension, for messages; the spellings outside ASCII are left out.
    pub(crate) fn unit_list(self) -> String {
        let names: Vec<&str> = self.units().iter().map(|(name, _)| *name).filter(|name| name.is_ascii()).collect();
        names.join(", ")
    }
}

impl Quantity {
    /// The quantity in SI.
    ///
    /// # Errors
    /// If it is no finite number, or its unit is not one of `dimension`.
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
