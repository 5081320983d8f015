//! The record as every estimator reads it: phase points x with tau0 between them.

use std::ops::Range;

use super::error::NoiseError;
use crate::progress::{OnProgress, advance};
use crate::statistics::PIECE;

/// Phase x_0 .. x_N: the running integral of the readings, less their mean.
///
/// For a newtonometer the readings are specific force (m/s^2) and the phase is velocity (m/s); the field's words
/// "phase" and "frequency" are kept because its formulas and tables use them. No estimator of the Allan family sees
/// the mean, and taking it off first keeps the integral small, so a long record loses no digits.
#[derive(Debug, Clone, PartialEq)]
pub struct Phase {
    x: Vec<f64>,
    tau0: f64,
    /// Filled readings before each phase point; `None` without filled readings.
    filled_before: Option<Vec<u32>>,
    gaps: BridgedGaps,
}

/// Missing readings inside a record, which were filled.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct BridgedGaps {
    /// Runs of missing readings.
    pub runs: usize,
    /// Missing readings in all.
    pub missing: usize,
    /// Missing readings in the longest run.
    pub longest: usize,
}

impl Phase {
    /// Phase points given as such, `tau0` seconds apart.
    ///
    /// # Errors
    /// [`NoiseError`] if `tau0` is not positive, fewer than 3 points are given or one is not finite.
    pub fn new(x: Vec<f64>, tau0: f64) -> Result<Self, NoiseError> {
        check_interval(tau0)?;
        if x.len() < 3 {
            return Err(NoiseError::TooShort { found: x.len(), expected: 3 });
        }
        match x.iter().position(|value| !value.is_finite()) {
            Some(index) => Err(NoiseError::NotFinite { index, found: x[index] }),
            None => Ok(Self { x, tau0, filled_before: None, gaps: BridgedGaps::default() }),
        }
    }

    /// The integral of readings taken every `tau0` seconds: x_(k+1) = x_k + (y_k - mean) tau0.
    ///
    /// A reading that is not finite is missing. Missing readings at the ends are cut off. A straight line between the
    /// means of the readings within L on either side bridges a gap of length L. For white noise it adds less variance
    /// than the missing readings had; a line between the two neighbours alone would add more. [`Phase::gaps`] counts
    /// the bridged readings; the estimators built on differences omit every term with more than a tenth of them.
    /// `progress` is asked between the passes over the readings.
    ///
    /// # Errors
    /// [`NoiseError`] if `tau0` is not positive or fewer than 2 readings are finite; [`NoiseError::Stopped`].
    pub fn integrate(readings: &[f64], tau0: f64, progress: OnProgress<()>) -> Result<Self, NoiseError> {
        check_interval(tau0)?;
        let is_seen = |y: &f64| y.is_finite();
        let (Some(first), Some(last)) = (readings.iter().position(is_seen), readings.iter().rposition(is_seen)) else {
            return Err(NoiseError::NoSamples { found: readings.len() });
        };
        let readings = &readings[first..=last];
        if readings.len() < 2 {
            return Err(NoiseError::TooShort { found: readings.len(), expected: 2 });
        }
        let runs = missing_runs(readings);
        let gaps = BridgedGaps {
            runs: runs.len(),
            missing: runs.iter().map(ExactSizeIterator::len).sum(),
            longest: runs.iter().map(ExactSizeIterator::len).max().unwrap_or(0),
        };
        advance(progress, ())?;
        let mean = mean_of_seen(readings);
        advance(progress, ())?;
        let mut x = Vec::with_capacity(readings.len() + 1);
        x.push(0.0);
        x.extend(readings.iter().map(|y| (y - mean) * tau0));
        for run in &runs {
            bridge(readings, run, |k, y| x[k + 1] = (y - mean) * tau0);
        }
        for k in 1..x.len() {
            if k % PIECE == 0 {
                advance(progress, ())?;
            }
            x[k] += x[k - 1];
        }
        advance(progress, ())?;
        let filled_before = (!runs.is_empty()).then(|| count_filled(readings));
        Ok(Self { x, tau0, filled_before, gaps })
    }

    /// The phase points.
    pub fn points(&self) -> &[f64] {
        &self.x
    }

