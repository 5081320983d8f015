//! First pass: a record, stretch by stretch, becomes blocks. A reader of a file needs to hold little of it.

use std::f64::consts::TAU;
use std::ops::Range;

use nalgebra::Vector3;
use statrs::function::erf::erf;

use super::block::{Block, Grid, SAMPLES};
use super::error::ReductionError;
use super::record::{Record, RecordSlice};
use crate::statistics::{median, whole};

/// The blocks of a record, gathered stretch by stretch.
#[derive(Debug, Clone)]
pub struct Survey {
    grid: Grid,
    blocks: Vec<Block>,
    /// Samples of the block that the next stretch may continue, and its number.
    open: Record,
    number: usize,
    /// Stated resolution of the readings [m/s^2]; 0 if it is not stated.
    resolution: f64,
}

/// A condensed stretch: its first and last block may be incomplete, and keep their samples.
#[derive(Debug, Clone)]
pub struct Condensed {
    first: (usize, Record),
    whole: Vec<Block>,
    last: Option<(usize, Record)>,
}

/// Lowest and highest readings about an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extremes {
    /// The instant [s].
    pub t: f64,
    /// Lowest readings of newtonometers 1, 2, 3 [m/s^2].
    pub low: Vector3<f64>,
    /// Highest readings [m/s^2].
    pub high: Vector3<f64>,
}

/// A record in equal blocks of time; blocks that fall in a gap are left out.
#[derive(Debug, Clone)]
pub(super) struct Blocks {
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
    /// Share of readings that repeat the one before by chance; 1 where rounding may hide the noise.
    pub repeat_rate: [f64; 3],
    /// Standard deviation of a single sample from one to the next, independent of ramps and colour [m/s^2].
    pub sample_noise: Vector3<f64>,
    /// The same in each block, on the axes that show it [m/s^2].
    noise: Vec<Vector3<f64>>,
}

impl Survey {
    /// Samples that a survey needs to begin, if the record has them: their times give the sampling interval.
    pub const BEGINNING: usize = 4096;

    /// Begins with the first times of a record; those after the first [`Survey::BEGINNING`] are ignored.
    pub fn new(times: &[f64]) -> Self {
        let grid = Grid::new(&times[..times.len().min(Self::BEGINNING)]);
        Self { grid, blocks: Vec::new(), open: Record::default(), number: 0, resolution: 0.0 }
    }

    /// The survey of a record in memory.
    ///
    /// # Errors
    /// [`ReductionError`] if the record is invalid: lengths, times.
    pub fn of(record: RecordSlice) -> Result<Self, ReductionError> {
        check(record)?;
        let mut survey = Self::new(record.t);
        survey.append(survey.condense(record));
        survey.finish();
        Ok(survey)
    }

    /// The same with the smallest step of the readings stated [m/s^2]. Readings that stand still by no more than their
    /// rounding are not taken for stuck.
    #[must_use]
    pub fn with_resolution(self, resolution: f64) -> Self {
        Self { resolution, ..self }
    }

    /// Condenses a stretch: nearly all the work, independent of other stretches.
    pub fn condense(&self, stretch: RecordSlice) -> Condensed {
        let mut parts = self.grid.divide(stretch);
        let of = |part: Option<(usize, RecordSlice)>| {
            part.map(|(number, samples)| {
                let mut record = Record::default();
                record.extend(samples);
                (number, record)
            })
        };
        let first = of(parts.next()).unwrap_or_default();
        let mut whole = Vec::new();
        let mut last = None;
        for part in parts {
            if let Some((number, samples)) = last.replace(part) {
                whole.push(Block::of(number, samples));
            }
        }
        Condensed { first, whole, last: of(last) }
    }

    /// Adds the next stretch, in the order of the record.
    pub fn append(&mut self, stretch: Condensed) {
        let (number, samples) = stretch.first;
        self.go_on(number, &samples);
        if let Some((number, samples)) = stretch.last {
            self.close();
            self.blocks.extend(stretch.whole);
            self.go_on(number, &samples);
        }
    }

