//! What a record looks like: few enough numbers to keep in a result and to draw.

use centrical::reduction::Extremes;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Lowest and highest reading of each axis in equal steps of time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RecordOverview {
    /// Mounting, counted from 1 in the order of the session.
    pub mounting: usize,
    /// Start of the first step, the record's clock [s].
    pub start: f64,
    /// Length of a step [s].
    pub step: f64,
    /// Lowest reading of newtonometers 1, 2, 3 in each step [m/s^2], rounded; null in a gap.
    pub low: [Vec<Option<f32>>; 3],
    /// Highest reading of newtonometers 1, 2, 3 in each step [m/s^2], rounded; null in a gap.
    pub high: [Vec<Option<f32>>; 3],
}

impl RecordOverview {
    /// Steps of a record: about as many as a drawing across half a page can show apart.
    const STEPS: usize = 160;

    /// Overview of the record of `mounting` from its extremes in equal short times.
    pub(crate) fn of(mounting: usize, extremes: &[Extremes]) -> Self {
        let start = extremes.first().map_or(0.0, |first| first.t);
        let length = extremes.last().map_or(0.0, |last| last.t - start);
        let step = if length > 0.0 { length / Self::STEPS as f64 } else { 1.0 };
        let steps = |reading: fn(&Extremes) -> &Vector3<f64>, pick: fn(f64, f64) -> f64| {
            [0, 1, 2].map(|axis| {
                let mut steps = vec![None; Self::STEPS];
                for extremes in extremes {
                    let place = &mut steps[index((extremes.t - start) / step)];
                    let value = reading(extremes)[axis];
                    *place = Some(place.map_or(value, |other| pick(other, value)));
                }
                steps.into_iter().map(|value| value.map(rounded)).collect()
            })
        };
        let (low, high) = (steps(|e| &e.low, f64::min), steps(|e| &e.high, f64::max));
        Self { mounting, start, step, low, high }
    }
}

/// Index of a step; the record's last instant belongs to the last one.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn index(steps: f64) -> usize {
    (steps as usize).min(RecordOverview::STEPS - 1)
}

/// To five significant digits: a drawing shows no more, and the file stays small.
fn rounded(value: f64) -> f32 {
    format!("{value:.4e}").parse().unwrap_or(f32::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extremes_are_kept_and_gaps_stay_gaps() {
        let extremes = |k: i32| {
            let t = f64::from(k);
            let high = Vector3::new(t, if k == 7 { 123.456_789 } else { 1.0 }, -1.0);
            Extremes { t, low: Vector3::new(t, 1.0, -1.0), high }
        };
        let extremes: Vec<Extremes> = (0..3200).filter(|k| !(1000..1200).contains(k)).map(extremes).collect();
        let overview = RecordOverview::of(1, &extremes);
        assert_eq!(overview.high[1][0], Some(123.46));
        assert_eq!(overview.low[1][0], Some(1.0));
        assert_eq!(overview.high[0].len(), overview.low[2].len());
        assert_eq!(overview.high[0].last(), Some(&Some(3199.0)));
        assert!(overview.low[0].iter().filter(|value| value.is_none()).count() >= 9);
    }
}
