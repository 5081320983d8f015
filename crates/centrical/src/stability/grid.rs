//! From time stamps to a regular grid: repeated samples dropped, missing ones marked, both counted.

use super::error::NoiseError;
use crate::progress::{OnProgress, Stopped, advance};
use crate::statistics::{PIECE, watched_median, whole};

/// Readings on a regular grid.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Grid {
    /// Sampling interval, s.
    pub interval: f64,
    /// One reading per grid point; NaN where it is missing.
    pub readings: Vec<f64>,
    /// Samples dropped because their grid point was taken by an earlier one.
    pub repeated: usize,
}

impl Grid {
    /// Lays the readings `y`, taken at the times `t` (s), on a regular grid.
    ///
    /// The first interval is the median step. Each step counts as its nearest whole number of intervals; a step below
    /// half is a repeated sample and is dropped. The mean over the span then refines the interval, so that steps
    /// printed with few digits do not drift off the grid. Non-finite readings are missing ones. `progress` is called
    /// repeatedly.
    ///
    /// # Errors
    /// [`NoiseError`]:
    /// - if `t` and `y` differ in length, or hold fewer than 3 samples;
    /// - if `t` is not finite, or runs backwards;
    /// - if fewer than half of the spanned grid points have a sample;
    /// - if more than a hundredth of the samples are repeated but differ ([`NoiseError::CoarseStamps`]);
    /// - if the interval changes by more than a hundredth ([`NoiseError::ChangingRate`]);
    /// - if the caller stops ([`NoiseError::Stopped`]).
    pub fn of(t: &[f64], y: &[f64], progress: OnProgress<()>) -> Result<Grid, NoiseError> {
        check(t, y)?;
        let mut steps: Vec<f64> = t.windows(2).map(|pair| pair[1] - pair[0]).filter(|&step| step > 0.0).collect();
        let step = watched_median(&mut steps, progress)?;
        let Places { kept: places, repeated, differing } = Places::of(t, y, step, progress)?;
        if 100 * differing > t.len().max(1000) {
            return Err(NoiseError::CoarseStamps { found: differing, samples: t.len() });
        }
        let span = places.last().map_or(0, |&(place, _)| place + 1);
        if span > 2 * places.len() {
            return Err(NoiseError::MostlyMissing { found: places.len(), span });
        }
        let mut readings = vec![f64::NAN; span];
        for &(place, sample) in &places {
            readings[place] = y[sample];
        }
        let interval = places.last().map_or(step, |&(place, sample)| (t[sample] - t[0]) / place as f64);
        check_rate(t, &places, interval)?;
        Ok(Grid { interval, readings, repeated })
    }
}

fn check(t: &[f64], y: &[f64]) -> Result<(), NoiseError> {
    if t.len() != y.len() {
        return Err(NoiseError::Unpaired { times: t.len(), readings: y.len() });
    }
    if t.len() < 3 {
        return Err(NoiseError::TooShort { found: t.len(), expected: 3 });
    }
    if !t[0].is_finite() {
        return Err(NoiseError::NotFinite { index: 0, found: t[0] });
    }
    match (1..t.len()).find(|&i| !t[i].is_finite() || t[i] < t[i - 1]) {
        Some(index) => Err(NoiseError::TimeOrder { index, found: t[index], previous: t[index - 1] }),
        None if t[t.len() - 1] > t[0] => Ok(()),
        None => Err(NoiseError::BadInterval { found: 0.0 }),
    }
}

/// Refuses an interval that changes: in parts of the record it is off its mean by a hundredth, and by more than two stamps of the part.
fn check_rate(t: &[f64], places: &[(usize, usize)], interval: f64) -> Result<(), NoiseError> {
    const PARTS: usize = 16;
    for part in places.chunks(places.len().div_ceil(PARTS).max(2)) {
        let [(from, first), .., (to, last)] = *part else { continue };
        let (span, regular) = (t[last] - t[first], (to - from) as f64 * interval);
        if (span - regular).abs() > (0.01 * regular).max(2.0 * interval) {
            let found = span / (to - from) as f64;
            return Err(NoiseError::ChangingRate { found, place: 0.5 * (t[first] + t[last]), interval });
        }
    }
    Ok(())
}