    /// Adds samples to a block, which may be the open one.
    fn go_on(&mut self, number: usize, samples: &Record) {
        if number != self.number {
            self.close();
            self.number = number;
        }
        self.open.extend(samples.as_slice());
    }

    fn close(&mut self) {
        if !self.open.t.is_empty() {
            self.blocks.push(Block::of(self.number, self.open.as_slice()));
            self.open.clear();
        }
    }

    /// The range of the readings, block by block.
    pub fn extremes(&self) -> impl Iterator<Item = Extremes> {
        let extremes = |block: &Block| Extremes { t: self.grid.middle(block.number), low: block.low, high: block.high };
        self.blocks.iter().map(extremes)
    }

    /// Ends the first pass.
    pub fn finish(&mut self) {
        self.close();
    }

    /// The blocks of all stretches together.
    pub(super) fn blocks(&self) -> Result<Blocks, ReductionError> {
        let (grid, gathered, resolution) = (&self.grid, &self.blocks, self.resolution);
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
        // Constant readings show no digit: it is the stated one, if one is stated.
        let digit = |axis: usize| {
            if step[axis].is_finite() {
                step[axis]
            } else {
                (largest(axis) * 1e-12).max(f64::MIN_POSITIVE).max(resolution)
            }
        };
        let filled = || gathered.iter().filter_map(|block| Some((block.number, block.level?)));
        // By the samples of a block: a clock that stands still at first, or stutters, misleads the first estimate.
        let mut counts: Vec<f64> = gathered.iter().map(|block| block.readable as f64).collect();
        let by_blocks = grid.width / median(&mut counts).max(1.0);
        let mut blocks = Blocks {
            width: grid.width,
            interval: if 2.0 * grid.interval > by_blocks { grid.interval } else { by_blocks },
            t: filled().map(|(number, _)| grid.middle(number)).collect(),
            f_z: filled().map(|(_, (level, _))| level).collect(),
            digit: Vector3::from_fn(|axis, _| digit(axis)),
            // Rule of succession: a rate is never known to be 0 or 1.
            repeat_rate: [0, 1, 2].map(|axis| (repeated[axis] as f64 + 1.0) / (fresh[axis] as f64 + 2.0)),
            sample_noise: Vector3::zeros(),
            noise: filled().map(|(_, (_, noise))| noise).collect(),
        };
        if blocks.t.len() < 3 {
            let found: usize = gathered.iter().map(|block| block.readable).sum();
            let half = 0.5 * blocks.width;
            if let (Some(from), Some(to), true) = (blocks.t.first(), blocks.t.last(), found >= 3 * SAMPLES) {
                return Err(ReductionError::TimeStands { samples: found, from: from - half, to: to + half });
            }
            return Err(ReductionError::TooShort { found, expected: 3 * SAMPLES });
        }
        for axis in 0..3 {
            let noise = filled().map(|(_, (_, noise))| noise[axis]).filter(|noise| noise.is_finite());
            let quietest = noise.clone().filter(|noise| *noise > 0.0).reduce(f64::min).unwrap_or(0.0);
            let noise = median(&mut noise.collect::<Vec<f64>>());
            // A step that two blocks have may be that of one spike, at their edge.
            let has_step = |block: &&Block| block.step[axis] < step[axis] * (1.0 + 1e-6);
            let is_digit = step[axis].is_finite() && gathered.iter().filter(has_step).count() > 2;
            let rounded_to = if is_digit { step[axis].max(resolution) } else { resolution };
            let by_rounding = repeats_by_rounding(quietest, rounded_to);
            blocks.repeat_rate[axis] = blocks.repeat_rate[axis].max(by_rounding);
            blocks.sample_noise[axis] = noise.max(blocks.digit[axis] / 12_f64.sqrt());
        }
        Ok(blocks)
    }
}

/// Shortest rest [s]: a hand that turns back stands still for less.
const SHORTEST_REST: f64 = 0.8;

