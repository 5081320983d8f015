//! The table `[uncertainty]`: what the laboratory states of the quantities that the fit takes as exact.

use std::path::Path;

use centrical::uncertainty::TypeB;

use super::form::UncertaintyTable;
use super::speeds::Speeds;
use super::toml_path::TomlPath;
use crate::error::Error;
use crate::quantity::{Dimension, Quantity};

/// Standard uncertainties, SI; `plateau_speed` is the same as `speed_uncertainty` of `[centrifuge]` or absent, and
/// `speed_scale` the same as the scale of measured speeds, where both are stated.
pub(crate) fn type_b(file: &Path, table: &UncertaintyTable, speeds: &Speeds) -> Result<TypeB, Error> {
    let plateau_speed = speeds.set_uncertainty;
    let at = TomlPath::table(file, "uncertainty");
    let read = |key: &str, quantity: &Option<Quantity>, dimension, largest| {
        let meaning = "a standard uncertainty, zero or more and not beyond reason";
        quantity.as_ref().map(|q| at.bounded(key, q, dimension, (0.0, largest), meaning)).transpose()
    };
    // Beyond these a unit was mistaken: 1 m, 1 rad, 10 m/s^2, 100 %.
    let length = |key, quantity| read(key, quantity, Dimension::Length, 1.0);
    let angle = |key, quantity| read(key, quantity, Dimension::Angle, 1.0);
    let acceleration = |key, quantity| read(key, quantity, Dimension::Acceleration, 10.0);
    let ratio = |key, quantity| read(key, quantity, Dimension::Ratio, 1.0);
    let radius = length("radius", &table.radius)?.unwrap_or(0.0);
    let radius_difference = length("radius_difference", &table.radius_difference)?;
    if let Some(difference) = radius_difference.filter(|d| *d > std::f64::consts::SQRT_2 * radius) {
        let expected = "at most sqrt(2) times radius, the difference of seats measured independently";
        return Err(at.unexpected("radius_difference", format!("{difference} m"), expected));
    }
    if let Some(speed) = ratio("plateau_speed", &table.plateau_speed)?.filter(|speed| *speed != plateau_speed) {
        let expected = format!("{plateau_speed}, the speed_uncertainty of [centrifuge], or nothing");
        return Err(at.unexpected("plateau_speed", speed.to_string(), expected));
    }
    let speed_scale = ratio("speed_scale", &table.speed_scale)?;
    let of_measured = speeds.measured.and_then(|measured| measured.scale);
    if let (Some(stated), Some(scale)) = (speed_scale, of_measured)
        && stated != scale
    {
        let expected = format!("{scale}, the scale of measured speeds in [centrifuge], or nothing");
        return Err(at.unexpected("speed_scale", stated.to_string(), expected));
    }
    Ok(TypeB {
        gravity: acceleration("gravity", &table.gravity)?.unwrap_or(0.0),
        latitude: angle("latitude", &table.latitude)?.unwrap_or(0.0),
        radius,
        radius_difference,
        speed_scale: speed_scale.unwrap_or(speeds.scale()),
        rest_angle: angle("rest_angle", &table.rest_angle)?.unwrap_or(0.0),
        proof_masses: length("proof_masses", &table.proof_masses)?.unwrap_or(0.0),
        attitude: angle("attitude", &table.attitude)?.unwrap_or(0.0),
        resolution: acceleration("resolution", &table.resolution)?.unwrap_or(0.0),
        doubt: ratio("doubt", &table.doubt)?.unwrap_or(0.0),
    })
}