/// Where samples fall on the grid.
struct Places {
    /// `(grid point, sample)` of every sample kept.
    kept: Vec<(usize, usize)>,
    /// Repeated samples.
    repeated: usize,
    /// Repeated samples whose reading differs from the one kept.
    differing: usize,
}

impl Places {
    fn of(t: &[f64], y: &[f64], interval: f64, progress: OnProgress<()>) -> Result<Self, Stopped> {
        let mut places = vec![(0, 0)];
        let (mut place, mut last, mut repeated, mut differing) = (0, 0, 0, 0);
        for (sample, &time) in t.iter().enumerate().skip(1) {
            if sample % PIECE == 0 {
                advance(progress, ())?;
            }
            let steps = ((time - t[last]) / interval).round();
            if steps < 1.0 {
                repeated += 1;
                differing += usize::from(y[sample].is_finite() && y[last].is_finite() && y[sample] != y[last]);
                continue;
            }
            // A span beyond memory is refused by the caller.
            place += whole(steps.min(1e15));
            last = sample;
            places.push((place, sample));
        }
        Ok(Self { kept: places, repeated, differing })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::unwatched;

    #[test]
    fn missing_samples_are_marked_and_repeated_ones_dropped() {
        let t = [0.0, 0.1, 0.2, 0.2, 0.5, 0.6, 0.70001];
        let grid = Grid::of(&t, &[1.0, 2.0, 3.0, 9.0, 6.0, 7.0, 8.0], &unwatched).unwrap();
        assert_eq!(grid.repeated, 1);
        assert_eq!(grid.readings.len(), 8);
        assert!(grid.readings[3].is_nan() && grid.readings[4].is_nan());
        assert_eq!(grid.readings[5..], [6.0, 7.0, 8.0]);
        assert!((grid.interval - 0.70001 / 7.0).abs() < 1e-15);
    }

    #[test]
    fn a_step_printed_with_few_digits_does_not_drift() {
        // 3 kHz printed to 0.1 ms: a median step of 0.3 ms would lose a tenth of the grid points.
        let t: Vec<f64> = (0..30_000).map(|i| (f64::from(i) / 3000.0 * 1e4).round() / 1e4).collect();
        let grid = Grid::of(&t, &vec![0.5; t.len()], &unwatched).unwrap();
        assert_eq!(grid.readings.len(), 30_000);
        assert!((grid.interval * 3000.0 - 1.0).abs() < 1e-5);
    }

    /// 3 kHz with stamps in milliseconds, and a rate that drops: either would scale the noise by the wrong interval.
    #[test]
    fn wrong_intervals_are_refused() {
        let readings: Vec<f64> = (0..30_000).map(|i| f64::from(i * 7919 % 131)).collect();
        let coarse: Vec<f64> = (0..30_000).map(|i| (f64::from(i) / 3000.0 * 1e3).floor() / 1e3).collect();
        assert!(matches!(Grid::of(&coarse, &readings, &unwatched), Err(NoiseError::CoarseStamps { .. })));
        let same = vec![1.0; 30_000];
        assert!(!matches!(Grid::of(&coarse, &same, &unwatched), Err(NoiseError::CoarseStamps { .. })));
        let slower = |i: i32| f64::from(i) * 0.01 + f64::from((i - 15_000).max(0)) * 0.004;
        let changing: Vec<f64> = (0..30_000).map(slower).collect();
        assert!(matches!(Grid::of(&changing, &readings, &unwatched), Err(NoiseError::ChangingRate { .. })));
        // A clock that is fast by a thousandth for half of the record changes no rate.
        let drifting: Vec<f64> =
            (0..30_000).map(|i| f64::from(i) * 0.01 + f64::from((i - 15_000).max(0)) * 1e-5).collect();
        assert!(Grid::of(&drifting, &readings, &unwatched).is_ok());
    }

    #[test]
    fn errors_name_the_sample() {
        let error = Grid::of(&[0.0, 0.2, 0.1], &[0.0; 3], &unwatched).unwrap_err();
        assert_eq!(error.to_string(), "sample 2: found time 0.1 s after 0.2 s, expected an increasing time");
        assert!(Grid::of(&[0.0, 0.1], &[0.0; 2], &unwatched).is_err());
        assert!(Grid::of(&[0.0, 0.1, 0.2, 99.0], &[0.0; 4], &unwatched).is_err());
    }
}
