//! Second pass: the mean of one plateau from its samples.

use std::borrow::Cow;
use std::ops::Range;

use nalgebra::{Matrix3, Vector3};

use super::blocks::{Blocks, MAD, cut, median, whole};
use super::cells::{CELLS, Cells};
use super::lanes::{dot, subtract, sum};
use super::noise::NoiseModel;
use super::regression::Regression;
use super::rounding::bias_variance;
use super::settling::TimeStep;
use super::shape::Shape;
use super::stuck::stuck_on_any_axis;
use super::triangle::{TERMS, Triangle};
use super::window::Window;
use super::{PlateauMean, RecordSlice, ReductionError};

/// One plateau, fitted; what its covariance needs is kept in cells.
#[derive(Debug, Clone)]
pub struct PlateauFit {
    window: [f64; 2],
    samples: usize,
    rejected: usize,
    mean: Vector3<f64>,
    once_per_revolution: [Vector3<f64>; 2],
    shape: Shape,
    /// Last digit of the readings [m/s^2].
    digit: Vector3<f64>,
    /// Variance of a sample about the fit [m^2/s^4].
    variance: Vector3<f64>,
    /// Settling at the start of the window [m/s^2].
    pub(super) settling: Vector3<f64>,
    /// Residuals and design, condensed.
    pub(super) cells: Cells,
}

impl PlateauFit {
    /// Fits the plateau `index` in its window.
    pub(super) fn new(
        record: RecordSlice,
        index: usize,
        window: &Window,
        blocks: &Blocks,
    ) -> Result<Self, ReductionError> {
        let samples = Samples::cut_out(record, window, blocks);
        let mut good = samples.without_outliers(&samples.fit_of_medians());
        let mut strips = Strips::new(&samples, &good);
        let mut first = true;
        loop {
            let (all, left) = (good.len(), good.iter().filter(|good| **good).count());
            if 2 * left <= all {
                return Err(ReductionError::Unsteady { index, window: window.span, samples: all, good: left });
            }
            let (omega, interval) = (window.shape.omega, blocks.interval);
            let aliased = ReductionError::RevolutionAliased { index, omega, interval };
            let (triangle, coefficients) = strips.solve().ok_or(aliased)?;
            let mut still_good = samples.without_outliers(&coefficients);
            if !first {
                // From the second fit on, once out is out: the set shrinks, and the loop ends.
                still_good.iter_mut().zip(&good).for_each(|(still, before)| *still &= *before);
            }
            if still_good == good {
                return Ok(Self::from_fit(&samples, &good, &coefficients, &triangle, interval));
            }
            strips.renew(&samples, &good, &still_good);
            (good, first) = (still_good, false);
        }
    }

    fn from_fit(
        samples: &Samples,
        good: &[bool],
        coefficients: &[Vector3<f64>],
        triangle: &Triangle,
        interval: f64,
    ) -> Self {
        let residuals = samples.good_residuals(coefficients, good);
        let kept = good.iter().filter(|good| **good).count();
        let variance = Vector3::from_fn(|axis, _| dot(&residuals[axis], &residuals[axis]) / kept as f64);
        let Window { span, shape } = samples.window;
        let columns = coefficients.len();
        let zero = Vector3::zeros();
        Self {
            window: *span,
            samples: kept,
            rejected: good.len() - kept,
            mean: coefficients[columns - 1],
            once_per_revolution: if shape.omega == 0.0 { [zero; 2] } else { [coefficients[0], coefficients[1]] },
            settling: shape.settling.map_or(zero, |_| coefficients[columns - 2]),
            shape: *shape,
            digit: *samples.digit,
            variance,
            cells: samples.cells(good, &residuals, triangle, interval),
        }
    }

    /// Derivative of the settling's law by the logarithm of its time constant, one value a cell.
    pub(super) fn settling_rate(&self) -> Option<Vec<f64>> {
        let settling = self.shape.settling?;
        Some((0..CELLS).map(|cell| settling.rate((cell as f64 + 0.5) * self.cells.width)).collect())
    }

