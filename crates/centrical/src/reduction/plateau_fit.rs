//! Second pass: the mean of one plateau from its samples.

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Vector3};

use super::blocks::{Blocks, MAD, cut, median, whole};
use super::cells::{CELLS, Cells};
use super::noise::NoiseModel;
use super::regression::Regression;
use super::rounding::bias_variance;
use super::saturation::piled_up;
use super::settling::TimeStep;
use super::shape::Shape;
use super::stuck::{most_stuck, stuck_on_any_axis};
use super::window::Window;
use super::{LeftOut, PlateauMean, Record, ReductionError};

/// One plateau, fitted; what its covariance needs is kept in cells.
#[derive(Debug, Clone)]
pub(super) struct PlateauFit {
    window: [f64; 2],
    samples: usize,
    rejected: usize,
    left_out: LeftOut,
    mean: Vector3<f64>,
    once_per_revolution: [Vector3<f64>; 2],
    shape: Shape,
    /// Last digit of the readings [m/s^2].
    digit: Vector3<f64>,
    /// Variance of a sample about the fit [m^2/s^4].
    variance: Vector3<f64>,
    /// Settling at the start of the window [m/s^2].
    pub settling: Vector3<f64>,
    /// Residuals and design, condensed.
    pub cells: Cells,
}

impl PlateauFit {
    /// Fits the plateau `index` in its window.
    pub fn new(record: &Record, index: usize, window: &Window, blocks: &Blocks) -> Result<Self, ReductionError> {
        let samples = Samples::cut_out(record, window, blocks);
        let residuals = samples.residuals_of_medians();
        samples.check_range(index, &residuals)?;
        let mut good = samples.without_outliers(&residuals);
        let mut first = true;
        loop {
            let (all, left) = (good.len(), good.iter().filter(|good| **good).count());
            if 2 * left <= all {
                return Err(samples.unsteady(index, left, &blocks.repeat_rate));
            }
            let (omega, interval) = (window.shape.omega, blocks.interval);
            let aliased = ReductionError::RevolutionAliased { index, omega, interval };
            let regression = Regression::new(samples.columns_of(&good)).ok_or(aliased)?;
            let coefficients = regression.solve(&kept(&samples.f_z, &good));
            let residuals = samples.residuals(&coefficients);
            let mut still_good = samples.without_outliers(&residuals);
            if !first {
                // From the second fit on, once out is out: the set shrinks, and the loop ends.
                still_good.iter_mut().zip(&good).for_each(|(still, before)| *still &= *before);
            }
            if still_good == good {
                let cells = samples.cells(&good, &residuals, &regression, interval);
                return Ok(Self::from_fit(&samples, &good, &coefficients, cells, &kept(&residuals, &good)));
            }
            (good, first) = (still_good, false);
        }
    }

    fn from_fit(
        samples: &Samples,
        good: &[bool],
        coefficients: &[Vector3<f64>],
        cells: Cells,
        residuals: &[Vector3<f64>],
    ) -> Self {
        let kept = residuals.len();
        let variance = residuals.iter().map(|r| r.component_mul(r)).sum::<Vector3<f64>>() / kept as f64;
        let Window { span, shape } = samples.window;
        let columns = coefficients.len();
        let zero = Vector3::zeros();
        Self {
            window: *span,
            samples: kept,
            rejected: good.len() - kept,
            left_out: samples.left_out(good),
            mean: coefficients[columns - 1],
            once_per_revolution: if shape.omega == 0.0 { [zero; 2] } else { [coefficients[0], coefficients[1]] },
            settling: shape.settling.map_or(zero, |_| coefficients[columns - 2]),
            shape: *shape,
            digit: *samples.digit,
            variance,
            cells,
        }
    }

    /// Derivative of the settling's law by the logarithm of its time constant, one value a cell.
    pub fn settling_rate(&self) -> Option<Vec<f64>> {
        let settling = self.shape.settling?;
        Some((0..CELLS).map(|cell| settling.rate((cell as f64 + 0.5) * self.cells.width)).collect())
    }

    /// Variance of a sample about the fit [m^2/s^4].
    pub fn variance(&self) -> Vector3<f64> {
        self.variance
    }

