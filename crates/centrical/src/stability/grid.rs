//! From time stamps to a regular grid: repeated samples dropped, missing ones marked, both counted.

use super::error::NoiseError;
use crate::progress::{OnProgress, Stopped, advance};
use crate::statistics::{PIECE, watched_median, whole};

/// Readings on a regular grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
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
    /// The interval is first the median step; every step counts for the nearest whole number of intervals (a step of
    /// less than half an interval is a repeated sample, which is dropped); then the interval is refined to the mean over
    /// the span, so a step printed with few digits does not drift off the grid. Non-finite readings are missing ones. `progress` is asked
    /// again and again.
    ///
    /// # Errors
    /// [`NoiseError`] if `t` and `y` differ in length, hold fewer than 3 samples, `t` is not finite or runs backwards,
    /// or fewer than half of the spanned grid points have a sample; [`NoiseError::Stopped`].
    pub fn of(t: &[f64], y: &[f64], progress: OnProgress<()>) -> Result<Grid, NoiseError> {
        check(t, y)?;
        let mut steps: Vec<f64> = t.windows(2).map(|pair| pair[1] - pair[0]).filter(|&step| step > 0.0).collect();
        let step = watched_median(&mut steps, progress)?;
        let (places, repeated) = places(t, step, progress)?;
        let span = places.last().map_or(0, |&(place, _)| place + 1);
        if span > 2 * places.len() {
            return Err(NoiseError::MostlyMissing { found: places.len(), span });
        }
        let mut readings = vec![f64::NAN; span];
        for &(place, sample) in &places {
            readings[place] = y[sample];
        }
        let interval = places.last().map_or(step, |&(place, sample)| (t[sample] - t[0]) / place as f64);
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

/// `(grid point, sample)` of every sample kept, and the number of repeated samples.
fn places(t: &[f64], interval: f64, progress: OnProgress<()>) -> Result<(Vec<(usize, usize)>, usize), Stopped> {
    let mut places = vec![(0, 0)];
    let (mut place, mut last, mut repeated) = (0, t[0], 0);
    for (sample, &time) in t.iter().enumerate().skip(1) {
        if sample % PIECE == 0 {
            advance(progress, ())?;
        }
        let steps = ((time - last) / interval).round();
        if steps < 1.0 {
            repeated += 1;
            continue;
        }
        // A span beyond memory is refused by the caller.
        place += whole(steps.min(1e15));
        last = time;
        places.push((place, sample));
    }
    Ok((places, repeated))
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

    #[test]
    fn errors_name_the_sample() {
        let error = Grid::of(&[0.0, 0.2, 0.1], &[0.0; 3], &unwatched).unwrap_err();
        assert_eq!(error.to_string(), "sample 2: found time 0.1 s after 0.2 s, expected an increasing time");
        assert!(Grid::of(&[0.0, 0.1], &[0.0; 2], &unwatched).is_err());
        assert!(Grid::of(&[0.0, 0.1, 0.2, 99.0], &[0.0; 4], &unwatched).is_err());
    }
}
