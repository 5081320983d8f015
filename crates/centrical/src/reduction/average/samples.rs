//! The samples of a plateau's window: their spread, a robust first fit, and the count of the rejected ones.

use std::borrow::Cow;
use std::f64::consts::SQRT_2;
use std::ops::Range;

use nalgebra::Vector3;

use crate::reduction::error::ReductionError;
use crate::reduction::plateau::LeftOut;
use crate::reduction::record::RecordSlice;
use crate::reduction::simd::subtract_all;
use crate::reduction::survey::Blocks;
use crate::reduction::terms::{Shape, Triangle, Window};
use crate::statistics::{MAD, Side, cut, median, standing, whole};

/// Equal intervals of a window, for the slow part of the noise.
pub(in crate::reduction) const CELLS: usize = 128;

/// Samples of a window that represent all of them, and the neighbours among these that are taken together, since the
/// memory delivers them together.
const SHOWN: usize = 4096;
const NEIGHBOURS: usize = 8;

/// Samples of a window.
pub(super) struct Samples<'a> {
    pub window: &'a Window,
    /// Last digit of the readings [m/s^2].
    pub digit: &'a Vector3<f64>,
    /// White noise of a sample [m/s^2].
    pub white: &'a Vector3<f64>,
    pub t: Cow<'a, [f64]>,
    pub f_z: [Cow<'a, [f64]>; 3],
    /// Share of readings that repeat the one before by chance.
    pub repeat_rate: [f64; 3],
    /// A subset that represents all of them.
    shown: Shown,
    /// Samples with the stamp of the one before.
    repeated: usize,
    /// Longest time from one sample to the next [s].
    longest_step: f64,
    /// Sampling interval [s].
    pub interval: f64,
}

/// A subset of a window's samples with their design.
struct Shown {
    t: Vec<f64>,
    columns: Vec<Vec<f64>>,
    f_z: [Vec<f64>; 3],
}

impl<'a> Samples<'a> {
    /// The samples of a record within a window, without the repeated stamps; `repeated` of these are already removed.
    pub fn cut_out(record: RecordSlice<'a>, repeated: usize, window: &'a Window, blocks: &'a Blocks) -> Self {
        let RecordSlice { t, f_z } = record;
        let came = t.len();
        let steps = t.windows(2).map(|pair| pair[1] - pair[0]);
        let (shortest, longest) =
            steps.fold((f64::INFINITY, 0.0_f64), |(shortest, longest), step| (shortest.min(step), longest.max(step)));
        let (t, f_z) = if shortest > 0.0 {
            (Cow::from(t), f_z.map(Cow::from))
        } else {
            let samples = record.without(&record.repeated(f64::NEG_INFINITY));
            (Cow::from(samples.t), samples.f_z.map(Cow::from))
        };
        let shown = Shown::of(&window.shape, &t, f_z.each_ref().map(|f| &**f));
        Self {
            window,
            digit: &blocks.digit,
            white: &blocks.sample_noise,
            repeat_rate: blocks.repeat_rate,
            shown,
            repeated: repeated + came - t.len(),
            longest_step: longest,
            interval: blocks.interval,
            t,
            f_z,
        }
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.t.len()
    }

    /// Samples of each cell.
    pub fn cells(&self) -> impl Iterator<Item = Range<usize>> {
        self.cells_of(&self.t)
    }

    /// The times of each cell: they do not decrease.
    fn cells_of(&self, t: &[f64]) -> impl Iterator<Item = Range<usize>> {
        let [from, to] = self.window.span;
        let cell = move |t: f64| whole((t - from) / (to - from) * CELLS as f64).min(CELLS - 1);
        let mut start = 0;
        (0..CELLS).map(move |k| {
            let end = t.partition_point(|t| cell(*t) <= k);
            std::mem::replace(&mut start, end)..end
        })
    }

