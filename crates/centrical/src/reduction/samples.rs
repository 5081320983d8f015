//! The samples of a plateau's window, and what is looked up in them before and after the fit.

use std::borrow::Cow;
use std::ops::Range;

use nalgebra::Vector3;
use pulp::{Simd, WithSimd};

use super::blocks::{Blocks, MAD, cut, median, whole};
use super::cells::CELLS;
use super::lanes::widest;
use super::regression::Regression;
use super::saturation::standing;
use super::shape::Shape;
use super::stuck::stuck_on_any_axis;
use super::window::Window;
use super::{LeftOut, RecordSlice, ReductionError};

/// Samples of a cell that show its median.
const OF_CELL: usize = 64;

/// Samples of a window that show their spread.
const OF_WINDOW: usize = 4096;

/// Samples of a window.
pub(super) struct Samples<'a> {
    pub window: &'a Window,
    /// Last digit of the readings [m/s^2].
    pub digit: &'a Vector3<f64>,
    /// White noise of a sample [m/s^2].
    pub white: &'a Vector3<f64>,
    pub t: Cow<'a, [f64]>,
    pub f_z: [Cow<'a, [f64]>; 3],
    /// The stuck ones, if there are any.
    pub stuck: Option<Vec<bool>>,
    /// Some of all, that show their spread.
    shown: Shown,
    /// Samples with the stamp of the one before.
    repeated: usize,
    /// Sampling interval [s].
    pub interval: f64,
}

/// Some of a window's samples with their design.
struct Shown {
    columns: Vec<Vec<f64>>,
    f_z: [Vec<f64>; 3],
}

impl<'a> Samples<'a> {
    /// The samples of a record in a window, without repeated stamps.
    pub fn cut_out(record: RecordSlice<'a>, window: &'a Window, blocks: &'a Blocks) -> Self {
        let RecordSlice { t, f_z } = record.between(window.span);
        let came = t.len();
        let (t, f_z) = if widest(Steps { t, least: f64::MIN_POSITIVE }) == came.saturating_sub(1) {
            (Cow::from(t), f_z.map(Cow::from))
        } else {
            let first_of_stamp = |i: &usize| *i == 0 || t[*i] > t[*i - 1];
            let pick = |values: &[f64]| -> Cow<[f64]> {
                (0..t.len()).filter(first_of_stamp).map(|i| values[i]).collect::<Vec<f64>>().into()
            };
            (pick(t), f_z.map(pick))
        };
        let stuck = stuck_on_any_axis(f_z.each_ref().map(|f| &**f), &blocks.repeat_rate);
        let shown = Shown::of(&window.shape, &t, f_z.each_ref().map(|f| &**f));
        let (repeated, interval) = (came - t.len(), blocks.interval);
        Self { window, digit: &blocks.digit, white: &blocks.sample_noise, t, f_z, stuck, shown, repeated, interval }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.t.len()
    }

    /// Samples of each cell: the times do not decrease.
    pub fn cells(&self) -> Vec<Range<usize>> {
        let [from, to] = self.window.span;
        let cell = |t: f64| whole((t - from) / (to - from) * CELLS as f64).min(CELLS - 1);
        let mut start = 0;
        let end_of = |k: usize| self.t.partition_point(|t| cell(*t) <= k);
        (0..CELLS).map(|k| std::mem::replace(&mut start, end_of(k))..end_of(k)).collect()
    }

    /// A fit through the medians of the cells, which no spike moves. The once-per-revolution term is not in it: cells
    /// may be longer than a revolution. A cell of many samples shows its median by some of them.
    pub fn fit_of_medians(&self) -> Vec<Vector3<f64>> {
        let [from, to] = self.window.span;
        let shape = Shape { omega: 0.0, ..self.window.shape };
        let (mut middles, mut medians) = (Vec::new(), Vec::new());
        for (cell, range) in self.cells().into_iter().enumerate().filter(|(_, range)| !range.is_empty()) {
            let readings = |axis: usize| {
                let shown = spread_out(range.len(), OF_CELL).map(|i| self.f_z[axis][range.start + i]);
                median(&mut shown.filter(|f| f.is_finite()).collect::<Vec<f64>>())
            };
            middles.push(from + (cell as f64 + 0.5) * (to - from) / CELLS as f64);
            medians.push(Vector3::from_fn(|axis, _| readings(axis)));
        }
        Regression::new(shape.columns(&middles)).map_or(vec![], |regression| regression.solve(&medians))
    }

