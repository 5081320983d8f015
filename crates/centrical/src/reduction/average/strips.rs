//! The samples of a window in strips that fit the fastest memory: which are good, and their information.

use std::ops::Range;

use nalgebra::Vector3;
use pulp::{Simd, WithSimd};

use super::samples::Samples;
use crate::reduction::simd::{dot, largest, range, subtract, widest};
use crate::reduction::terms::{TERMS, Triangle};
use crate::statistics::{is_tone, longest_run, may_be_longer, stuck_on_any_axis, widened};

/// Most samples of a strip.
const STRIP: usize = 512;

/// A part of a window's samples, judged by a fit.
pub(super) struct Strips<'a> {
    samples: &'a Samples<'a>,
    /// The stuck samples, if any.
    stuck: Option<Vec<bool>>,
    /// With the strips of the parts before, which are fitted together with these.
    pub fitted: Fitted,
    /// The first of this part.
    first: usize,
    /// Limits over those of the samples: wider for the tail of the noise.
    wider: Vector3<f64>,
}

/// Strips whose samples are no longer needed.
#[derive(Debug, Clone, Default)]
pub(super) struct Fitted {
    /// Number of fitted terms.
    terms: usize,
    /// A value near the readings, subtracted from them to reduce rounding.
    reference: [f64; 3],
    each: Vec<Strip>,
}

/// Neighbours, all of one cell.
#[derive(Debug, Clone)]
pub(super) struct Strip {
    pub cell: usize,
    range: Range<usize>,
    /// The bad samples, counted within the strip, in ascending order.
    bad: Vec<usize>,
    /// Of the good samples, as are the fields that follow.
    triangle: Triangle,
    /// Largest entry of each column of `Q`.
    reach: [f64; TERMS],
    /// Largest residual of the strip's own fit, and the sum of the squares [m/s^2].
    largest: [f64; 3],
    squares: [f64; 3],
    /// Lowest and highest reading [m/s^2].
    low: [f64; 3],
    high: [f64; 3],
}

/// Sums over the good samples of a strip.
pub(super) struct Sums {
    pub count: usize,
    /// Of the columns of the design.
    pub columns: [f64; TERMS],
    /// Of the residuals [m/s^2].
    pub residuals: Vector3<f64>,
    /// Of their squares [m^2/s^4].
    pub squares: Vector3<f64>,
}

/// A fit that samples are judged by.
struct Fit<'a> {
    /// Of the readings less the reference [m/s^2].
    coefficients: [[f64; 3]; TERMS],
    /// Largest residual of a good sample [m/s^2].
    limits: [f64; 3],
    /// The stuck samples, if any: they are bad.
    stuck: Option<&'a [bool]>,
    /// Whether bad samples stay out.
    once_out: bool,
}

/// Working memory, aligned to cache lines.
#[repr(align(64))]
struct Room {
    columns: [[f64; STRIP]; TERMS],
    readings: [[f64; STRIP]; 3],
}

impl Room {
    const EMPTY: Self = Self { columns: [[0.0; STRIP]; TERMS], readings: [[0.0; STRIP]; 3] };
}

impl<'a> Strips<'a> {
    /// All samples, as if all were good, after those of the parts before.
    pub fn of(samples: &'a Samples<'a>, mut fitted: Fitted) -> Self {
        if fitted.each.is_empty() {
            let near = |axis: usize| samples.f_z[axis].iter().copied().find(|f| f.is_finite()).unwrap_or(0.0);
            (fitted.terms, fitted.reference) = (samples.window.shape.terms(), [0, 1, 2].map(near));
        }
        let of_cell = |(cell, all): (usize, Range<usize>)| {
            let end = all.end;
            all.step_by(STRIP).map(move |from| Strip::new(cell, from..(from + STRIP).min(end)))
        };
        let first = fitted.each.len();
        fitted.each.extend(samples.cells().enumerate().flat_map(of_cell));
        let longest = samples.repeat_rate.map(|rate| longest_run(samples.len(), rate));
        let (mut may_be_stuck, mut room) = (false, Room::EMPTY);
        for strip in &mut fitted.each[first..] {
            widest(Work { strip, samples, reference: fitted.reference, fit: None, room: &mut room });
            // Checked while the readings are in the cache.
            may_be_stuck =
                may_be_stuck || (0..3).any(|axis| may_be_longer(&samples.f_z[axis], &strip.range, longest[axis]));
        }
        let readings = samples.f_z.each_ref().map(|f| &**f);
        let stuck = if may_be_stuck { stuck_on_any_axis(readings, &longest) } else { None };
        Self { samples, stuck, fitted, first, wider: Vector3::repeat(1.0) }
    }