    /// Covariance of either quadrature of the once-per-revolution term: `2 S(Omega / 2 pi) / T`, with the two-sided
    /// density `S` of the noise at the frequency of rotation and the time `T` that was sampled; for whole revolutions.
    fn covariance_of_harmonic(&self, noise: &NoiseModel) -> Matrix3<f64> {
        if self.shape.omega == 0.0 {
            return Matrix3::zeros();
        }
        noise.density(self.shape.omega / TAU) * (2.0 / (self.samples as f64 * self.cells.interval))
    }

    /// The plateau's mean, with its covariance under the noise.
    pub fn mean(&self, noise: &NoiseModel, step: &TimeStep, quietest: &Vector3<f64>) -> PlateauMean {
        let rounding = self.digit.zip_map(quietest, bias_variance);
        let (weights, drift) = self.cells.slope();
        let (correction, of_correction) = step.effect(self);
        let of_noise = noise.covariance(&self.cells.mean_weights(), &self.cells);
        PlateauMean {
            window: self.window,
            samples: self.samples,
            rejected: self.rejected,
            left_out: self.left_out,
            mean: self.mean + correction,
            covariance: of_noise + of_correction + Matrix3::from_diagonal(&rounding),
            once_per_revolution: self.once_per_revolution,
            once_per_revolution_covariance: self.covariance_of_harmonic(noise),
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
    /// White noise of a sample [m/s^2].
    white: &'a Vector3<f64>,
    t: Vec<f64>,
    f_z: Vec<Vector3<f64>>,
    stuck: Vec<bool>,
    columns: Vec<Vec<f64>>,
    /// Samples with the stamp of the one before.
    repeated: usize,
    /// Sampling interval [s].
    interval: f64,
}

impl<'a> Samples<'a> {
    /// The samples of a record in a window, without repeated stamps.
    fn cut_out(record: &Record, window: &'a Window, blocks: &'a Blocks) -> Self {
        let from = record.t.partition_point(|t| *t < window.span[0]);
        let to = record.t.partition_point(|t| *t <= window.span[1]);
        let first_of_stamp = |i: &usize| *i == from || record.t[*i] > record.t[*i - 1];
        let reading = |i: usize| Vector3::new(record.f_z[0][i], record.f_z[1][i], record.f_z[2][i]);
        let (t, f_z): (Vec<f64>, Vec<Vector3<f64>>) =
            (from..to).filter(first_of_stamp).map(|i| (record.t[i], reading(i))).unzip();
        let columns = window.shape.columns(&t);
        let repeated = to - from - t.len();
        let interval = blocks.interval;
        let stuck = stuck_on_any_axis(&f_z, &blocks.repeat_rate);
        Self { window, digit: &blocks.digit, white: &blocks.sample_noise, t, f_z, stuck, columns, repeated, interval }
    }

    fn columns_of(&self, good: &[bool]) -> Vec<Vec<f64>> {
        self.columns.iter().map(|column| kept(column, good)).collect()
    }

    /// Cell of each sample.
    fn cell_of(&self, i: usize) -> usize {
        let [from, to] = self.window.span;
        whole((self.t[i] - from) / (to - from) * CELLS as f64).min(CELLS - 1)
    }

    /// Residuals about a fit through the medians of the cells, which no spike moves. The once-per-revolution term is
    /// left in them: cells may be longer than a revolution.
    fn residuals_of_medians(&self) -> Vec<Vector3<f64>> {
        let [from, to] = self.window.span;
        let shape = Shape { omega: 0.0, ..self.window.shape };
        let (mut middles, mut medians) = (Vec::new(), Vec::new());
        let indices: Vec<usize> = (0..self.t.len()).collect();
        for cell in indices.chunk_by(|a, b| self.cell_of(*a) == self.cell_of(*b)) {
            let readings = |axis: usize| cell.iter().map(move |i| self.f_z[*i][axis]).filter(|f| f.is_finite());
            middles.push(from + (self.cell_of(cell[0]) as f64 + 0.5) * (to - from) / CELLS as f64);
            medians.push(Vector3::from_fn(|axis, _| median(&mut readings(axis).collect::<Vec<f64>>())));
        }
        let fit = Regression::new(shape.columns(&middles)).map_or(vec![], |regression| regression.solve(&medians));
        self.residuals(&fit)
    }

    /// Residuals about the terms that have coefficients: all, or the last.
    fn residuals(&self, coefficients: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let mut residuals = self.f_z.clone();
        for (column, b) in self.columns.iter().rev().zip(coefficients.iter().rev()) {
            residuals.iter_mut().zip(column).for_each(|(r, x)| *r -= b * *x);
        }
        residuals
    }

    /// What is not used, by kind. Samples that never came are counted by the intervals between those that did.
    fn left_out(&self, good: &[bool]) -> LeftOut {
        let unreadable = self.f_z.iter().filter(|f| !f.iter().all(|f| f.is_finite())).count();
        let stuck = self.stuck.iter().filter(|stuck| **stuck).count();
        let rejected = good.iter().filter(|good| !**good).count();
        let gap = |pair: &[f64]| whole(((pair[1] - pair[0]) / self.interval).round()).saturating_sub(1);
        LeftOut {
            spikes: rejected.saturating_sub(unreadable + stuck),
            stuck,
            missing: unreadable + self.t.windows(2).map(gap).sum::<usize>(),
            repeated: self.repeated,
        }
    }

    /// Why most samples cannot be used.
    fn unsteady(&self, index: usize, good: usize, repeat_rate: &[f64; 3]) -> ReductionError {
        let (window, samples) = (self.window.span, self.t.len());
        match most_stuck(&self.f_z, repeat_rate) {
            (axis, value, stuck) if 2 * stuck > samples => {
                ReductionError::Stuck { index, window, axis, value, samples, stuck }
            }
            _ => ReductionError::Unsteady { index, window, samples, good },
        }
    }

    /// Refuses readings that pile up at the end of their range: what is cut off there is missing in the mean.
    fn check_range(&self, index: usize, residuals: &[Vector3<f64>]) -> Result<(), ReductionError> {
        let limit = self.limit(residuals);
        for axis in (0..3).filter(|axis| self.white[*axis] > self.digit[*axis]) {
            let near = residuals.iter().zip(&self.f_z).filter(|(r, _)| r[axis].abs() <= limit[axis]);
            if let Some((value, piled_up)) = piled_up(near.map(|(_, f)| f[axis])) {
                let (window, samples) = (self.window.span, self.t.len());
                return Err(ReductionError::Saturated { index, window, axis, value, samples, piled_up });
            }
        }
        Ok(())
    }

    /// What residuals of good samples are within [m/s^2].
    fn limit(&self, residuals: &[Vector3<f64>]) -> [f64; 3] {
        let cut = cut(residuals.len());
        [0, 1, 2].map(|axis| {
            let sizes = residuals.iter().map(|r| r[axis].abs()).filter(|r| r.is_finite());
            // Rounding moves a reading by a digit at most, and may leave no spread to see.
            cut * MAD * median(&mut sizes.collect::<Vec<f64>>()) + self.digit[axis]
        })
    }

    /// Which samples are no spikes and not stuck in any axis. Symmetric, so that the mean of good samples is not
    /// biased.
    fn without_outliers(&self, residuals: &[Vector3<f64>]) -> Vec<bool> {
        let limit = self.limit(residuals);
        // A reading that is not a number is within no limit.
        let good = |(r, stuck): (&Vector3<f64>, &bool)| !stuck && (0..3).all(|axis| r[axis].abs() <= limit[axis]);
        residuals.iter().zip(&self.stuck).map(good).collect()
    }

    fn cells(&self, good: &[bool], residuals: &[Vector3<f64>], regression: &Regression, interval: f64) -> Cells {
        let [from, to] = self.window.span;
        let mut cells = Cells::empty(regression, (to - from) / CELLS as f64, interval);
        let good = (0..self.t.len()).filter(|i| good[*i]);
        for (row, i) in good.enumerate() {
            cells.add(self.cell_of(i), &residuals[i], regression.q.iter().map(|q| q[row]));
        }
        cells
    }
}

fn kept<T: Copy>(values: &[T], good: &[bool]) -> Vec<T> {
    values.iter().zip(good).filter(|value| *value.1).map(|value| *value.0).collect()
}