impl Blocks {
    /// Fewest blocks of a plateau at a speed [rad/s]: a revolution, and twice as many as a fit has coefficients.
    pub fn least(&self, omega: f64) -> usize {
        let revolution = if omega == 0.0 { 0.0 } else { TAU / omega.abs() / self.width };
        8.max(whole(revolution.ceil()))
    }

    /// Fewest blocks of a rest: of [`SHORTEST_REST`], and one beside those at its ends, which may hold the onset of motion.
    pub fn least_of_rest(&self) -> usize {
        3.max(whole((SHORTEST_REST / self.width).ceil()))
    }

    /// Standard deviation of a single sample in some blocks: that of the record, unless half of these blocks are far quieter, as a rest
    /// is among speeds that vibrate [m/s^2].
    pub fn sample_noise_in(&self, range: &Range<usize>) -> Vector3<f64> {
        const FAR_QUIETER: f64 = 0.5;
        Vector3::from_fn(|axis, _| {
            let noise = self.noise[range.clone()].iter().map(|noise| noise[axis]).filter(|noise| noise.is_finite());
            let here = median(&mut noise.collect::<Vec<f64>>()).max(self.digit[axis] / 12_f64.sqrt());
            if here < FAR_QUIETER * self.sample_noise[axis] { here } else { self.sample_noise[axis] }
        })
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

/// Refuses an invalid record: columns of different lengths, too few samples, time that runs backwards.
fn check(record: RecordSlice) -> Result<(), ReductionError> {
    let times = record.t.len();
    let readings = record.f_z.map(<[f64]>::len);
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

/// Share of readings that are equal, at most, if noise is rounded to a `step`: `erf(step / (2 sqrt(2) sigma))` with the
/// level in the middle between two roundings. Rounding adds a spread of half a step at most, at a level where half of
/// the readings are rounded up: `sigma^2` is `spread^2 - step^2 / 4` at least. The spread is that of the quietest block that
/// is not constant: in others the level moves, as the arm turns. A spread below half a step may come from rounding alone:
/// then a reading may stand for any time. Without a step no two readings are equal.
fn repeats_by_rounding(spread: f64, step: f64) -> f64 {
    let variance = spread * spread - 0.25 * step * step;
    if step == 0.0 {
        0.0
    } else if variance > 0.0 {
        erf(step / (8.0 * variance).sqrt())
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::repeats_by_rounding;
    use crate::statistics::Random;

    /// Noise with the level anywhere between two steps repeats the most frequent reading no more often than stated.
    #[test]
    fn rounded_noise_repeats_no_more_than_stated() {
        const READINGS: usize = 20_000;
        let mut random = Random::stream(3, 0);
        for noise in [0.05, 0.2, 0.4, 0.6, 1.0, 3.0] {
            for level in [0.0, 0.1, 0.25, 0.4, 0.5] {
                let readings: Vec<f64> = (0..READINGS).map(|_| (level + noise * random.normal()).round()).collect();
                let mean = readings.iter().sum::<f64>() / READINGS as f64;
                let variance = readings.iter().map(|f| (f - mean) * (f - mean)).sum::<f64>() / READINGS as f64;
                let share = |value: f64| readings.iter().filter(|f| **f == value).count() as f64 / READINGS as f64;
                let most = [-1.0, 0.0, 1.0].map(share).into_iter().fold(0.0, f64::max);
                // Four standard deviations of a share.
                let stated = repeats_by_rounding(variance.sqrt(), 1.0) + 2.0 / (READINGS as f64).sqrt();
                assert!(most <= stated, "noise {noise}, level {level}: {most} above {stated}");
            }
        }
    }

    #[test]
    fn fine_digits_seldom_repeat() {
        assert!(repeats_by_rounding(10.0, 1.0) < 0.05);
        assert_eq!((repeats_by_rounding(1.0, 0.0), repeats_by_rounding(0.0, 0.0)), (0.0, 0.0));
    }
}
