//! First pass: a record as block levels.

use nalgebra::Vector3;

use super::stuck::repeat_rate;
use super::{Record, ReductionError};

/// Shortest block [s]: a centrifuge's arm changes its speed in seconds, not in tenths.
const SHORTEST: f64 = 0.1;

/// Samples in a block: fewer, and a spike moves the median.
const SAMPLES: usize = 8;

/// A record in equal blocks of time; blocks that fall in a gap are left out.
#[derive(Debug, Clone)]
pub(super) struct Blocks {
    /// Width of a block [s].
    pub width: f64,
    /// Sampling interval [s]: the median one.
    pub interval: f64,
    /// Middle of each block [s].
    pub t: Vec<f64>,
    /// Mean reading of each block, spikes left out [m/s^2].
    pub f_z: Vec<Vector3<f64>>,
    /// Last digit of the readings [m/s^2].
    pub digit: Vector3<f64>,
    /// Share of readings that repeat the one before by chance.
    pub repeat_rate: [f64; 3],
    /// Standard deviation of a single sample from one to the next, whatever the ramps and the colour [m/s^2].
    pub sample_noise: Vector3<f64>,
}

impl Blocks {
    /// Summarises a record.
    pub fn summarise(record: &Record) -> Result<Self, ReductionError> {
        check(record)?;
        let t = &record.t;
        let mut steps: Vec<f64> = t.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
        let interval = median(&mut steps);
        let width = SHORTEST.max(SAMPLES as f64 * interval);
        let mut blocks = Self {
            width,
            interval,
            t: Vec::new(),
            f_z: Vec::new(),
            digit: Vector3::from_fn(|axis, _| last_digit(&record.f_z[axis])),
            repeat_rate: [0, 1, 2].map(|axis| repeat_rate(&record.f_z[axis])),
            sample_noise: Vector3::zeros(),
        };
        let mut noise: [Vec<f64>; 3] = Default::default();
        let (mut values, mut from) = (Vec::new(), 0);
        while from < t.len() {
            let number = ((t[from] - t[0]) / width).floor();
            let to = from + t[from..].partition_point(|time| ((time - t[0]) / width).floor() <= number);
            // Half-filled blocks stand beside a gap: too few samples for a median that a spike cannot move.
            if to - from > SAMPLES / 2 {
                blocks.push(record, from..to, t[0] + (number + 0.5) * width, &mut values, &mut noise);
            }
            from = to;
        }
        if blocks.t.len() < 3 {
            let readable = |i: &usize| record.f_z.iter().all(|f| f[*i].is_finite());
            return Err(ReductionError::TooShort {
                found: (0..t.len()).filter(readable).count(),
                expected: 3 * SAMPLES,
            });
        }
        for (axis, spreads) in noise.iter_mut().enumerate() {
            blocks.sample_noise[axis] = median(spreads).max(blocks.digit[axis] / 12_f64.sqrt());
        }
        Ok(blocks)
    }

    fn push(
        &mut self,
        record: &Record,
        range: std::ops::Range<usize>,
        middle: f64,
        values: &mut Vec<f64>,
        noise: &mut [Vec<f64>; 3],
    ) {
        let mut level = Vector3::zeros();
        for axis in 0..3 {
            let f = &record.f_z[axis][range.clone()];
            values.clear();
            values.extend(f.iter().filter(|value| value.is_finite()));
            if values.len() <= SAMPLES / 2 {
                return;
            }
            level[axis] = level_without_spikes(values);
            let second: f64 = f.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).powi(2)).sum();
            // White noise: the variance of a second difference is six-fold.
            let variance = second / (6 * (f.len() - 2)) as f64;
            if variance.is_finite() {
                noise[axis].push(variance.sqrt());
            }
        }
        self.t.push(middle);
        self.f_z.push(level);
    }

    /// Number of blocks.
    pub fn len(&self) -> usize {
        self.t.len()
    }
}

/// The whole part of a number of blocks, cells or revolutions, none below zero.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
pub(super) fn whole(number: f64) -> usize {
    number.max(0.0) as usize
}

/// Normal law: standard deviation over median absolute value.
pub(crate) const MAD: f64 = 1.482_602_218_505_602;

/// Median; of an even number the upper of the middle two. Zero of none.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Mean of the values that are no spikes. A mean, since the median of part of a revolution is no linear function of
/// its phase.
fn level_without_spikes(values: &mut [f64]) -> f64 {
    let middle = median(values);
    let mut sizes: Vec<f64> = values.iter().map(|value| (value - middle).abs()).collect();
    let limit = cut(values.len()) * MAD * median(&mut sizes);
    let good = values.iter().filter(|value| (*value - middle).abs() <= limit);
    let (count, sum) = good.fold((0.0, 0.0), |(count, sum), value| (count + 1.0, sum + (value - middle)));
    middle + sum / count
}

/// How many standard deviations are too many among `n` good samples: less than one in twenty such sets has one beyond
/// it, since the normal law leaves less than `exp(-c^2 / 2)` beyond `c`.
pub(crate) fn cut(n: usize) -> f64 {
    (2.0 * (20.0 * n as f64).ln()).sqrt()
}

/// Last digit: the smallest step between neighbours.
fn last_digit(f: &[f64]) -> f64 {
    let largest = f.iter().filter(|value| value.is_finite()).fold(0.0, |largest: f64, value| largest.max(value.abs()));
    // A converted unit leaves steps of f64's own rounding.
    let rounding = (largest * 1e-12).max(f64::MIN_POSITIVE);
    let steps = f.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|step| *step > rounding);
    let smallest = steps.fold(f64::INFINITY, f64::min);
    if smallest.is_finite() { smallest } else { rounding }
}

fn check(record: &Record) -> Result<(), ReductionError> {
    let times = record.t.len();
    let readings = [0, 1, 2].map(|axis| record.f_z[axis].len());
    if readings != [times; 3] {
        return Err(ReductionError::UnequalColumns { times, readings });
    }
    let expected = 3 * SAMPLES;
    if times < expected {
        return Err(ReductionError::TooShort { found: times, expected });
    }
    let mut before = f64::NEG_INFINITY;
    for (i, &found) in record.t.iter().enumerate() {
        if !found.is_finite() || found < before {
            return Err(ReductionError::Time { sample: i + 1, found, before });
        }
        before = found;
    }
    Ok(())
}
