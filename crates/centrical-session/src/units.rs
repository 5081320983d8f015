//! The units of quantities and parameters: those in which people of the field write and read them, SI as results name them, D-SI,
//! and the symbols of all. 1 g = 9.80665 m/s^2.

use std::f64::consts::{PI, TAU};

use centrical::{Group, STANDARD_GRAVITY};

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

impl Dimension {
    /// `value` [SI] as a number in `unit`: the one with the fewest digits that is read as the same `f64`. Where the factor of
    /// the unit skips that `f64`, the nearest number, which is read to within one part in 2^52. `None` if `unit` is not
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

    /// Factor that takes a number in `unit` to SI; `None` if `unit` is not of this dimension.
    pub fn factor(self, unit: &str) -> Option<f64> {
        self.units().iter().find(|(name, _)| *name == unit).map(|(_, factor)| *factor)
    }

    /// Units and their factors to SI, the SI unit first.
    pub fn units(self) -> &'static [(&'static str, f64)] {
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
    pub(crate) fn expected(self) -> String {
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
