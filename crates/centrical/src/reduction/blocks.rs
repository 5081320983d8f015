//! First pass: a record as block levels.

use nalgebra::Vector3;

use super::ReductionError;
use super::block::Block;
use super::record::RecordSlice;

/// Shortest block [s]: a centrifuge's arm changes its speed in seconds, not in tenths.
const SHORTEST: f64 = 0.1;

/// Samples in a block: fewer, and a spike moves the median.
pub(super) const SAMPLES: usize = 8;

/// The division of a record's time into blocks.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    /// The record's first instant [s].
    start: f64,
    /// Sampling interval [s]; zero if all stamps of the beginning are one.
    pub interval: f64,
    /// Width of a block [s].
    pub width: f64,
}

/// A record in equal blocks of time; blocks that fall in a gap are left out.
#[derive(Debug, Clone)]
pub(super) struct Blocks {
    /// Width of a block [s].
    pub width: f64,
    /// Sampling interval [s]: the median one of the record's beginning, unless the blocks tell that it is much longer.
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

impl Grid {
    /// The division for a record that begins with these times.
    pub fn new(times: &[f64]) -> Self {
        let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
        let interval = median(&mut steps);
        let start = times.first().copied().unwrap_or(0.0);
        Self { start, interval, width: SHORTEST.max(SAMPLES as f64 * interval) }
    }

    /// The number of the block that an instant falls in.
    pub fn number(&self, t: f64) -> usize {
        whole((t - self.start) / self.width)
    }

    /// The middle of a block [s].
    pub fn middle(&self, number: usize) -> f64 {
        self.start + (number as f64 + 0.5) * self.width
    }

    /// The samples of each block that a stretch has samples of.
    pub fn divide<'a>(&self, stretch: RecordSlice<'a>) -> impl Iterator<Item = (usize, RecordSlice<'a>)> {
        let mut from = 0;
        std::iter::from_fn(move || {
            let number = self.number(*stretch.t.get(from)?);
            let to = from + self.samples_up_to(number, &stretch.t[from..]);
            let part = stretch.part(from..to);
            from = to;
            Some((number, part))
        })
    }

    /// How many of the times, that do not decrease, are in a block of that number at most: those of equal steps up to its end, or
    /// else it is looked for from the beginning, as a block is short beside a stretch.
    fn samples_up_to(&self, number: usize, t: &[f64]) -> usize {
        let is_in = |i: usize| self.number(t[i]) <= number;
        let steps = whole((self.middle(number) + 0.5 * self.width - t[0]) / self.interval);
        for end in steps..steps.saturating_add(3).min(t.len()) {
            if end > 0 && is_in(end - 1) && !is_in(end) {
                return end;
            }
        }
        let mut step = 1;
        while step < t.len() && is_in(step) {
            step *= 2;
        }
        let from = step / 2;
        from + t[from..step.min(t.len())].partition_point(|time| self.number(*time) <= number)
    }
}

impl Blocks {
    /// The blocks of a record, gathered.
    pub fn new(grid: &Grid, gathered: &[Block]) -> Result<Self, ReductionError> {
        let total = |of: fn(&Block) -> [u64; 3]| {
            gathered.iter().map(of).fold([0; 3], |sum, next| [0, 1, 2].map(|axis| sum[axis] + next[axis]))
        };
        let (fresh, repeated) = (total(|block| block.fresh), total(|block| block.repeated));
        let largest = |axis: usize| {
            gathered
                .iter()
                .map(|b| b.low[axis].abs().max(b.high[axis].abs()))
                .filter(|f| f.is_finite())
                .fold(0.0, f64::max)
        };
        let step = gathered.iter().fold(Vector3::repeat(f64::INFINITY), |step, block| step.inf(&block.step));
        // Readings that never change have no digit to see.
        let digit = |axis: usize| {
            if step[axis].is_finite() { step[axis] } else { (largest(axis) * 1e-12).max(f64::MIN_POSITIVE) }
        };
        let filled = || gathered.iter().filter_map(|block| Some((block.number, block.level?)));
        // As many samples as blocks have: a clock that stands still at first, or stutters, tells less there, or nothing.
        let mut counts: Vec<f64> = gathered.iter().map(|block| block.readable as f64).collect();
        let by_blocks = grid.width / median(&mut counts).max(1.0);
        let mut blocks = Self {
            width: grid.width,
            interval: if 2.0 * grid.interval > by_blocks { grid.interval } else { by_blocks },
            t: filled().map(|(number, _)| grid.middle(number)).collect(),
            f_z: filled().map(|(_, (level, _))| level).collect(),
            digit: Vector3::from_fn(|axis, _| digit(axis)),
            // Rule of succession: a rate is never known to be 0 or 1.
            repeat_rate: [0, 1, 2].map(|axis| (repeated[axis] as f64 + 1.0) / (fresh[axis] as f64 + 2.0)),
            sample_noise: Vector3::zeros(),
        };
        if blocks.t.len() < 3 {
            let found = gathered.iter().map(|block| block.readable).sum();
            return Err(ReductionError::TooShort { found, expected: 3 * SAMPLES });
        }
        for axis in 0..3 {
            let noise = filled().map(|(_, (_, noise))| noise[axis]).filter(|noise| noise.is_finite());
            let noise = median(&mut noise.collect::<Vec<f64>>());
            blocks.sample_noise[axis] = noise.max(blocks.digit[axis] / 12_f64.sqrt());
        }
        Ok(blocks)
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

/// How many standard deviations are too many among `n` good samples: less than one in twenty such sets has one beyond
/// it, since the normal law leaves less than `exp(-c^2 / 2)` beyond `c`.
pub(crate) fn cut(n: usize) -> f64 {
    (2.0 * (20.0 * n as f64).ln()).sqrt()
}
