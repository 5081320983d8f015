//! The units of parameters: SI as results name them, D-SI, those in which people of the field read and write them, and
//! the symbols of all. 1 g = 9.80665 m/s^2.

use std::f64::consts::TAU;

use centrical::{Group, STANDARD_GRAVITY};

use crate::quantity::{Dimension, NotThatQuantity, Quantity};

/// One micro-g in m/s^2.
pub const MICRO_G: f64 = 1e-6 * STANDARD_GRAVITY;

/// A speed in revolutions a minute [rad/s].
pub fn rpm(omega: f64) -> f64 {
    omega * 60.0 / TAU
}

/// 10 rev/s [rad/s], the field's top speed: deformations that grow with the square of the speed are shown as they are there.
const TOP_SPEED: f64 = 10.0 * TAU;

/// A customary unit.
struct Customary {
    /// SI unit of the parameters.
    si: &'static str,
    /// Group of the parameters; any if none.
    group: Option<Group>,
    /// Name.
    name: &'static str,
    /// Its size in the SI unit.
    size: f64,
}

/// The customary units, the usual one of a group first.
const CUSTOMARY: [Customary; 19] = [
    customary_unit("m/s^2", None, "mg", 1e-3 * STANDARD_GRAVITY),
    customary_unit("1", Some(Group::Misalignment), "urad", 1e-6),
    customary_unit("1", None, "ppm", 1e-6),
    customary_unit("rad", None, "urad", 1e-6),
    customary_unit("m/s", Some(Group::Disturbance), "ug at 10 rev/s", MICRO_G / TOP_SPEED),
    customary_unit("m", Some(Group::Disturbance), "ug at 10 rev/s", MICRO_G / (TOP_SPEED * TOP_SPEED)),
    customary_unit(
        "m s^2",
        Some(Group::Disturbance),
        "ug at 10 rev/s",
        MICRO_G / (TOP_SPEED * TOP_SPEED * TOP_SPEED * TOP_SPEED),
    ),
    customary_unit("m", None, "um", 1e-6),
    customary_unit("s^2/m", Some(Group::ArmTurn), "urad/g", 1e-6 / STANDARD_GRAVITY),
    customary_unit("s^2", Some(Group::ArmTurn), "urad at 10 rev/s", 1e-6 / (TOP_SPEED * TOP_SPEED)),
    customary_unit("s^2", Some(Group::Disturbance), "um/g", 1e-6 / STANDARD_GRAVITY),
    customary_unit("s^6/m^3", None, "ug/g^4", 1e-6 / (STANDARD_GRAVITY * STANDARD_GRAVITY * STANDARD_GRAVITY)),
    customary_unit(
        "s^8/m^4",
        None,
        "ug/g^5",
        1e-6 / (STANDARD_GRAVITY * STANDARD_GRAVITY * STANDARD_GRAVITY * STANDARD_GRAVITY),
    ),
    customary_unit("s^2/m", Some(Group::ElasticTurn), "urad/g", 1e-6 / STANDARD_GRAVITY),
    customary_unit("s^2/m", Some(Group::ArmStretch), "ppm/g", 1e-6 / STANDARD_GRAVITY),
    customary_unit("s^2/m", None, "ug/g^2", 1e-6 / STANDARD_GRAVITY),
    customary_unit("s^2", Some(Group::ElasticTurn), "urad at 10 rev/s", 1e-6 / (TOP_SPEED * TOP_SPEED)),
    customary_unit("s^2", Some(Group::ArmStretch), "ppm at 10 rev/s", 1e-6 / (TOP_SPEED * TOP_SPEED)),
    customary_unit("s^4/m^2", None, "ug/g^3", 1e-6 / (STANDARD_GRAVITY * STANDARD_GRAVITY)),
];

const fn customary_unit(si: &'static str, group: Option<Group>, name: &'static str, size: f64) -> Customary {
    Customary { si, group, name, size }
}

/// Factor and name of the customary unit of a parameter with the SI unit `unit` in the group `group`:
/// shown value = factor times SI value. SI itself where none is customary.
pub fn customary(unit: &str, group: Group) -> (f64, &str) {
    fitting(unit, group).next().map_or((1.0, unit), |known| (1.0 / known.size, known.name))
}

/// Names and sizes of the units in which a parameter may be written, SI first.
pub(crate) fn writable(unit: &str, group: Group) -> Vec<(&str, f64)> {
    std::iter::once((unit, 1.0)).chain(fitting(unit, group).map(|known| (known.name, known.size))).collect()
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

fn fitting(unit: &str, group: Group) -> impl Iterator<Item = &'static Customary> {
    CUSTOMARY.iter().filter(move |known| known.si == unit && known.group.is_none_or(|of| of == group))
}

/// How a part of a unit is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Symbol {
    /// As results and tables for the terminal name it.
    pub plain: &'static str,
    /// In English documents.
    pub english: &'static str,
    /// In Russian documents.
    pub russian: &'static str,
    /// In D-SI; none of a part that no SI unit has.
    pub d_si: Option<&'static str>,
}

