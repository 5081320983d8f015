//! Slow rotation among rests, as the result states it.

use serde::{Deserialize, Serialize};

use crate::experiment::{Session, Turning};

/// Arcs of slow rotation that count as rests.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TurningSummary {
    /// Number of arcs among the rests.
    pub arcs: usize,
    /// Their part of all weight along the force, 0 to 1.
    pub share: f64,
    /// Fastest rotation of the force against the unit [rad/s].
    pub rate: f64,
    /// Largest distance of the proof masses from the axis of rotation, as it was stated [m].
    pub radius: f64,
    /// Standard uncertainty of an acceleration common to all rests, in each axis of the unit [m/s^2].
    pub acceleration: f64,
}

impl TurningSummary {
    /// The slow rotation of all tables of rests: the number of its arcs, and the largest of all else.
    pub(crate) fn of(session: &Session) -> Option<Self> {
        let all = session.rest_tables.iter().filter_map(|table| table.turning);
        let joined = all.reduce(|one, other| Turning {
            arcs: one.arcs + other.arcs,
            share: one.share.max(other.share),
            rate: one.rate.max(other.rate),
            radius: one.radius.max(other.radius),
            acceleration: one.acceleration.max(other.acceleration),
        });
        let Turning { arcs, share, rate, radius, acceleration } = joined?;
        Some(Self { arcs, share, rate, radius, acceleration })
    }
}