    /// Interval between phase points, s.
    pub fn tau0(&self) -> f64 {
        self.tau0
    }

    /// The missing readings that were bridged.
    pub fn gaps(&self) -> BridgedGaps {
        self.gaps
    }

    /// Averaging factors 1, 2, 4, ... up to the largest that leaves `intervals` of them in the record.
    pub fn octaves(&self, intervals: usize) -> Vec<usize> {
        let largest = (self.x.len() - 1) / intervals.max(1);
        std::iter::successors(Some(1), |m| Some(2 * m)).take_while(|&m| m <= largest).collect()
    }

    /// Whether at most a tenth of the readings between the points `from` and `to` was filled.
    pub(super) fn is_seen(&self, from: usize, to: usize) -> bool {
        self.filled_before.as_ref().is_none_or(|before| 10 * (before[to] - before[from]) as usize <= to - from)
    }
}

fn check_interval(tau0: f64) -> Result<(), NoiseError> {
    if tau0.is_finite() && tau0 > 0.0 { Ok(()) } else { Err(NoiseError::BadInterval { found: tau0 }) }
}

/// The runs of readings that are missing.
pub(super) fn missing_runs(readings: &[f64]) -> Vec<Range<usize>> {
    let mut runs = Vec::new();
    let mut k = 0;
    while k < readings.len() {
        let start = k;
        while k < readings.len() && !readings[k].is_finite() {
            k += 1;
        }
        if k > start {
            runs.push(start..k);
        }
        k += 1;
    }
    runs
}

fn mean_of_seen(readings: &[f64]) -> f64 {
    // Two passes: the second removes the rounding of the first.
    let seen = || readings.iter().filter(|y| y.is_finite());
    let count = seen().count() as f64;
    let mean = seen().sum::<f64>() / count;
    mean + seen().map(|y| y - mean).sum::<f64>() / count
}

/// Hands `set` the value of every reading of the run: the line between the means of up to as many on either side.
fn bridge(readings: &[f64], run: &Range<usize>, mut set: impl FnMut(usize, f64)) {
    let side = run.len().min(run.start).min(readings.len() - run.end);
    let before = mean_of_seen(&readings[run.start - side..run.start]);
    let after = mean_of_seen(&readings[run.end..run.end + side]);
    let slope = (after - before) / (run.len() + side) as f64;
    for (k, index) in run.clone().enumerate() {
        set(index, before + slope * (0.5 * side as f64 + k as f64 + 0.5));
    }
}

fn count_filled(readings: &[f64]) -> Vec<u32> {
    let mut count = 0;
    std::iter::once(0)
        .chain(readings.iter().map(|y| {
            count += u32::from(!y.is_finite());
            count
        }))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::unwatched;

    #[test]
    fn the_integral_of_a_ramp_bridges_its_gap_exactly() {
        let ramp: Vec<f64> = (0..20).map(f64::from).collect();
        let mut gapped = ramp.clone();
        gapped[7..11].fill(f64::NAN);
        let (whole, bridged) =
            (Phase::integrate(&ramp, 0.5, &unwatched).unwrap(), Phase::integrate(&gapped, 0.5, &unwatched).unwrap());
        assert_eq!(bridged.gaps(), BridgedGaps { runs: 1, missing: 4, longest: 4 });
        // The means differ, so the phases differ by a straight line that second differences do not see.
        let bend = |p: &Phase, k: usize| p.x[k] - 2.0 * p.x[k - 1] + p.x[k - 2];
        assert!((2..21).all(|k| (bend(&whole, k) - bend(&bridged, k)).abs() < 1e-12));
        assert!(bridged.is_seen(0, 7) && !bridged.is_seen(6, 12) && whole.is_seen(6, 12));
    }

    #[test]
    fn what_cannot_be_analysed_is_refused() {
        assert!(Phase::integrate(&[f64::NAN; 5], 1.0, &unwatched).is_err());
        assert!(Phase::integrate(&[1.0, 2.0, 3.0], 0.0, &unwatched).is_err());
        assert!(Phase::new(vec![0.0, f64::INFINITY, 1.0], 1.0).is_err());
    }
}