    /// Judges the samples by a fit whose last terms have these coefficients; true if the set of good samples changed. With
    /// `once_out`, bad samples stay out.
    pub fn judge(&mut self, coefficients: &[Vector3<f64>], once_out: bool) -> bool {
        let limits = self.samples.limits(coefficients).component_mul(&self.wider);
        self.judge_within(limits.into(), coefficients, once_out)
    }

    /// Whether the spikes of a fit with these coefficients are the tail of the noise on some axis. From then on they are good.
    pub fn keeps_tails(&mut self, coefficients: &[Vector3<f64>]) -> bool {
        if self.bad().filter(|i| self.is_usable(*i)).take(2).count() < 2 {
            return false;
        }
        let limits = self.samples.limits(coefficients);
        let usable: Vec<bool> = (0..self.samples.len()).map(|i| self.is_usable(i)).collect();
        let sides = self.samples.sides(coefficients, &limits, &usable);
        self.wider = Vector3::from(sides.map(|sides| sides.into_iter().filter_map(widened).fold(1.0, f64::max)));
        self.wider.max() > 1.0
    }

    /// Takes all samples for good that are readable and not stuck.
    pub fn take_all(&mut self) {
        let nothing = vec![Vector3::zeros(); self.fitted.terms];
        self.judge_within([f64::MAX; 3], &nothing, false);
    }

    /// Whether a fifth of the samples or more are rejected, by the steps of a tone.
    pub fn rejects_a_tone(&self) -> bool {
        5 * (self.samples.len() - self.good()) >= self.samples.len() && is_tone(&self.bad().collect::<Vec<usize>>())
    }

    fn judge_within(&mut self, limits: [f64; 3], coefficients: &[Vector3<f64>], once_out: bool) -> bool {
        let Self { samples, stuck, fitted, first, .. } = self;
        let (coefficients, stuck) = (fitted.less_reference(coefficients), stuck.as_deref());
        let fit = Fit { coefficients, limits, stuck, once_out };
        let (mut changed, mut room) = (false, Room::EMPTY);
        for strip in &mut fitted.each[*first..] {
            let work = Work { strip, samples, reference: fitted.reference, fit: Some(&fit), room: &mut room };
            changed |= widest(work);
        }
        changed
    }

    fn part(&self) -> &[Strip] {
        &self.fitted.each[self.first..]
    }

    /// Number of good samples.
    pub fn good(&self) -> usize {
        self.part().iter().map(Strip::good).sum()
    }

    /// Numbers of stuck samples, and of unreadable ones among the others.
    pub fn stuck_and_unreadable(&self) -> (usize, usize) {
        let stuck = self.bad().filter(|i| self.is_stuck(*i)).count();
        (stuck, self.bad().filter(|i| !self.is_stuck(*i) && !self.is_usable(*i)).count())
    }

    /// The bad samples.
    fn bad(&self) -> impl Iterator<Item = usize> + '_ {
        self.part().iter().flat_map(|strip| strip.bad.iter().map(|i| strip.range.start + i))
    }

    /// Whether a sample is readable on all axes and not stuck.
    fn is_usable(&self, sample: usize) -> bool {
        self.samples.f_z.iter().all(|f| f[sample].is_finite()) && !self.is_stuck(sample)
    }

    fn is_stuck(&self, sample: usize) -> bool {
        self.stuck.as_ref().is_some_and(|stuck| stuck[sample])
    }

    /// The number of good samples with the lowest reading on an axis, or with the highest, whichever is larger.
    pub fn most_at_an_end(&self, axis: usize) -> usize {
        let low = self.part().iter().map(|strip| strip.low[axis]).fold(f64::INFINITY, f64::min);
        let high = self.part().iter().map(|strip| strip.high[axis]).fold(f64::NEG_INFINITY, f64::max);
        let count = |end: f64| -> usize {
            let there = self.part().iter().filter(|strip| strip.low[axis] == end || strip.high[axis] == end);
            there.map(|strip| strip.good_of(&self.samples.f_z[axis]).filter(|f| *f == end).count()).sum()
        };
        count(low).max(count(high))
    }

    /// The good readings on an axis.
    pub fn good_readings(&self, axis: usize) -> Vec<f64> {
        self.part().iter().flat_map(|strip| strip.good_of(&self.samples.f_z[axis])).collect()
    }
}

