//! The samples of a window in strips that stay in the fastest memory: which are good, and what they say.

use std::ops::Range;

use nalgebra::Vector3;
use pulp::{Simd, WithSimd};

use super::lanes::{dot, fold, subtract, sum, widest};
use super::samples::Samples;
use super::triangle::{TERMS, Triangle};

/// Samples of a strip at most.
const STRIP: usize = 512;

/// A window's samples, judged by a fit.
pub(super) struct Strips<'a> {
    samples: &'a Samples<'a>,
    /// Terms that are fitted.
    terms: usize,
    /// Near the readings: less of them is left to rounding.
    reference: [f64; 3],
    each: Vec<Strip>,
}

/// Neighbours, all of one cell.
pub(super) struct Strip {
    pub cell: usize,
    range: Range<usize>,
    /// Those that are not good, counted within the strip, in ascending order.
    bad: Vec<usize>,
    triangle: Triangle,
    pub sums: Sums,
}

/// Sums over the good samples of a strip.
#[derive(Default, Clone, Copy)]
pub(super) struct Sums {
    pub count: usize,
    /// Of the columns of the design.
    pub columns: [f64; TERMS],
    /// Of the residuals [m/s^2].
    pub residuals: [f64; 3],
    /// Of their squares [m^2/s^4].
    pub squares: [f64; 3],
    /// Lowest and highest reading [m/s^2].
    low: [f64; 3],
    high: [f64; 3],
}

/// Room to work in.
struct Room {
    columns: [[f64; STRIP]; TERMS],
    readings: [[f64; STRIP]; 3],
}

impl<'a> Strips<'a> {
    /// All samples, before the first fit.
    pub fn of(samples: &'a Samples<'a>) -> Self {
        let near = |axis: usize| samples.f_z[axis].iter().copied().find(|f| f.is_finite()).unwrap_or(0.0);
        let of_cell = |(cell, all): (usize, Range<usize>)| {
            let end = all.end;
            all.step_by(STRIP).map(move |from| Strip::new(cell, from..(from + STRIP).min(end)))
        };
        let each = samples.cells().into_iter().enumerate().flat_map(of_cell).collect();
        Self { samples, terms: samples.window.shape.terms(), reference: [0, 1, 2].map(near), each }
    }

    /// Judges the samples by a fit whose last terms have these coefficients: whether other ones are good than before. With
    /// `once_out`, those that were not good stay out.
    pub fn judge(&mut self, coefficients: &[Vector3<f64>], once_out: bool) -> bool {
        let limits = self.samples.limits(coefficients);
        let mut all = [[0.0; 3]; TERMS];
        let without = self.terms - coefficients.len();
        all[without..].iter_mut().zip(coefficients).for_each(|(b, of)| *b = (*of).into());
        let mut room = Room { columns: [[0.0; STRIP]; TERMS], readings: [[0.0; STRIP]; 3] };
        let fit = Fit {
            samples: self.samples,
            terms: self.terms,
            reference: self.reference,
            coefficients: all,
            limits: limits.into(),
            once_out,
        };
        let mut changed = false;
        for strip in &mut self.each {
            changed |= widest(Judgement { strip, fit: &fit, room: &mut room });
        }
        changed
    }

    /// How many are good.
    pub fn good(&self) -> usize {
        self.each.iter().map(|strip| strip.sums.count).sum()
    }

    /// The triangle of all strips, and the coefficients.
    pub fn solve(&self) -> Option<(Triangle, Vec<Vector3<f64>>)> {
        let triangles: Vec<&Triangle> = self.each.iter().map(|strip| &strip.triangle).collect();
        let triangle = Triangle::joined(&triangles, self.terms);
        let mut coefficients = triangle.solve(self.terms)?;
        coefficients[self.terms - 1] += Vector3::from(self.reference);
        Some((triangle, coefficients))
    }

    /// One after another.
    pub fn iter(&self) -> impl Iterator<Item = &Strip> {
        self.each.iter()
    }

    /// How many good samples have the lowest reading on an axis, or the highest, whichever are more.
    pub fn most_at_an_end(&self, axis: usize) -> usize {
        let low = self.each.iter().map(|strip| strip.sums.low[axis]).fold(f64::INFINITY, f64::min);
        let high = self.each.iter().map(|strip| strip.sums.high[axis]).fold(f64::NEG_INFINITY, f64::max);
        let count = |end: f64| -> usize {
            let there = self.each.iter().filter(|s| s.sums.low[axis] == end || s.sums.high[axis] == end);
            there.map(|strip| strip.good(&self.samples.f_z[axis]).filter(|f| *f == end).count()).sum()
        };
        count(low).max(count(high))
    }

    /// The good readings on an axis.
    pub fn good_readings(&self, axis: usize) -> Vec<f64> {
        self.each.iter().flat_map(|strip| strip.good(&self.samples.f_z[axis])).collect()
    }
}

