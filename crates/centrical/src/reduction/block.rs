//! The blocks of a record: equal parts of its time, each condensed to its level without spikes, and the digit and noise of its samples.

use nalgebra::Vector3;
use pulp::{Simd, WithSimd};

use super::record::RecordSlice;
use super::simd::{LANES, joined, range, sum, widest};
use crate::statistics::{MAD, cut, median, whole};

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

impl Grid {
    /// The division for a record that begins with these times. Samples that share a stamp lie between it and the next.
    pub fn new(times: &[f64]) -> Self {
        let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
        let samples_of_step = (times.len() as f64 - 1.0) / steps.len() as f64;
        let step = median(&mut steps);
        let interval = if samples_of_step > 2.0 { step / samples_of_step } else { step };
        let start = times.first().copied().unwrap_or(0.0);
        Self { start, interval, width: SHORTEST.max(SAMPLES as f64 * interval).max(step) }
    }

    /// The number of the block that an instant falls in.
    pub fn number(&self, t: f64) -> usize {
        whole((t - self.start) / self.width)
    }

    /// The middle of a block [s].
    pub fn middle(&self, number: usize) -> f64 {
        self.start + (number as f64 + 0.5) * self.width
    }

    /// The samples of a stretch, block by block.
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

    /// The number of times, in ascending order, up to the end of a block. Equal steps give the first guess; otherwise the end
    /// is searched from the beginning, since a block is short beside a stretch.
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

/// No reading is larger [m/s^2].
const LARGEST: f64 = 1e5;

/// The samples of one block of time, condensed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    /// Its number, the record's first block being 0.
    pub number: usize,
    /// Samples with a reading on every axis.
    pub readable: usize,
    /// Lowest and highest reading [m/s^2].
    pub low: Vector3<f64>,
    pub high: Vector3<f64>,
    /// Smallest step between neighbours [m/s^2]; infinite without one.
    pub step: Vector3<f64>,
    /// Readings whose own predecessor was different, and of these the ones that the next repeats.
    pub fresh: [u64; 3],
    pub repeated: [u64; 3],
    /// Mean without spikes and standard deviation of a sample from one to the next [m/s^2]; `None` for a block of too few
    /// samples.
    pub level: Option<(Vector3<f64>, Vector3<f64>)>,
}

/// The samples of one axis, condensed.
struct Axis {
    /// Whether every reading is a number.
    is_whole: bool,
    range: [f64; 2],
    step: f64,
    fresh: u64,
    repeated: u64,
    level: Option<(f64, f64)>,
}

impl Block {
    /// Condenses the samples of a block.
    pub fn of(number: usize, samples: RecordSlice) -> Self {
        let cut = cut(samples.t.len());
        let axes = samples.f_z.map(|f| widest(OneAxis { f, cut }));
        let finite = |i: &usize| samples.f_z.iter().all(|f| f[*i].is_finite());
        let whole = axes.iter().all(|axis| axis.is_whole);
        let readable = if whole { samples.t.len() } else { (0..samples.t.len()).filter(finite).count() };
        let vector = |of: fn(&Axis) -> f64| Vector3::from_fn(|k, _| of(&axes[k]));
        let [a, b, c] = axes.each_ref().map(|axis| axis.level);
        let level = a.zip(b).zip(c).map(|((a, b), c)| (Vector3::new(a.0, b.0, c.0), Vector3::new(a.1, b.1, c.1)));
        Self {
            number,
            readable,
            low: vector(|axis| axis.range[0]),
            high: vector(|axis| axis.range[1]),
            step: vector(|axis| axis.step),
            fresh: axes.each_ref().map(|axis| axis.fresh),
            repeated: axes.each_ref().map(|axis| axis.repeated),
            level,
        }
    }
}

/// The samples of one axis, and the limit for spikes in standard deviations.
struct OneAxis<'a> {
    f: &'a [f64],
    cut: f64,
}