impl Fitted {
    /// Number of good samples.
    pub fn good(&self) -> usize {
        self.each.iter().map(Strip::good).sum()
    }

    /// Number of bad samples.
    pub fn bad(&self) -> usize {
        self.each.iter().map(|strip| strip.bad.len()).sum()
    }

    /// Range of the good readings on each axis [m/s^2].
    pub fn ranges(&self) -> Vector3<f64> {
        let low = |axis: usize| self.each.iter().map(|strip| strip.low[axis]).fold(f64::INFINITY, f64::min);
        let high = |axis: usize| self.each.iter().map(|strip| strip.high[axis]).fold(f64::NEG_INFINITY, f64::max);
        Vector3::from_fn(|axis, _| high(axis) - low(axis))
    }

    /// The triangle of all strips, and the coefficients.
    pub fn solve(&self) -> Option<(Triangle, Vec<Vector3<f64>>)> {
        let triangles: Vec<&Triangle> = self.each.iter().map(|strip| &strip.triangle).collect();
        let triangle = Triangle::joined(&triangles, self.terms);
        let mut coefficients = triangle.solve(self.terms)?;
        coefficients[self.terms - 1] += Vector3::from(self.reference);
        Some((triangle, coefficients))
    }

    /// The cell of each strip, and the sums over its good samples, of a fit with these coefficients.
    pub fn sums(&self, coefficients: &[Vector3<f64>]) -> impl Iterator<Item = (usize, Sums)> {
        let coefficients = self.less_reference(coefficients);
        self.each.iter().map(move |strip| (strip.cell, strip.sums(&coefficients, self.terms)))
    }

    /// The coefficients of all terms, zero where not given, with the reference subtracted from the constant's.
    fn less_reference(&self, coefficients: &[Vector3<f64>]) -> [[f64; 3]; TERMS] {
        let mut all = [[0.0; 3]; TERMS];
        let given = &mut all[self.terms - coefficients.len()..self.terms];
        given.iter_mut().zip(coefficients).for_each(|(b, of)| *b = (*of).into());
        all[self.terms - 1].iter_mut().zip(self.reference).for_each(|(b, reference)| *b -= reference);
        all
    }
}

/// A strip to be judged by a fit, or without one to be fitted on its own. The output is whether the set of good samples changed.
struct Work<'a> {
    strip: &'a mut Strip,
    samples: &'a Samples<'a>,
    /// That of [`Fitted`] [m/s^2].
    reference: [f64; 3],
    fit: Option<&'a Fit<'a>>,
    room: &'a mut Room,
}

impl WithSimd for Work<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let Self { strip, samples, reference, fit, room } = self;
        let Some(fit) = fit else {
            strip.orthogonalise(simd, samples, reference, room);
            return false;
        };
        !strip.is_within(fit) && strip.judge(simd, samples, reference, fit, room)
    }
}

impl Strip {
    fn new(cell: usize, range: Range<usize>) -> Self {
        let (triangle, bad) = (Triangle::default(), Vec::new());
        let (reach, zero) = ([0.0; TERMS], [0.0; 3]);
        Self { cell, range, bad, triangle, reach, largest: zero, squares: zero, low: zero, high: zero }
    }

    fn good(&self) -> usize {
        self.range.len() - self.bad.len()
    }

    /// The readings of the good samples, of all of the window.
    fn good_of(&self, f: &[f64]) -> impl Iterator<Item = f64> {
        let mut bad = self.bad.iter().peekable();
        let is_good = move |(i, _): &(usize, f64)| bad.next_if(|bad| **bad == *i).is_none();
        f[self.range.clone()].iter().copied().enumerate().filter(is_good).map(|(_, f)| f)
    }

    /// The strip's own fit to its good samples.
    #[inline(always)]
    fn orthogonalise<S: Simd>(&mut self, simd: S, samples: &Samples, reference: [f64; 3], room: &mut Room) {
        let n = self.range.len();
        let mut columns = room.columns.each_mut().map(|column| &mut column[..n]);
        let columns = &mut columns[..samples.window.shape.terms()];
        let mut readings = room.readings.each_mut().map(|reading| &mut reading[..n]);
        samples.window.shape.design(&samples.t[self.range.clone()], columns);
        for (axis, reading) in readings.iter_mut().enumerate() {
            let f = &samples.f_z[axis][self.range.clone()];
            for (reading, f) in reading.iter_mut().zip(f) {
                *reading = f - reference[axis];
            }
            [self.low[axis], self.high[axis]] = if self.bad.is_empty() { range(f) } else { self.range_of_good(f) };
        }
        for i in &self.bad {
            columns.iter_mut().chain(&mut readings).for_each(|values| values[*i] = 0.0);
        }
        self.triangle = Triangle::of(simd, columns, &mut readings);
        for (reach, q) in self.reach.iter_mut().zip(columns) {
            *reach = largest(simd, q);
        }
        for (axis, left) in readings.iter().enumerate() {
            (self.largest[axis], self.squares[axis]) = (largest(simd, left), dot(simd, left, left));
        }
    }