    /// Variance of a sample about the fit [m^2/s^4].
    pub(super) fn variance(&self) -> Vector3<f64> {
        self.variance
    }

    /// The plateau's mean, with its covariance under the noise.
    pub(super) fn mean(&self, noise: &NoiseModel, step: &TimeStep, quietest: &Vector3<f64>) -> PlateauMean {
        let rounding = self.digit.zip_map(quietest, bias_variance);
        let (weights, drift) = self.cells.slope();
        let (correction, of_correction) = step.effect(self);
        let of_noise = noise.covariance(&self.cells.mean_weights(), &self.cells);
        PlateauMean {
            window: self.window,
            samples: self.samples,
            rejected: self.rejected,
            mean: self.mean + correction,
            covariance: of_noise + of_correction + Matrix3::from_diagonal(&rounding),
            once_per_revolution: self.once_per_revolution,
            drift,
            measured_speed: None,
            drift_uncertainty: noise.covariance(&weights, &self.cells).diagonal().map(f64::sqrt),
            settling: self.settling,
        }
    }
}

/// Samples of a window, with the design of what is fitted to them.
struct Samples<'a> {
    window: &'a Window,
    /// Last digit of the readings [m/s^2].
    digit: &'a Vector3<f64>,
    t: Cow<'a, [f64]>,
    f_z: [Cow<'a, [f64]>; 3],
    /// The stuck ones, if there are any.
    stuck: Option<Vec<bool>>,
    columns: Vec<Vec<f64>>,
}

impl<'a> Samples<'a> {
    /// The samples of a record in a window, without repeated stamps.
    fn cut_out(record: RecordSlice<'a>, window: &'a Window, blocks: &'a Blocks) -> Self {
        let RecordSlice { t, f_z } = record.between(window.span);
        let (t, f_z) = if t.windows(2).all(|pair| pair[0] < pair[1]) {
            (Cow::from(t), f_z.map(Cow::from))
        } else {
            let first_of_stamp = |i: &usize| *i == 0 || t[*i] > t[*i - 1];
            let pick = |values: &[f64]| -> Cow<[f64]> {
                (0..t.len()).filter(first_of_stamp).map(|i| values[i]).collect::<Vec<f64>>().into()
            };
            (pick(t), f_z.map(pick))
        };
        let columns = window.shape.columns(&t);
        let stuck = stuck_on_any_axis(f_z.each_ref().map(|f| &**f), &blocks.repeat_rate);
        Self { window, digit: &blocks.digit, t, f_z, stuck, columns }
    }

    /// Samples of each cell: the times do not decrease.
    fn cells_of_samples(&self) -> Vec<Range<usize>> {
        let [from, to] = self.window.span;
        let cell = |t: f64| whole((t - from) / (to - from) * CELLS as f64).min(CELLS - 1);
        let mut start = 0;
        let end_of = |k: usize| self.t.partition_point(|t| cell(*t) <= k);
        (0..CELLS).map(|k| std::mem::replace(&mut start, end_of(k))..end_of(k)).collect()
    }

    /// A fit through the medians of the cells, which no spike moves. The once-per-revolution term is not in it: cells
    /// may be longer than a revolution. A cell of many samples shows its median by some of them.
    fn fit_of_medians(&self) -> Vec<Vector3<f64>> {
        const SHOWN: usize = 256;
        let [from, to] = self.window.span;
        let shape = Shape { omega: 0.0, ..self.window.shape };
        let (mut middles, mut medians) = (Vec::new(), Vec::new());
        for (cell, range) in self.cells_of_samples().into_iter().enumerate().filter(|(_, range)| !range.is_empty()) {
            let readings = |axis: usize| {
                let shown = spread_out(range.len(), SHOWN).map(|i| self.f_z[axis][range.start + i]);
                median(&mut shown.filter(|f| f.is_finite()).collect::<Vec<f64>>())
            };
            middles.push(from + (cell as f64 + 0.5) * (to - from) / CELLS as f64);
            medians.push(Vector3::from_fn(|axis, _| readings(axis)));
        }
        Regression::new(shape.columns(&middles)).map_or(vec![], |regression| regression.solve(&medians))
    }

