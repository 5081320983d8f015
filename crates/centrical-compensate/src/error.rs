//! Why readings cannot be compensated.

use thiserror::Error;

/// Why an error model has no certain inverse over a range.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum NotInvertible {
    /// A term acts on, or takes the sign of, an axis that is not there.
    #[error("term {term}: found axis {axis}, expected 0, 1 or 2")]
    Axis {
        /// Index of the term.
        term: usize,
        /// The axis.
        axis: usize,
    },
    /// A coefficient is not finite.
    #[error("term {term}: found coefficient {coefficient}, expected a finite number")]
    Coefficient {
        /// Index of the term.
        term: usize,
        /// The coefficient.
        coefficient: f64,
    },
    /// A term takes the sign of a component without being zero where the component is: the reading jumps there.
    #[error(
        "term {term}: found the sign of f{} without a power of it, expected a term without a jump",
        axis + 1
    )]
    Jump {
        /// Index of the term.
        term: usize,
        /// The component.
        axis: usize,
    },
    /// The range is not positive or not finite.
    #[error("range: found {range} m/s^2, expected a positive finite number")]
    Range {
        /// The range [m/s^2].
        range: f64,
    },
    /// The gain at zero is singular: the unit does not see some direction.
    #[error("the gain at zero is singular: the readings do not show all three components")]
    Singular,
    /// The non-linear terms are too strong for the range.
    #[error(
        "over twice the range the gain changes by up to {gain_change:.3} of the gain at zero, expected at most \
         {limit:.3}: the inverse is certain over {factor:.3} of this range, within {:.1} m/s^2",
        certain_range(*factor, *range)
    )]
    TooNonlinear {
        /// Bound on the change of gain.
        gain_change: f64,
        /// [`crate::GAIN_CHANGE_LIMIT`].
        limit: f64,
        /// Part of the range over which the inverse is certain.
        factor: f64,
        /// The range [m/s^2].
        range: f64,
    },
}

impl NotInvertible {
    /// The range that could be asked for [m/s^2], if any.
    pub fn certain_range(&self) -> Option<f64> {
        match self {
            Self::TooNonlinear { factor, range, .. } if *factor > 0.0 => Some(certain_range(*factor, *range)),
            _ => None,
        }
    }
}

/// A little below the range: rounded up, the inverse would not be certain there.
fn certain_range(factor: f64, range: f64) -> f64 {
    0.999 * factor * range
}

/// A reading that no specific force within the range gives.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error(
    "reading ({}, {}, {}) m/s^2: expected that of a specific force within {range} m/s^2 on each axis",
    reading[0], reading[1], reading[2]
)]
pub struct OutOfRange {
    /// The reading [m/s^2].
    pub reading: [f64; 3],
    /// The range [m/s^2].
    pub range: f64,
}

/// As many rows of specific forces as of readings are needed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("found {readings} rows of readings and {forces} of specific forces, expected as many of both")]
pub struct UnequalRows {
    /// Rows of readings.
    pub readings: usize,
    /// Rows of specific forces.
    pub forces: usize,
}

/// Arrays of readings of unequal lengths.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("found {}, {} and {} readings on axes 1, 2, 3, expected as many on each", lengths[0], lengths[1], lengths[2])]
pub struct UnequalLengths {
    /// Readings on each axis.
    pub lengths: [usize; 3],
}
