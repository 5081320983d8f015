//! One block of a record, condensed: its level without spikes, and what its samples tell of their digits and noise.

use nalgebra::Vector3;
use pulp::{Simd, WithSimd};

use super::blocks::{MAD, SAMPLES, cut, median};
use super::lanes::{fold, range, sum, widest};
use super::record::RecordSlice;

/// What is kept of the samples of one block of time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    /// Its number, the record's first block being 0.
    pub number: usize,
    /// Samples with a reading on every axis.
    pub readable: usize,
    /// Lowest and highest reading [m/s^2].
    pub low: Vector3<f64>,
    pub high: Vector3<f64>,
    /// Smallest step between neighbours [m/s^2]; infinite where there is none.
    pub step: Vector3<f64>,
    /// Readings whose own predecessor was different, and of these the ones that the next repeats.
    pub fresh: [u64; 3],
    pub repeated: [u64; 3],
    /// Mean without spikes and standard deviation of a sample from one to the next [m/s^2]; none of a block of too few
    /// samples.
    pub level: Option<(Vector3<f64>, Vector3<f64>)>,
}

/// What is kept of the samples of one axis.
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
    /// Condenses the samples of a block; `differences` is room to work in.
    pub fn of(number: usize, samples: RecordSlice, differences: &mut Vec<f64>) -> Self {
        let axes = samples.f_z.map(|f| widest(OneAxis { f, differences }));
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

/// The samples of one axis, with room to work in.
struct OneAxis<'a> {
    f: &'a [f64],
    differences: &'a mut Vec<f64>,
}

impl WithSimd for OneAxis<'_> {
    type Output = Axis;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Axis {
        let Self { f, differences } = self;
        let [low, high] = range(f);
        differences.clear();
        differences.extend(f.windows(2).map(|pair| pair[1] - pair[0]));
        // A converted unit leaves steps of f64's own rounding.
        let rounding = (low.abs().max(high.abs()) * 1e-12).max(f64::MIN_POSITIVE);
        let (fresh, repeated) = repeats(differences);
        // Half-filled blocks stand beside a gap: too few samples for a median that a spike cannot move.
        let level = if f.len() > SAMPLES / 2 { level(f, [low, high]) } else { None };
        let level = level.map(|level| (level, noise(differences)));
        let is_whole = sum(f, |value| value).is_finite();
        Axis { is_whole, range: [low, high], step: smallest_above(differences, rounding), fresh, repeated, level }
    }
}

/// The smallest size above a limit; infinite if there is none.
#[inline(always)]
fn smallest_above(differences: &[f64], limit: f64) -> f64 {
    let smaller = |smallest: f64, d: f64| if d.abs() > limit && d.abs() < smallest { d.abs() } else { smallest };
    fold(differences, f64::INFINITY, smaller, f64::min)
}

/// Readings different from the one before, and of these the ones that the next repeats: a long run counts once.
#[inline(always)]
fn repeats(differences: &[f64]) -> (u64, u64) {
    let pairs = differences.iter().zip(differences.get(1..).unwrap_or_default());
    pairs.fold((0, 0), |(fresh, repeated), (before, after)| {
        let is_fresh = *before != 0.0;
        (fresh + u64::from(is_fresh), repeated + u64::from(is_fresh && *after == 0.0))
    })
}

/// Standard deviation of white noise by its second differences, whose variance is six-fold.
#[inline(always)]
fn noise(differences: &[f64]) -> f64 {
    let (before, after) = (&differences[..differences.len() - 1], &differences[1..]);
    let mut lanes = [0.0; 8];
    for (a, b) in before.chunks(lanes.len()).zip(after.chunks(lanes.len())) {
        for ((lane, a), b) in lanes.iter_mut().zip(a).zip(b) {
            *lane += (b - a) * (b - a);
        }
    }
    (lanes.iter().sum::<f64>() / (6 * before.len()) as f64).sqrt()
}

/// Mean of the values that are no spikes. A mean, since the median of part of a revolution is no linear function of
/// its phase. `None` of too few values.
#[inline(always)]
fn level(f: &[f64], [low, high]: [f64; 2]) -> Option<f64> {
    let count = f.len() as f64;
    let mean = low + sum(f, |value| value - low) / count;
    if mean.is_finite() && (high - low).is_finite() {
        // What the robust spread must be at least for the value farthest from the mean to be no spike. If it is that,
        // half the values being at least so far from the mean, there are no spikes to look for.
        let least = (high - mean).max(mean - low) / (cut(f.len()) * MAD);
        if 2.0 * sum(f, |value| f64::from(u8::from((value - mean).abs() < least))) <= count {
            return Some(mean);
        }
    }
    let mut values: Vec<f64> = f.iter().copied().filter(|value| value.is_finite()).collect();
    (values.len() > SAMPLES / 2).then(|| level_without_spikes(&mut values))
}

fn level_without_spikes(values: &mut [f64]) -> f64 {
    let middle = median(values);
    let mut sizes: Vec<f64> = values.iter().map(|value| (value - middle).abs()).collect();
    let limit = cut(values.len()) * MAD * median(&mut sizes);
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
        let level = |f: &[f64]| level(f, range(f)).unwrap();
        assert!((level(&f) - level_without_spikes(&mut f.clone())).abs() < 1e-14);
        f[3] += 1.0;
        assert_eq!(level(&f), level_without_spikes(&mut f.clone()));
        assert!((level(&f) - 9.81).abs() < 2e-4);
    }

    #[test]
    fn readings_that_are_no_numbers_are_not_counted() {
        let mut f = noisy(40);
        f[7] = f64::NAN;
        let block = Block::of(0, RecordSlice { t: &vec![0.0; 40], f_z: [&f; 3] }, &mut Vec::new());
        assert_eq!(block.readable, 39);
        assert!((block.level.unwrap().0.x - 9.81).abs() < 2e-4);
        f[..36].fill(f64::NAN);
        let block = Block::of(0, RecordSlice { t: &vec![0.0; 40], f_z: [&f; 3] }, &mut Vec::new());
        assert!(block.level.is_none());
    }

    #[test]
    fn runs_count_once() {
        assert_eq!(repeats(&[1.0, 0.0, 0.0, 0.0, 2.0, 1.0, 0.0]), (3, 2));
        assert_eq!(smallest_above(&[1.0, -0.25, 0.0, 1e-20, 2.0], 1e-12), 0.25);
    }
}