    /// A fit through the medians of the cells, over the shown samples: no spike moves it. It has no once-per-revolution
    /// term, since cells may be longer than a revolution.
    pub fn fit_of_medians(&self) -> Vec<Vector3<f64>> {
        let [from, to] = self.window.span;
        let shape = Shape { omega: 0.0, ..self.window.shape };
        let (mut middles, mut medians) = (Vec::new(), [const { Vec::new() }; 3]);
        for (cell, range) in self.cells_of(&self.shown.t).enumerate().filter(|(_, range)| !range.is_empty()) {
            let readings = |axis: usize| {
                let shown = self.shown.f_z[axis][range.clone()].iter().copied();
                median(&mut shown.filter(|f| f.is_finite()).collect::<Vec<f64>>())
            };
            middles.push(from + (cell as f64 + 0.5) * (to - from) / CELLS as f64);
            medians.iter_mut().enumerate().for_each(|(axis, medians)| medians.push(readings(axis)));
        }
        Triangle::fit(shape.columns(&middles), medians).unwrap_or_default()
    }

    /// The largest residual of a good sample, the last terms having these coefficients. Some thousands of samples show
    /// the spread.
    pub fn limits(&self, coefficients: &[Vector3<f64>]) -> Vector3<f64> {
        let cut = cut(self.len());
        // Rounding moves a reading by a digit at most. It leaves no spread if half of the noise is within half a digit.
        let median = |axis: usize| self.shown.median_residual(coefficients, axis).max(0.5 * self.digit[axis]);
        Vector3::from_fn(|axis, _| cut * MAD * median(axis) + self.digit[axis])
    }

    /// The samples on both sides of a fit with these coefficients and limits, on each axis: those that are usable, cell by cell.
    pub fn sides(&self, coefficients: &[Vector3<f64>], limits: &Vector3<f64>, usable: &[bool]) -> [[Side; 2]; 3] {
        let mut sides = [[Side::default(); 2]; 3];
        for cell in self.cells() {
            let columns = self.window.shape.columns(&self.t[cell.clone()]);
            for (axis, sides) in sides.iter_mut().enumerate() {
                let residuals = residuals(&columns, self.f_z[axis][cell.clone()].to_vec(), coefficients, axis);
                for (residual, _) in residuals.into_iter().zip(&usable[cell.clone()]).filter(|(_, usable)| **usable) {
                    sides[usize::from(residual > 0.0)].count(residual.abs() / limits[axis]);
                }
            }
        }
        sides
    }

    /// The rejected samples by kind: `rejected` of the recorded ones, among them the stuck and the unreadable. Samples
    /// missing from the record are counted by the intervals between the recorded ones, from the stamp `before` on.
    pub fn left_out(&self, before: Option<f64>, rejected: usize, (stuck, unreadable): (usize, usize)) -> LeftOut {
        let gap = 1.5 * self.interval;
        let to_first = before.zip(self.t.first()).map_or(0.0, |(before, first)| first - before);
        let inside = if self.longest_step < gap { 0 } else { self.samples_in_gaps(gap) };
        let missing = inside + if to_first < gap { 0 } else { self.samples_in(to_first) };
        LeftOut { spikes: rejected - stuck - unreadable, stuck, missing: unreadable + missing, repeated: self.repeated }
    }

    /// Samples missing from the record, in steps of at least `least`.
    fn samples_in_gaps(&self, least: f64) -> usize {
        let gaps = self.t.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step >= least);
        gaps.map(|step| self.samples_in(step)).sum()
    }

    /// Samples missing within a step.
    fn samples_in(&self, step: f64) -> usize {
        whole((step / self.interval).round()) - 1
    }

    /// The reason why most samples are rejected.
    pub fn unsteady(&self, index: usize, good: usize) -> ReductionError {
        let (window, samples) = (self.window.span, self.len());
        let (axis, (value, stuck)) = [0, 1, 2]
            .map(|axis| (axis, standing(&self.f_z[axis])))
            .into_iter()
            .max_by_key(|most| most.1.1)
            .unwrap_or_default();
        // A smaller share of equal readings does not keep the others from being averaged.
        if 3 * stuck > samples {
            ReductionError::Stuck { index, window, axis, value, samples, stuck }
        } else {
            ReductionError::Unsteady { index, window, samples, good }
        }
    }
}

