//! The units in which people of the field read the parameters: mg, ppm, urad, um, ug/g^2, ug/g^3, with
//! g = 9.80665 m/s^2.

use std::f64::consts::TAU;

use centrical::STANDARD_GRAVITY;

/// 10 rev/s [rad/s].
const TOP_SPEED: f64 = 10.0 * TAU;

/// Factor and name of the customary unit of a parameter with the SI unit `unit` in the group `group`:
/// shown value = factor times SI value. SI itself where none is customary.
pub fn customary<'a>(unit: &'a str, group: &str) -> (f64, &'a str) {
    match (unit, group) {
        ("m/s^2", _) => (1e3 / STANDARD_GRAVITY, "mg"),
        ("1", "misalignment") | ("rad", _) => (1e6, "urad"),
        ("1", _) => (1e6, "ppm"),
        ("m", _) => (1e6, "um"),
        ("s^2/m", "elastic turn") => (1e6 * STANDARD_GRAVITY, "urad/g"),
        ("s^2/m", "arm stretch") => (1e6 * STANDARD_GRAVITY, "ppm/g"),
        // Deformations that grow with the square of the speed, as they are at the field's top speed.
        ("s^2", "elastic turn") => (1e6 * TOP_SPEED * TOP_SPEED, "urad at 10 rev/s"),
        ("s^2", "arm stretch") => (1e6 * TOP_SPEED * TOP_SPEED, "ppm at 10 rev/s"),
        ("s^2/m", _) => (1e6 * STANDARD_GRAVITY, "ug/g^2"),
        ("s^4/m^2", _) => (1e6 * STANDARD_GRAVITY * STANDARD_GRAVITY, "ug/g^3"),
        _ => (1.0, unit),
    }
}

/// A value and its standard uncertainty, both to the place of the uncertainty's second significant digit
/// (GUM, 7.2.6).
pub fn with_uncertainty(value: f64, uncertainty: f64) -> (String, String) {
    let places = places_of(uncertainty);
    let shown = format!("{value:.places$}");
    // A small negative number rounds to a zero, which has no sign.
    let is_zero = !shown.contains(|c: char| c.is_ascii_digit() && c != '0');
    let shown = if is_zero { shown.trim_start_matches('-').to_owned() } else { shown };
    (shown, format!("{uncertainty:.places$}"))
}

/// Decimal places that show two significant digits of an uncertainty.
fn places_of(uncertainty: f64) -> usize {
    if !(uncertainty.is_finite() && uncertainty > 0.0) {
        return 6;
    }
    // As rounded to two digits: 0.0996 is 0.10, which needs two places and not three.
    let exponent = format!("{uncertainty:.1e}").split_once('e').and_then(|(_, e)| e.parse::<i32>().ok()).unwrap_or(0);
    usize::try_from(1 - exponent).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::with_uncertainty;

    #[test]
    fn two_digits_of_the_uncertainty() {
        let shown = |v, u| {
            let (value, uncertainty) = with_uncertainty(v, u);
            format!("{value} ± {uncertainty}")
        };
        assert_eq!(shown(-3.952_149, 0.001_234), "-3.9521 ± 0.0012");
        assert_eq!(shown(744.294, 0.0996), "744.29 ± 0.10");
        assert_eq!(shown(12345.6, 123.0), "12346 ± 123");
        assert_eq!(shown(1.0, 9.96), "1 ± 10");
        assert_eq!(shown(-0.3, 40.0), "0 ± 40");
        assert_eq!(shown(-0.04, 3.0), "0.0 ± 3.0");
        assert_eq!(shown(f64::NAN, 3.0), "NaN ± 3.0");
    }
}