/// A fit that samples are judged by.
struct Fit<'a> {
    samples: &'a Samples<'a>,
    terms: usize,
    reference: [f64; 3],
    coefficients: [[f64; 3]; TERMS],
    limits: [f64; 3],
    once_out: bool,
}

/// A strip's samples on their way to be judged.
struct Judgement<'a> {
    strip: &'a mut Strip,
    fit: &'a Fit<'a>,
    room: &'a mut Room,
}

impl WithSimd for Judgement<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> bool {
        self.strip.judge(self.fit, self.room)
    }
}

impl Strip {
    fn new(cell: usize, range: Range<usize>) -> Self {
        Self { cell, range, bad: Vec::new(), triangle: Triangle::default(), sums: Sums::default() }
    }

    /// The readings of the good samples, of all of the window.
    fn good(&self, f: &[f64]) -> impl Iterator<Item = f64> {
        let mut bad = self.bad.iter().peekable();
        let is_good = move |(i, _): &(usize, f64)| bad.next_if(|bad| **bad == *i).is_none();
        f[self.range.clone()].iter().copied().enumerate().filter(is_good).map(|(_, f)| f)
    }

    #[inline(always)]
    fn judge(&mut self, fit: &Fit, room: &mut Room) -> bool {
        let (n, samples) = (self.range.len(), fit.samples);
        let f_z = samples.f_z.each_ref().map(|f| &f[self.range.clone()]);
        let mut columns = room.columns.each_mut().map(|column| &mut column[..n]);
        let columns = &mut columns[..fit.terms];
        let mut readings = room.readings.each_mut().map(|reading| &mut reading[..n]);
        samples.window.shape.design(&samples.t[self.range.clone()], columns);
        for (axis, (residuals, f)) in readings.iter_mut().zip(f_z).enumerate() {
            residuals.copy_from_slice(f);
            for (column, b) in columns.iter().zip(&fit.coefficients) {
                subtract(residuals, b[axis], column);
            }
        }
        let bad = self.bad(fit, &readings.each_ref().map(|r| &**r));
        let is_first = self.sums.count == 0 && self.bad.is_empty();
        let changed = is_first || bad != self.bad;
        self.bad = bad;
        for i in &self.bad {
            for values in columns.iter_mut().chain(&mut readings) {
                values[*i] = 0.0;
            }
        }
        self.sums.count = n - self.bad.len();
        for (total, column) in self.sums.columns.iter_mut().zip(columns.iter()) {
            *total = sum(column, |x| x);
        }
        for (axis, residuals) in readings.iter().enumerate() {
            self.sums.residuals[axis] = sum(residuals, |r| r);
            self.sums.squares[axis] = dot(residuals, residuals);
        }
        if changed {
            self.take_range(samples);
            for ((reading, f), reference) in readings.iter_mut().zip(f_z).zip(fit.reference) {
                reading.iter_mut().zip(f).for_each(|(reading, f)| *reading = f - reference);
                self.bad.iter().for_each(|i| reading[*i] = 0.0);
            }
            self.triangle = Triangle::of(columns, &mut readings);
        }
        changed
    }

    /// Which samples are spikes or stuck on any axis. The limits are symmetric, so that the mean of good samples is not
    /// biased.
    #[inline(always)]
    fn bad(&self, fit: &Fit, residuals: &[&[f64]; 3]) -> Vec<usize> {
        // A reading that is not a number is within no limit.
        let is_within = |axis: usize| {
            let limit = fit.limits[axis];
            sum(residuals[axis], |r| f64::from(u8::from(r.abs() <= limit))) == residuals[axis].len() as f64
        };
        let stuck = fit.samples.stuck.as_ref().map(|stuck| &stuck[self.range.clone()]);
        let all_good = is_within(0) && is_within(1) && is_within(2);
        if all_good && stuck.is_none() && (self.bad.is_empty() || !fit.once_out) {
            return Vec::new();
        }
        let is_bad = |i: &usize| {
            let is_within = (0..3).all(|axis| residuals[axis][*i].abs() <= fit.limits[axis]);
            !is_within || stuck.is_some_and(|stuck| stuck[*i]) || fit.once_out && self.bad.binary_search(i).is_ok()
        };
        (0..self.range.len()).filter(is_bad).collect()
    }

    /// Lowest and highest of the good readings.
    #[inline(always)]
    fn take_range(&mut self, samples: &Samples) {
        for (axis, f) in samples.f_z.iter().enumerate() {
            let (low, high) = if self.bad.is_empty() {
                let f = &f[self.range.clone()];
                let low = fold(f, f64::INFINITY, |low, f| if f < low { f } else { low }, f64::min);
                (low, fold(f, f64::NEG_INFINITY, |high, f| if f > high { f } else { high }, f64::max))
            } else {
                let range = |(low, high): (f64, f64), f: f64| (low.min(f), high.max(f));
                self.good(f).fold((f64::INFINITY, f64::NEG_INFINITY), range)
            };
            (self.sums.low[axis], self.sums.high[axis]) = (low, high);
        }
    }
}