impl Shown {
    fn of(shape: &Shape, t: &[f64], f_z: [&[f64]; 3]) -> Self {
        let pick = |values: &[f64]| {
            let mut shown = Vec::with_capacity(SHOWN);
            spread_out(values.len()).for_each(|part| shown.extend_from_slice(&values[part]));
            shown
        };
        let shown = pick(t);
        Self { columns: shape.columns(&shown), t: shown, f_z: f_z.map(pick) }
    }

    /// Median size of the residuals on an axis, the last terms having these coefficients.
    fn median_residual(&self, coefficients: &[Vector3<f64>], axis: usize) -> f64 {
        let residuals = residuals(&self.columns, self.f_z[axis].clone(), coefficients, axis).into_iter();
        median(&mut residuals.map(f64::abs).filter(|size| size.is_finite()).collect::<Vec<f64>>())
    }
}

/// What is left of readings on an axis, the last terms having these coefficients.
fn residuals(columns: &[Vec<f64>], mut f: Vec<f64>, coefficients: &[Vector3<f64>], axis: usize) -> Vec<f64> {
    let columns = &columns[columns.len() - coefficients.len()..];
    subtract_all(&mut f, columns.iter().zip(coefficients).map(|(column, b)| (b[axis], column.as_slice())));
    f
}

/// A subset of `all` samples: neighbours in each of equal ranges, at a quasi-random place in it, so that nothing periodic
/// is always sampled at the same phase. Places at equal steps would fail: some rotation has whole turns in each step.
fn spread_out(all: usize) -> impl Iterator<Item = Range<usize>> {
    let step = (all * NEIGHBOURS).div_ceil(SHOWN).max(NEIGHBOURS);
    (0..all).step_by(step).enumerate().map(move |(k, from)| {
        // Multiples of an irrational number by squares are equally distributed (Weyl 1916), whatever is added in steps.
        let place = ((k * k) as f64 * SQRT_2).fract();
        let from = from + whole(place * (step - NEIGHBOURS + 1) as f64);
        from.min(all)..(from + NEIGHBOURS).min(all)
    })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::{NEIGHBOURS, spread_out};

    /// The concentration of the shown samples at one phase of something with `turns` per sample: 1 if always.
    fn concentration(all: usize, turns: f64) -> f64 {
        let phases = spread_out(all).map(|part| TAU * (turns * part.start as f64).fract());
        let (count, cosines, sines) =
            phases.fold((0.0, 0.0, 0.0), |(n, c, s), phase| (n + 1.0, c + phase.cos(), s + phase.sin()));
        f64::hypot(cosines, sines) / count
    }

    #[test]
    fn nothing_periodic_is_always_seen_at_the_same_phase() {
        for all in [254_937, 3_994_948, 3_994_949, 20_000_000] {
            let range = all as f64 / 512.0;
            // From some turns in all to hundreds in each range.
            let worst =
                (0..20_000).map(|i| concentration(all, (0.03 + f64::from(i) * 0.0137) / range)).fold(0.0, f64::max);
            assert!(worst < 0.3, "{worst} of {all}");
        }
        // A plateau at 378.4 revolutions a minute, at 10 kHz.
        assert!(concentration(3_994_948, 378.4 / 60.0 * 1e-4) < 0.3);
    }

    #[test]
    fn all_ranges_are_shown_from_their_places() {
        for all in [1, 7, 8, 9, 4095, 4096, 4097, 70_001] {
            let shown: Vec<_> = spread_out(all).collect();
            assert!(shown.is_sorted_by(|a, b| a.end <= b.start) && shown.last().unwrap().end <= all);
            let count: usize = shown.iter().map(ExactSizeIterator::len).sum();
            assert!(count <= 4096 && count + NEIGHBOURS > all.min(4096) / 2, "{count} of {all}");
        }
    }
}
