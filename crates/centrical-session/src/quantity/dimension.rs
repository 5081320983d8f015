//! What a quantity measures, and its units.

use std::f64::consts::{PI, TAU};

use centrical::STANDARD_GRAVITY;

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
