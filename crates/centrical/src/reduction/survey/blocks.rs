//! A record as block levels.

use std::f64::consts::TAU;
use std::ops::Range;

use nalgebra::Vector3;

use super::block::Block;
use super::grid::{Grid, SAMPLES};
use crate::reduction::error::ReductionError;
use crate::statistics::{median, whole};

/// A record in equal blocks of time; blocks that fall in a gap are left out.
#[derive(Debug, Clone)]
pub(in crate::reduction) struct Blocks {
    /// Width of a block [s].
    pub width: f64,
    /// Sampling interval [s]: the median one of the record's beginning, unless the blocks show a much longer one.
    pub interval: f64,
    /// Middle of each block [s].
    pub t: Vec<f64>,
    /// Mean reading of each block, spikes left out [m/s^2].
    pub f_z: Vec<Vector3<f64>>,
    /// Last digit of the readings [m/s^2].
    pub digit: Vector3<f64>,
    /// Share of readings that repeat the one before by chance.
    pub repeat_rate: [f64; 3],
    /// Standard deviation of a single sample from one to the next, independent of ramps and colour [m/s^2].
    pub sample_noise: Vector3<f64>,
}

impl Blocks {
    /// Fewest blocks of a plateau at a speed [rad/s]: a revolution, and twice as many as a fit has coefficients.
    pub fn least(&self, omega: f64) -> usize {
        let revolution = if omega == 0.0 { 0.0 } else { TAU / omega.abs() / self.width };
        8.max(whole(revolution.ceil()))
    }

    /// The blocks of a record, gathered.
    pub(super) fn new(grid: &Grid, gathered: &[Block]) -> Result<Self, ReductionError> {
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
        // Constant readings show no digit.
        let digit = |axis: usize| {
            if step[axis].is_finite() { step[axis] } else { (largest(axis) * 1e-12).max(f64::MIN_POSITIVE) }
        };
        let filled = || gathered.iter().filter_map(|block| Some((block.number, block.level?)));
        // By the samples of a block: a clock that stands still at first, or stutters, misleads the first estimate.
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

    /// Median level of some blocks [m/s^2].
    pub fn level(&self, range: &Range<usize>) -> Vector3<f64> {
        let of = |axis: usize| median(&mut self.f_z[range.clone()].iter().map(|f| f[axis]).collect::<Vec<f64>>());
        Vector3::from_fn(|axis, _| of(axis))
    }
}