impl WithSimd for OneAxis<'_> {
    type Output = Axis;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Axis {
        let Self { f, cut } = self;
        let [low, high] = range(f);
        // A converted unit leaves steps of f64's own rounding. What is larger than any reading is the sign of a lost one, such as 1e30, and
        // hides no step.
        let rounding = (low.abs().max(high.abs()).min(LARGEST) * 1e-12).max(f64::MIN_POSITIVE);
        let Walk { sum, step, fresh, repeated, squares } = Walk::along(f, low, rounding);
        // Half-filled blocks lie beside a gap: too few samples for a median that a spike cannot move.
        let level = if f.len() > SAMPLES / 2 { level(f, sum, [low, high], step, cut) } else { None };
        // White noise by its second differences, whose variance is six-fold.
        let noise = (squares / (6 * f.len().saturating_sub(2)) as f64).sqrt();
        Axis {
            is_whole: sum.is_finite(),
            range: [low, high],
            step,
            fresh,
            repeated,
            level: level.map(|level| (level, noise)),
        }
    }
}

/// Sums and counts along the readings.
struct Walk {
    /// Sum of the readings above the lowest.
    sum: f64,
    /// The smallest step above a limit; infinite without one.
    step: f64,
    /// Readings different from the one before, and of these the ones that the next repeats: a long run counts once.
    fresh: u64,
    repeated: u64,
    /// Sum of the squared second differences.
    squares: f64,
}

impl Walk {
    /// In one pass, in lanes: each reading with the next and the one after.
    #[inline(always)]
    fn along(f: &[f64], low: f64, limit: f64) -> Self {
        let [mut sums, mut steps, mut squares] = [[0.0; LANES], [f64::INFINITY; LANES], [0.0; LANES]];
        let [mut fresh, mut repeated] = [[0_u64; LANES]; 2];
        let with_step = f.len().saturating_sub(1);
        let with_two = f.len().saturating_sub(2) / LANES * LANES;
        let smaller = |step: f64, d: f64| if d.abs() > limit && d.abs() < step { d.abs() } else { step };
        let three = [0, 1, 2].map(|k| f[k.min(f.len())..][..with_two].as_chunks::<LANES>().0);
        for ((these, next), after) in three[0].iter().zip(three[1]).zip(three[2]) {
            for lane in 0..LANES {
                let (before, after) = (next[lane] - these[lane], after[lane] - next[lane]);
                let is_fresh = before != 0.0;
                sums[lane] += these[lane] - low;
                steps[lane] = smaller(steps[lane], before);
                fresh[lane] += u64::from(is_fresh);
                repeated[lane] += u64::from(is_fresh && after == 0.0);
                squares[lane] += (after - before) * (after - before);
            }
        }
        for i in with_two..f.len() {
            let lane = i % LANES;
            sums[lane] += f[i] - low;
            if i < with_step {
                let before = f[i + 1] - f[i];
                steps[lane] = smaller(steps[lane], before);
                if let Some(after) = f.get(i + 2).map(|after| after - f[i + 1]) {
                    let is_fresh = before != 0.0;
                    fresh[lane] += u64::from(is_fresh);
                    repeated[lane] += u64::from(is_fresh && after == 0.0);
                    squares[lane] += (after - before) * (after - before);
                }
            }
        }
        Self {
            sum: joined(sums, |a, b| a + b),
            step: joined(steps, f64::min),
            fresh: fresh.iter().sum(),
            repeated: repeated.iter().sum(),
            squares: squares.iter().sum(),
        }
    }
}

/// Mean of the values without spikes. A mean, since the median of part of a revolution is not a linear function of
/// its phase. The sum of the values above the lowest and their smallest step are given. `None` if the values are too few.
#[inline(always)]
fn level(f: &[f64], above_low: f64, [low, high]: [f64; 2], step: f64, cut: f64) -> Option<f64> {
    let count = f.len() as f64;
    let mean = low + above_low / count;
    if mean.is_finite() && (high - low).is_finite() {
        // The least robust spread with which the value farthest from the mean is not a spike. If half the values are at
        // least as far from the mean, the spread reaches it, and there are no spikes.
        let least = (high - mean).max(mean - low) / (cut * MAD);
        if 2.0 * sum(f, |value| f64::from(u8::from((value - mean).abs() < least))) <= count {
            return Some(mean);
        }
    }
    let mut values: Vec<f64> = f.iter().copied().filter(|value| value.is_finite()).collect();
    (values.len() > SAMPLES / 2).then(|| level_without_spikes(&mut values, step))
}