    /// The columns of the terms that have coefficients: all, or the last.
    fn columns_with<'s>(
        &'s self,
        coefficients: &'s [Vector3<f64>],
    ) -> impl Iterator<Item = (&'s [f64], &'s Vector3<f64>)> {
        let without = self.columns.len() - coefficients.len();
        self.columns[without..].iter().map(Vec::as_slice).zip(coefficients)
    }

    /// Residuals of some samples on one axis.
    fn residuals(&self, coefficients: &[Vector3<f64>], axis: usize, range: Range<usize>, residuals: &mut Vec<f64>) {
        residuals.clear();
        residuals.extend_from_slice(&self.f_z[axis][range.clone()]);
        for (column, b) in self.columns_with(coefficients) {
            subtract(residuals, b[axis], &column[range.clone()]);
        }
    }

    /// Residuals of the good samples, zero for the others.
    fn good_residuals(&self, coefficients: &[Vector3<f64>], good: &[bool]) -> [Vec<f64>; 3] {
        [0, 1, 2].map(|axis| {
            let mut residuals = Vec::new();
            self.residuals(coefficients, axis, 0..self.t.len(), &mut residuals);
            residuals.iter_mut().zip(good).for_each(|(r, good)| *r = if *good { *r } else { 0.0 });
            residuals
        })
    }

    /// How large a residual of a good sample may be. The spread is seen by some thousands of them.
    fn limits(&self, coefficients: &[Vector3<f64>]) -> [f64; 3] {
        const SEEN: usize = 1 << 14;
        let cut = cut(self.t.len());
        [0, 1, 2].map(|axis| {
            let residual = |i: usize| {
                let fitted: f64 = self.columns_with(coefficients).map(|(column, b)| b[axis] * column[i]).sum();
                self.f_z[axis][i] - fitted
            };
            let sizes = spread_out(self.t.len(), SEEN).map(|i| residual(i).abs()).filter(|r| r.is_finite());
            // Rounding moves a reading by a digit at most, and may leave no spread to see.
            cut * MAD * median(&mut sizes.collect::<Vec<f64>>()) + self.digit[axis]
        })
    }

    /// Which samples are no spikes and not stuck in any axis. Symmetric, so that the mean of good samples is not
    /// biased.
    fn without_outliers(&self, coefficients: &[Vector3<f64>]) -> Vec<bool> {
        let limits = self.limits(coefficients);
        let mut good = vec![true; self.t.len()];
        let mut residuals = Vec::with_capacity(STRIP);
        for range in strips(self.t.len()) {
            for axis in 0..3 {
                self.residuals(coefficients, axis, range.clone(), &mut residuals);
                // A reading that is not a number is within no limit.
                let good = good[range.clone()].iter_mut().zip(&residuals);
                good.for_each(|(good, r)| *good &= r.abs() <= limits[axis]);
            }
        }
        if let Some(stuck) = &self.stuck {
            good.iter_mut().zip(stuck).for_each(|(good, stuck)| *good &= !stuck);
        }
        good
    }

    fn cells(&self, good: &[bool], residuals: &[Vec<f64>; 3], triangle: &Triangle, interval: f64) -> Cells {
        let [from, to] = self.window.span;
        let terms = self.columns.len();
        let mut cells = Cells::empty(triangle, terms, (to - from) / CELLS as f64, interval);
        for (cell, range) in self.cells_of_samples().into_iter().enumerate() {
            let good = &good[range.clone()];
            let count = good.iter().filter(|good| **good).count();
            let sum_of = |column: &[f64]| {
                let column = &column[range.clone()];
                let all = sum(column, |x| x);
                // Few are not good: they are taken out again.
                let bad = good.iter().zip(column).filter(|(good, _)| !**good);
                all - if count == good.len() { 0.0 } else { bad.map(|(_, x)| x).sum() }
            };
            let mut sums = [0.0; TERMS];
            sums.iter_mut().zip(&self.columns).for_each(|(sum, column)| *sum = sum_of(column));
            let residuals = Vector3::from_fn(|axis, _| sum(&residuals[axis][range.clone()], |r| r));
            cells.fill(cell, count, residuals, &triangle.orthonormal(sums, terms)[..terms]);
        }
        cells
    }
}