const fn symbol(
    plain: &'static str,
    english: &'static str,
    russian: &'static str,
    d_si: Option<&'static str>,
) -> Symbol {
    Symbol { plain, english, russian, d_si }
}

/// The parts of units; those of SI first, in the order of the powers of [`UnitOfMeasure`].
const SYMBOLS: [Symbol; 15] = [
    symbol("m", "m", "м", Some("\\metre")),
    symbol("s", "s", "с", Some("\\second")),
    symbol("rad", "rad", "рад", Some("\\radian")),
    symbol("1", "1", "1", Some("\\one")),
    symbol("ppm", "ppm", "млн⁻¹", None),
    symbol("urad", "µrad", "мкрад", None),
    symbol("um", "µm", "мкм", None),
    symbol("ug", "µg", "мкg", None),
    symbol("mg", "mg", "мg", None),
    symbol("min", "min", "мин", None),
    symbol("kPa", "kPa", "кПа", None),
    symbol("rev", "rev", "об", None),
    symbol("at", "at", "при", None),
    symbol("counts", "counts", "ед. кода", None),
    symbol("V", "V", "В", Some("\\volt")),
];

impl Symbol {
    /// The symbol of a part of a unit, if it has one of its own.
    pub fn of(plain: &str) -> Option<&'static Self> {
        SYMBOLS.iter().find(|symbol| symbol.plain == plain)
    }
}

/// An SI unit: powers of metre, second and radian.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UnitOfMeasure([i32; 3]);

/// A text that names no unit of a parameter.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("found the unit {found:?}, expected a fraction of powers of m, s and rad such as s^2/m, or 1")]
pub struct UnknownUnit {
    /// What was found.
    pub found: String,
}

impl UnitOfMeasure {
    /// `m/s^2`.
    pub const ACCELERATION: Self = Self([1, -2, 0]);

    /// The unit that a result names by a fraction of powers.
    ///
    /// # Errors
    /// [`UnknownUnit`] when it is not such a fraction.
    pub fn parse(text: &str) -> Result<Self, UnknownUnit> {
        let unknown = || UnknownUnit { found: text.to_owned() };
        let mut powers = [0; 3];
        for (part, sign) in text.split('/').zip(std::iter::once(1).chain(std::iter::repeat(-1))) {
            let (name, power) = part.split_once('^').unwrap_or((part, "1"));
            let power: i32 = power.parse().map_err(|_| unknown())?;
            match SYMBOLS[..powers.len()].iter().position(|base| base.plain == name) {
                Some(base) => powers[base] += sign * power,
                None if name == "1" => {}
                None => return Err(unknown()),
            }
        }
        Ok(Self(powers))
    }

    /// Unit of a product.
    #[must_use]
    pub fn times(self, other: Self) -> Self {
        Self([0, 1, 2].map(|k| self.0[k] + other.0[k]))
    }

    /// The unit in D-SI: `m/s^2` is `\metre\second\tothe{-2}`.
    pub fn d_si(self) -> String {
        let part = |(symbol, power): (&Symbol, i32)| match (symbol.d_si?, power) {
            (_, 0) => None,
            (name, 1) => Some(name.to_owned()),
            (name, _) => Some(format!("{name}\\tothe{{{power}}}")),
        };
        let text: String = SYMBOLS.iter().zip(self.0).filter_map(part).collect();
        if text.is_empty() { "\\one".to_owned() } else { text }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_of_results() {
        let shown = |text| UnitOfMeasure::parse(text).unwrap().d_si();
        assert_eq!(shown("m/s^2"), "\\metre\\second\\tothe{-2}");
        assert_eq!(shown("s^2/m"), "\\metre\\tothe{-1}\\second\\tothe{2}");
        assert_eq!(shown("s^4/m^2"), "\\metre\\tothe{-2}\\second\\tothe{4}");
        assert_eq!((shown("1").as_str(), shown("rad").as_str()), ("\\one", "\\radian"));
        let product = UnitOfMeasure::parse("m/s^2").unwrap().times(UnitOfMeasure::parse("s^2/m").unwrap());
        assert_eq!(product.d_si(), "\\one");
    }

    #[test]
    fn what_is_no_unit_is_refused() {
        for text in ["", "kg", "m/K", "m^x", "ug/g^2"] {
            assert_eq!(UnitOfMeasure::parse(text), Err(UnknownUnit { found: text.to_owned() }));
        }
    }

    #[test]
    fn every_unit_that_people_are_shown_may_be_written() {
        for known in &CUSTOMARY {
            let group = known.group.unwrap_or(Group::Bias);
            let (factor, name) = customary(known.si, group);
            assert_eq!((name, factor), (known.name, 1.0 / known.size));
            assert!(writable(known.si, group).contains(&(name, known.size)), "{name}");
            for part in name.split(['/', ' ']).filter_map(|part| part.split('^').next()) {
                assert!(Symbol::of(part).is_some() || ["g", "10"].contains(&part), "{part}");
            }
        }
    }
}