    /// Lowest and highest of the good readings.
    fn range_of_good(&self, f: &[f64]) -> [f64; 2] {
        let good = f.iter().enumerate().filter(|(i, _)| self.bad.binary_search(i).is_err()).map(|(_, f)| *f);
        good.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], f| [low.min(f), high.max(f)])
    }

    /// Whether a bound shows all samples to be good: a residual is the sum of that of the strip's own fit and of what the
    /// coefficients leave in the directions of `Q`.
    #[inline(always)]
    fn is_within(&self, fit: &Fit) -> bool {
        let left = self.triangle.left(&fit.coefficients);
        let is_within = |axis: usize| {
            let of_directions: f64 = left.iter().zip(&self.reach).map(|(left, reach)| left[axis].abs() * reach).sum();
            // Unreadable readings leave no finite sum of squares.
            self.largest[axis] + of_directions <= fit.limits[axis] && self.squares[axis].is_finite()
        };
        self.bad.is_empty() && fit.stuck.is_none() && is_within(0) && is_within(1) && is_within(2)
    }

    /// Judges the samples one by one; true if the set of good samples changed.
    #[inline(always)]
    fn judge<S: Simd>(&mut self, simd: S, samples: &Samples, reference: [f64; 3], fit: &Fit, room: &mut Room) -> bool {
        let bad = self.bad_by(samples, reference, fit, room);
        let changed = bad != self.bad;
        if changed {
            self.bad = bad;
            self.orthogonalise(simd, samples, reference, room);
        }
        changed
    }

    /// The samples that are spikes or stuck on any axis. The limits are symmetric, so that the mean of good samples is not
    /// biased.
    #[inline(always)]
    fn bad_by(&self, samples: &Samples, reference: [f64; 3], fit: &Fit, room: &mut Room) -> Vec<usize> {
        let n = self.range.len();
        let mut columns = room.columns.each_mut().map(|column| &mut column[..n]);
        let columns = &mut columns[..samples.window.shape.terms()];
        samples.window.shape.design(&samples.t[self.range.clone()], columns);
        let mut residuals = room.readings.each_mut().map(|reading| &mut reading[..n]);
        for (axis, residuals) in residuals.iter_mut().enumerate() {
            let f = &samples.f_z[axis][self.range.clone()];
            for (residual, f) in residuals.iter_mut().zip(f) {
                *residual = f - reference[axis];
            }
            for (column, b) in columns.iter().zip(&fit.coefficients) {
                subtract(residuals, b[axis], column);
            }
        }
        let stuck = fit.stuck.map(|stuck| &stuck[self.range.clone()]);
        let is_bad = |i: &usize| {
            // Comparison with a NaN is false: an unreadable sample is bad.
            let is_within = (0..3).all(|axis| residuals[axis][*i].abs() <= fit.limits[axis]);
            !is_within || stuck.is_some_and(|stuck| stuck[*i]) || fit.once_out && self.bad.binary_search(i).is_ok()
        };
        (0..n).filter(is_bad).collect()
    }

    /// By `1^T Q`: the constant is the last column of the design, and what the strip's own fit leaves has no part in it.
    fn sums(&self, coefficients: &[[f64; 3]; TERMS], terms: usize) -> Sums {
        let (left, constant) = (self.triangle.left(coefficients), &self.triangle.r[terms - 1]);
        let along_constant = |column: &[f64; TERMS]| column.iter().zip(constant).map(|(a, b)| a * b).sum();
        let each_axis = |of: &dyn Fn(usize) -> f64| Vector3::from_fn(|axis, _| of(axis));
        Sums {
            count: self.good(),
            columns: self.triangle.r.each_ref().map(along_constant),
            residuals: each_axis(&|axis| along_constant(&left.map(|of| of[axis]))),
            squares: each_axis(&|axis| self.squares[axis] + left.iter().map(|of| of[axis] * of[axis]).sum::<f64>()),
        }
    }
}