fn level_without_spikes(values: &mut [f64], step: f64) -> f64 {
    let middle = median(values);
    let mut sizes: Vec<f64> = values.iter().map(|value| (value - middle).abs()).collect();
    // Rounding leaves no spread if half of the noise is within half a step.
    let limit = cut(values.len()) * MAD * median(&mut sizes).max(0.5 * step);
    let good = values.iter().filter(|value| (*value - middle).abs() <= limit);
    let (count, sum) = good.fold((0.0, 0.0), |(count, sum), value| (count + 1.0, sum + (value - middle)));
    middle + sum / count
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noisy(n: usize) -> Vec<f64> {
        (0..n).map(|i| 9.81 + 1e-3 * ((i * i * 7919 % 1009) as f64 / 1009.0 - 0.5)).collect()
    }

    #[test]
    fn the_short_way_to_a_level_is_the_long_way() {
        let mut f = noisy(100);
        let step = 1e-6;
        let level = |f: &[f64]| level(f, sum(f, |value| value - range(f)[0]), range(f), step, cut(f.len())).unwrap();
        assert!((level(&f) - level_without_spikes(&mut f.clone(), step)).abs() < 1e-14);
        f[3] += 1.0;
        assert_eq!(level(&f), level_without_spikes(&mut f.clone(), step));
        assert!((level(&f) - 9.81).abs() < 2e-4);
    }

    /// One reading in ten is rounded up: the level is a tenth of a step higher, and none of them is a spike.
    #[test]
    fn a_rounded_reading_is_no_spike() {
        let mut f: Vec<f64> = (0..100).map(|i| f64::from(u8::from(i % 10 == 0))).collect();
        assert!((level_without_spikes(&mut f.clone(), 1.0) - 0.1).abs() < 1e-14);
        f[7] = 1000.0;
        assert!((level_without_spikes(&mut f, 1.0) - 10.0 / 99.0).abs() < 1e-14);
    }

    #[test]
    fn readings_that_are_no_numbers_are_not_counted() {
        let mut f = noisy(40);
        f[7] = f64::NAN;
        let block = Block::of(0, RecordSlice { t: &vec![0.0; 40], f_z: [&f; 3] });
        assert_eq!(block.readable, 39);
        assert!((block.level.unwrap().0.x - 9.81).abs() < 2e-4);
        f[..36].fill(f64::NAN);
        let block = Block::of(0, RecordSlice { t: &vec![0.0; 40], f_z: [&f; 3] });
        assert!(block.level.is_none());
    }

    #[test]
    fn runs_count_once() {
        for before in 0..20 {
            // A rise before, so that some of them fall into the lanes and some behind.
            let rise = (0..before).map(|i| f64::from(i - before));
            let f: Vec<f64> = rise.chain([0.0, 1.0, 1.0, 1.0, 1.0, 3.0, 4.0, 4.0, 3.75]).collect();
            let Walk { sum, step, fresh, repeated, squares } = Walk::along(&f, f[0], 1e-12);
            assert_eq!((step, fresh, repeated), (0.25, u64::try_from(before).unwrap() + 3, 2), "{before}");
            assert_eq!(sum, f.iter().map(|value| value - f[0]).sum::<f64>());
            let second: f64 = f.windows(3).map(|f| (f[2] - 2.0 * f[1] + f[0]).powi(2)).sum();
            assert_eq!(squares, second);
            let all_differ = Walk::along(&f, f[0], 0.5);
            assert_eq!(all_differ.step, 1.0);
        }
        let one = Walk::along(&[1.0], 1.0, 0.0);
        assert_eq!((one.sum, one.step, one.fresh, one.squares), (0.0, f64::INFINITY, 0, 0.0));
    }
}