/// Samples of a strip: their design stays in the fastest memory.
const STRIP: usize = 512;

fn strips(samples: usize) -> impl Iterator<Item = Range<usize>> {
    (0..samples).step_by(STRIP).map(move |from| from..(from + STRIP).min(samples))
}

/// The triangles of a plateau's strips.
struct Strips {
    triangles: Vec<Triangle>,
    terms: usize,
    /// Near the readings: less of them is left to rounding.
    reference: Vector3<f64>,
}

impl Strips {
    fn new(samples: &Samples, good: &[bool]) -> Self {
        let near = |axis: usize| samples.f_z[axis].iter().copied().find(|f| f.is_finite()).unwrap_or(0.0);
        let reference = Vector3::from_fn(|axis, _| near(axis));
        let mut of = Self { triangles: Vec::new(), terms: samples.columns.len(), reference };
        of.triangles = strips(good.len()).map(|range| of.triangle(samples, good, range)).collect();
        of
    }

    /// Those of the strips whose good samples are others now.
    fn renew(&mut self, samples: &Samples, before: &[bool], good: &[bool]) {
        for (k, range) in strips(good.len()).enumerate() {
            if before[range.clone()] != good[range.clone()] {
                self.triangles[k] = self.triangle(samples, good, range);
            }
        }
    }

    /// The triangle of the good samples of a strip; the others are rows of zeros.
    fn triangle(&self, samples: &Samples, good: &[bool], range: Range<usize>) -> Triangle {
        let good = &good[range.clone()];
        let mut terms = [[0.0; STRIP]; TERMS];
        let mut readings = [[0.0; STRIP]; 3];
        for (term, column) in terms.iter_mut().zip(&samples.columns) {
            for ((term, x), good) in term.iter_mut().zip(&column[range.clone()]).zip(good) {
                *term = if *good { *x } else { 0.0 };
            }
        }
        for ((reading, f), reference) in readings.iter_mut().zip(&samples.f_z).zip(&self.reference) {
            for ((reading, f), good) in reading.iter_mut().zip(&f[range.clone()]).zip(good) {
                *reading = if *good { f - reference } else { 0.0 };
            }
        }
        let mut terms = terms.each_mut().map(|term| &mut term[..range.len()]);
        Triangle::of(&mut terms[..self.terms], &mut readings.each_mut().map(|f| &mut f[..range.len()]))
    }

    /// The triangle of all strips, and the coefficients.
    fn solve(&self) -> Option<(Triangle, Vec<Vector3<f64>>)> {
        let triangle = Triangle::joined(&self.triangles, self.terms);
        let mut coefficients = triangle.solve(self.terms)?;
        coefficients[self.terms - 1] += self.reference;
        Some((triangle, coefficients))
    }
}

/// `count` of the numbers up to `all`, or all of them: one in each of equal ranges, here and there in it, so that nothing
/// periodic is always seen at the same phase.
fn spread_out(all: usize, count: usize) -> impl Iterator<Item = usize> {
    let step = all.div_ceil(count).max(1);
    (0..all).step_by(step).enumerate().map(move |(k, i)| (i + k * 7919 % step).min(all - 1))
}
