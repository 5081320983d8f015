//! Mountings and what was set on them.

use std::path::Path;

use centrical::{Mounting, Position, Rotation, SetPoint};
use nalgebra::Vector3;

use super::form::{MountingTable, PlateauEntry};
use super::speeds;
use super::toml_path::TomlPath;
use crate::error::{Error, quoted};
use crate::quantity::Quantity;
use crate::units::Dimension;

/// Speeds above this [rad/s], a million revolutions a minute, are a mistaken unit.
pub(crate) const FASTEST: f64 = 1.1e5;

/// No arm is longer [m].
const LONGEST_ARM: f64 = 50.0;

/// Shortest and longest plateau [s].
const DURATIONS: (f64, f64) = (1e-3, 1e7);

/// The mountings in the order of the file. Every position must be mounted, or its parameters are nowhere.
pub(crate) fn mountings(file: &Path, tables: &[MountingTable], positions: &[Position]) -> Result<Vec<Mounting>, Error> {
    let mut mountings = Vec::with_capacity(tables.len());
    for (m, table) in tables.iter().enumerate() {
        let at = TomlPath::entry(file, "mounting", m);
        let position = positions.iter().position(|p| p.id == table.position).ok_or_else(|| {
            let known: Vec<&str> = positions.iter().map(|p| p.id.as_str()).collect();
            let found = format!("unknown position {}", quoted(table.position.as_bytes()));
            at.unexpected("position", found, format!("one of {}", known.join(", ")))
        })?;
        let arm = at.point("arm", &table.arm, LONGEST_ARM)?;
        if arm[0] < 0.0 {
            let expected = "a radius arm[0] of zero or more (turn the unit with another position instead)";
            return Err(at.unexpected("arm", format!("{arm:?}"), expected));
        }
        mountings.push(Mounting { position, arm_y: Vector3::from(arm) });
    }
    for (k, position) in positions.iter().enumerate() {
        if !mountings.iter().any(|m| m.position == k) {
            let found = format!("position {:?} without a mounting", position.id);
            return Err(TomlPath::entry(file, "position", k).unexpected(
                "id",
                found,
                "a [[mounting]] for every position",
            ));
        }
    }
    Ok(mountings)
}

/// The set points of all mountings.
pub(crate) fn set_points(file: &Path, tables: &[MountingTable], rotation: Rotation) -> Result<Vec<SetPoint>, Error> {
    let mut set_points = Vec::new();
    for (mounting, table) in tables.iter().enumerate() {
        let at = TomlPath::entry(file, "mounting", mounting);
        if table.plateaus.is_empty() {
            return Err(at.unexpected("plateaus", "an empty schedule", "at least one plateau"));
        }
        for (index, entry) in table.plateaus.iter().enumerate() {
            let (speed, angle) = plateau(&at, index, entry)?;
            let key = format!("plateaus {} speed_uncertainty", index + 1);
            let own = entry.speed_uncertainty.as_ref().map(|q| speeds::of_plateau(&at, &key, q)).transpose()?;
            // The sum makes -0 a 0.
            set_points.push(SetPoint {
                mounting,
                omega: rotation.sign() * speed + 0.0,
                angle,
                speed_uncertainty: own.filter(|_| speed != 0.0),
                ..SetPoint::default()
            });
        }
    }
    Ok(set_points)
}

/// Largest angle of the arm at rest [rad]: 180 without a unit is 29 turns.
const TWO_TURNS: f64 = 4.0 * std::f64::consts::PI;

/// Speed [rad/s] and angle [rad] of plateau number `index`, from 0.
fn plateau(at: &TomlPath, index: usize, entry: &PlateauEntry) -> Result<(f64, f64), Error> {
    let key = |name: &str| format!("plateaus {} {name}", index + 1);
    let meaning = "a speed from -1e6 to 1e6 rpm, positive in the direction of `rotation` in [centrifuge]";
    let speed = at.bounded(&key("speed"), &entry.speed, Dimension::Speed, (-FASTEST, FASTEST), meaning)?;
    match (&entry.angle, speed == 0.0) {
        (Some(angle), true) => {
            let meaning = "an angle from -720 deg to 720 deg; a number alone is in rad";
            Ok((0.0, at.bounded(&key("angle"), angle, Dimension::Angle, (-TWO_TURNS, TWO_TURNS), meaning)?))
        }
        (None, true) => Err(at.unexpected(&key("angle"), "no angle", "the carousel angle of a plateau at rest")),
        (None, false) => Ok((speed, 0.0)),
        (Some(angle), false) => {
            let expected = "no angle while spinning: the readings do not depend on it";
            Err(at.unexpected(&key("angle"), angle.to_string(), expected))
        }
    }
}

/// Duration stated for each plateau [s], in the order of the set points.
pub(crate) fn durations(file: &Path, mountings: &[MountingTable]) -> Result<Vec<Option<f64>>, Error> {
    let mut durations = Vec::new();
    for (m, mounting) in mountings.iter().enumerate() {
        let at = TomlPath::entry(file, "mounting", m);
        for (index, plateau) in mounting.plateaus.iter().enumerate() {
            let key = format!("plateaus {} duration", index + 1);
            durations.push(duration(&at, &key, plateau.duration.as_ref())?);
        }
    }
    Ok(durations)
}

/// A duration of a plateau [s].
pub(crate) fn duration(at: &TomlPath, key: &str, quantity: Option<&Quantity>) -> Result<Option<f64>, Error> {
    let bounded = |q| at.bounded(key, q, Dimension::Time, DURATIONS, "a duration from 1 ms to 1e7 s");
    quantity.map(bounded).transpose()
}