    /// How large a residual of a good sample may be, the last terms having these coefficients. The spread is seen by some
    /// thousands of samples.
    pub fn limits(&self, coefficients: &[Vector3<f64>]) -> Vector3<f64> {
        let cut = cut(self.len());
        // Rounding moves a reading by a digit at most, and may leave no spread to see.
        Vector3::from_fn(|axis, _| cut * MAD * self.shown.median_residual(coefficients, axis) + self.digit[axis])
    }

    /// What is not used, by kind, `rejected` being the samples that came and are not. Samples that never came are counted
    /// by the intervals between those that did.
    pub fn left_out(&self, rejected: usize) -> LeftOut {
        let is_readable = |i: &usize| self.f_z.iter().all(|f| f[*i].is_finite());
        let unreadable = if rejected == 0 { 0 } else { (0..self.len()).filter(|i| !is_readable(i)).count() };
        let stuck = self.stuck.as_ref().map_or(0, |stuck| stuck.iter().filter(|stuck| **stuck).count());
        let gap = 1.5 * self.interval;
        let missing = if widest(Steps { t: &self.t, least: gap }) == 0 { 0 } else { self.samples_in_gaps(gap) };
        LeftOut {
            spikes: rejected.saturating_sub(unreadable + stuck),
            stuck,
            missing: unreadable + missing,
            repeated: self.repeated,
        }
    }

    /// Samples that never came: in steps of at least so long.
    fn samples_in_gaps(&self, least: f64) -> usize {
        let gaps = self.t.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step >= least);
        gaps.map(|step| whole((step / self.interval).round()) - 1).sum()
    }

    /// Why most samples cannot be used.
    pub fn unsteady(&self, index: usize, good: usize) -> ReductionError {
        let (window, samples) = (self.window.span, self.len());
        let (axis, (value, stuck)) = [0, 1, 2]
            .map(|axis| (axis, standing(&self.f_z[axis])))
            .into_iter()
            .max_by_key(|most| most.1.1)
            .unwrap_or_default();
        // Most: a lesser number of equal readings does not keep the others from being averaged.
        if 3 * stuck > samples {
            ReductionError::Stuck { index, window, axis, value, samples, stuck }
        } else {
            ReductionError::Unsteady { index, window, samples, good }
        }
    }
}

/// Steps of time that are at least so long, to be counted.
struct Steps<'a> {
    t: &'a [f64],
    least: f64,
}

impl WithSimd for Steps<'_> {
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> usize {
        let steps = self.t.iter().zip(self.t.get(1..).unwrap_or_default()).map(|(before, after)| after - before);
        steps.map(|step| usize::from(step >= self.least)).sum()
    }
}

impl Shown {
    fn of(shape: &Shape, t: &[f64], f_z: [&[f64]; 3]) -> Self {
        let pick = |values: &[f64]| -> Vec<f64> { spread_out(t.len(), OF_WINDOW).map(|i| values[i]).collect() };
        Self { columns: shape.columns(&pick(t)), f_z: f_z.map(pick) }
    }

    /// Median size of the residuals on an axis, the last terms having these coefficients.
    fn median_residual(&self, coefficients: &[Vector3<f64>], axis: usize) -> f64 {
        let columns = &self.columns[self.columns.len() - coefficients.len()..];
        let residual = |i: usize| {
            let fitted: f64 = columns.iter().zip(coefficients).map(|(column, b)| b[axis] * column[i]).sum();
            self.f_z[axis][i] - fitted
        };
        let sizes = (0..self.f_z[axis].len()).map(|i| residual(i).abs()).filter(|size| size.is_finite());
        median(&mut sizes.collect::<Vec<f64>>())
    }
}

/// `count` of the numbers up to `all`, or all of them: one in each of equal ranges, here and there in it, so that nothing
/// periodic is always seen at the same phase.
fn spread_out(all: usize, count: usize) -> impl Iterator<Item = usize> {
    let step = all.div_ceil(count).max(1);
    (0..all).step_by(step).enumerate().map(move |(k, i)| (i + k * 7919 % step).min(all - 1))
}
