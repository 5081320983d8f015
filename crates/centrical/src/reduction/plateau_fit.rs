//! Second pass: the mean of one plateau from its samples.

use nalgebra::{Matrix3, Vector3};

use super::blocks::{Blocks, MAD, cut, median, whole};
use super::cells::{CELLS, Cells};
use super::noise::NoiseModel;
use super::regression::Regression;
use super::rounding::bias_variance;
use super::settling::TimeStep;
use super::shape::Shape;
use super::stuck::stuck_on_any_axis;
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
        let mut good = samples.without_outliers(&samples.residuals_of_medians());
        let mut first = true;
        loop {
            let (all, left) = (good.len(), good.iter().filter(|good| **good).count());
            if 2 * left <= all {
                return Err(ReductionError::Unsteady { index, window: window.span, samples: all, good: left });
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
    t: Vec<f64>,
    f_z: Vec<Vector3<f64>>,
    stuck: Vec<bool>,
    columns: Vec<Vec<f64>>,
}

impl<'a> Samples<'a> {
    /// The samples of a record in a window, without repeated stamps.
    fn cut_out(record: RecordSlice, window: &'a Window, blocks: &'a Blocks) -> Self {
        let RecordSlice { t, f_z } = record.between(window.span);
        let first_of_stamp = |i: &usize| *i == 0 || t[*i] > t[*i - 1];
        let reading = |i: usize| Vector3::new(f_z[0][i], f_z[1][i], f_z[2][i]);
        let (t, f_z): (Vec<f64>, Vec<Vector3<f64>>) =
            (0..t.len()).filter(first_of_stamp).map(|i| (t[i], reading(i))).unzip();
        let columns = window.shape.columns(&t);
        let stuck = stuck_on_any_axis(&f_z, &blocks.repeat_rate);
        Self { window, digit: &blocks.digit, t, f_z, stuck, columns }
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

    /// Which samples are no spikes and not stuck in any axis. Symmetric, so that the mean of good samples is not
    /// biased.
    fn without_outliers(&self, residuals: &[Vector3<f64>]) -> Vec<bool> {
        let cut = cut(residuals.len());
        let limit = [0, 1, 2].map(|axis| {
            let sizes = residuals.iter().map(|r| r[axis].abs()).filter(|r| r.is_finite());
            // Rounding moves a reading by a digit at most, and may leave no spread to see.
            cut * MAD * median(&mut sizes.collect::<Vec<f64>>()) + self.digit[axis]
        });
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
