//! Slow rotation among rests, as a session and its result state it.

use centrical::reduction::{Arc, PlateauMean};
use serde::{Deserialize, Serialize};
use toml_edit::InlineTable;

use super::form::TurningTable;
use super::toml_path::TomlPath;
use crate::error::Error;
use crate::units::Dimension;

/// Arcs of slow rotation that count as rests.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Turning {
    /// Number of arcs among the rests.
    pub arcs: usize,
    /// Their part of all weight along the force, 0 to 1.
    pub share: f64,
    /// Fastest rotation of the force against the unit [rad/s].
    pub rate: f64,
    /// Largest distance of the proof masses from the axes of rotation [m].
    pub radius: f64,
    /// Standard uncertainty of the acceleration along the vertical in the arc where it is largest [m/s^2].
    pub acceleration: f64,
}

impl Turning {
    /// Slow rotation among `rests`, with proof masses up to `radius` from the axes [m]; `None` without an arc.
    pub(crate) fn of<'r>(rests: impl IntoIterator<Item = &'r PlateauMean>, radius: f64) -> Option<Self> {
        let (mut all, mut of_arcs) = (0.0, 0.0);
        let mut turning = Self { arcs: 0, share: 0.0, rate: 0.0, radius, acceleration: 0.0 };
        for rest in rests {
            let along = rest.mean.normalize();
            let weight = 1.0 / along.dot(&(rest.covariance * along));
            all += weight;
            let Some(Arc { rate, bend_z }) = rest.arc else { continue };
            of_arcs += weight;
            turning.arcs += 1;
            turning.rate = turning.rate.max(rate);
            turning.acceleration = turning.acceleration.max(bend_z.norm() * turning.place_uncertainty());
        }
        (turning.arcs > 0).then_some(Self { share: of_arcs / all, ..turning })
    }

    /// Standard uncertainty of each coordinate of the place of the proof masses from the axes [m]: of a rectangular distribution up to the
    /// largest distance (GUM, 4.3.7).
    pub(crate) fn place_uncertainty(&self) -> f64 {
        self.radius / 3_f64.sqrt()
    }

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

    /// As an experiment file states it, every number to its last digit.
    pub(crate) fn inline_table(&self) -> InlineTable {
        let Self { arcs, share, rate, radius, acceleration } = self;
        let mut table = InlineTable::new();
        table.insert("arcs", i64::try_from(*arcs).unwrap_or(i64::MAX).into());
        table.insert("share", (*share).into());
        table.insert("rate", format!("{rate:?} rad/s").into());
        table.insert("radius", format!("{radius:?} m").into());
        table.insert("acceleration", format!("{acceleration:?} m/s^2").into());
        table
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
            radius: zero_to("turning.radius", &table.radius, Dimension::Length, MOST_DISTANT, DISTANCE)?,
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
pub(crate) const MOST_DISTANT: f64 = 10.0;

/// What a distance from an axis of rotation is expected to be.
pub(super) const DISTANCE: &str = "a distance of 0 to 10 m";
