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
