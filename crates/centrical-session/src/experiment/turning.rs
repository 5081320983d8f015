//! Slow rotation among rests, as a session and its result state it.

use serde::{Deserialize, Serialize};

use super::form::TurningTable;
use super::toml_path::TomlPath;
use crate::error::Error;
use crate::quantity::Dimension;

/// Arcs of slow rotation that count as rests.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Turning {
    /// Number of arcs among the rests.
    pub arcs: usize,
    /// Their part of all weight along the force, 0 to 1.
    pub share: f64,
    /// Fastest rotation of the force against the unit [rad/s].
    pub rate: f64,
    /// Largest distance of the proof masses from the axis of rotation [m].
    pub radius: f64,
    /// Standard uncertainty of an acceleration common to all rests, in each axis of the unit [m/s^2].
    pub acceleration: f64,
}

impl Turning {
    /// That of two tables of rests: the number of all arcs, and the larger of all else.
    pub(crate) fn joined(self, other: Self) -> Self {
        Self {
            arcs: self.arcs + other.arcs,
            share: self.share.max(other.share),
            rate: self.rate.max(other.rate),
            radius: self.radius.max(other.radius),
            acceleration: self.acceleration.max(other.acceleration),
        }
    }

    /// As a table states it.
    pub(super) fn stated(at: &TomlPath, table: &TurningTable) -> Result<Self, Error> {
        let zero_to =
            |key, quantity, dimension, largest, meaning| at.bounded(key, quantity, dimension, (0.0, largest), meaning);
        if !(0.0..=1.0).contains(&table.share) {
            return Err(at.unexpected("turning.share", table.share.to_string(), "a part of the weight, 0 to 1"));
        }
        Ok(Self {
            arcs: table.arcs,
            share: table.share,
            rate: zero_to("turning.rate", &table.rate, Dimension::Speed, 1.0, "a slow rate, up to 1 rad/s")?,
            radius: zero_to(
                "turning.radius",
                &table.radius,
                Dimension::Length,
                MOST_DISTANT,
                "a distance of 0 to 10 m",
            )?,
            acceleration: zero_to(
                "turning.acceleration",
                &table.acceleration,
                Dimension::Acceleration,
                10.0,
                "a standard uncertainty from 0 to 10 m/s^2",
            )?,
        })
    }
}

/// Largest distance from an axis of rotation [m]: beyond it a unit was mistaken.
pub const MOST_DISTANT: f64 = 10.0;
