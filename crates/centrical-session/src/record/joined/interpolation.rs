//! The reading of a newtonometer at a time at which it was not sampled.

use super::part::Part;
use crate::error::Error;

/// A reading at the time that was asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Reading {
    /// That of a sample.
    Sampled(f64),
    /// On the straight line between two samples.
    Interpolated(f64),
}

impl Reading {
    /// Its value.
    pub fn value(self) -> f64 {
        match self {
            Self::Sampled(value) | Self::Interpolated(value) => value,
        }
    }
}

/// The reading of a file at `t`, which is not before those asked for earlier:
/// `f0 + (f1 - f0) (t - t0) / (t1 - t0)` between the neighbours. None before the first sample, after the last, and in a gap, where
/// the neighbours are farther apart than `gap`.
pub(super) fn reading_at(part: &mut Part, t: f64, gap: f64) -> Result<Option<Reading>, Error> {
    while part.time()?.is_some_and(|time| time <= t) {
        part.pass();
    }
    Ok(match (part.before, part.time()?) {
        (Some([t0, f0]), _) if t0 == t => Some(Reading::Sampled(f0)),
        (Some([t0, f0]), Some(t1)) if t1 - t0 <= gap => {
            Some(Reading::Interpolated(f0 + (part.reading() - f0) * ((t - t0) / (t1 - t0))))
        }
        _ => None,
    })
}
