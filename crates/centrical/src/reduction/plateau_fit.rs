//! Second pass: the mean of one plateau from its samples.

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Vector3};

use super::blocks::Blocks;
use super::cells::{CELLS, Cells};
use super::noise::NoiseModel;
use super::rounding::bias_variance;
use super::samples::Samples;
use super::saturation::{may_be_piled_up, piled_up};
use super::settling::TimeStep;
use super::shape::Shape;
use super::strips::{Fitted, Strips};
use super::triangle::{TERMS, Triangle};
use super::window::Window;
use super::{LeftOut, PlateauMean, RecordSlice, ReductionError};

/// One plateau, fitted; what its covariance needs is kept in cells.
#[derive(Debug, Clone)]
pub struct PlateauFit {
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
    pub(super) settling: Vector3<f64>,
    /// Residuals and design, condensed.
    pub(super) cells: Cells,
}

/// A plateau whose samples come part by part, in the order of time: what is left of a part that is judged is little.
#[derive(Debug, Clone)]
pub struct Plateau<'a> {
    index: usize,
    window: &'a Window,
    blocks: &'a Blocks,
    fitted: Fitted,
    /// Their triangle and coefficients.
    fit: Option<(Triangle, Vec<Vector3<f64>>)>,
    /// Samples that are not used.
    left_out: LeftOut,
    /// Stamp of the last one [s].
    last: Option<f64>,
}

impl<'a> Plateau<'a> {
    pub(super) fn new(index: usize, window: &'a Window, blocks: &'a Blocks) -> Self {
        let (fitted, left_out) = (Fitted::default(), LeftOut::default());
        Self { index, window, blocks, fitted, fit: None, left_out, last: None }
    }

    /// Adds the samples of the next part, from and to [s]; so many with the stamp of the one before had been left out of them. They are
    /// judged by the fit of all samples so far.
    ///
    /// # Errors
    /// [`ReductionError`] if the samples are not steady, or do not tell the mean from the once-per-revolution term.
    pub fn add(&mut self, part: [f64; 2], record: RecordSlice, repeated: usize) -> Result<(), ReductionError> {
        let index = self.index;
        let record = record.between(part);
        if record.t.is_empty() {
            return Ok(());
        }
        let samples = Samples::cut_out(record, repeated, self.window, self.blocks);
        let mut strips = Strips::of(&samples, std::mem::take(&mut self.fitted));
        let so_far = self.fit.take().map(|(_, coefficients)| coefficients);
        strips.judge(&so_far.unwrap_or_else(|| samples.fit_of_medians()), false);
        let mut once_out = false;
        self.fit = loop {
            let good = strips.good();
            if 2 * good <= samples.len() {
                return Err(samples.unsteady(index, good));
            }
            let (triangle, coefficients) = strips.solve().ok_or_else(|| self.aliased())?;
            if !strips.judge(&coefficients, once_out) {
                break Some((triangle, coefficients));
            }
            // From the second fit on, once out is out: the set shrinks, and the loop ends.
            once_out = true;
        };
        check_range(&samples, &strips, index)?;
        self.left_out += samples.left_out(self.last, samples.len() - strips.good(), strips.stuck_and_unreadable());
        self.last = samples.t.last().copied();
        self.fitted = strips.into_fitted();
        Ok(())
    }

    /// Ends the plateau.
    ///
    /// # Errors
    /// [`ReductionError::Unsteady`] if no samples came.
    pub fn finish(self) -> Result<PlateauFit, ReductionError> {
        let (index, window) = (self.index, self.window.span);
        let none = ReductionError::Unsteady { index, window, samples: 0, good: 0 };
        let (triangle, coefficients) = self.fit.as_ref().ok_or(none)?;
        Ok(PlateauFit::of(&self, coefficients, triangle))
    }

    fn aliased(&self) -> ReductionError {
        let (omega, interval) = (self.window.shape.omega, self.blocks.interval);
        ReductionError::RevolutionAliased { index: self.index, omega, interval }
    }
}

impl PlateauFit {
    /// The fit of all parts.
    fn of(plateau: &Plateau, coefficients: &[Vector3<f64>], triangle: &Triangle) -> Self {
        let Plateau { window: Window { span, shape }, blocks, fitted, left_out, .. } = plateau;
        let kept = fitted.good();
        let squares: Vector3<f64> = fitted.sums(coefficients).map(|(_, sums)| sums.squares).sum();
        let columns = coefficients.len();
        let zero = Vector3::zeros();
        Self {
            window: *span,
            samples: kept,
            rejected: fitted.bad(),
            left_out: *left_out,
            mean: coefficients[columns - 1],
            once_per_revolution: if shape.omega == 0.0 { [zero; 2] } else { [coefficients[0], coefficients[1]] },
            settling: shape.settling.map_or(zero, |_| coefficients[columns - 2]),
            shape: *shape,
            digit: blocks.digit,
            variance: squares / kept as f64,
            cells: cells(plateau, triangle, coefficients),
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

    /// Covariance of either quadrature of the once-per-revolution term: `2 S(Omega / 2 pi) / T`, with the two-sided
    /// density `S` of the noise at the frequency of rotation and the time `T` that was sampled; for whole revolutions.
    fn covariance_of_harmonic(&self, noise: &NoiseModel) -> Matrix3<f64> {
        if self.shape.omega == 0.0 {
            return Matrix3::zeros();
        }
        noise.density(self.shape.omega / TAU) * (2.0 / (self.samples as f64 * self.cells.interval))
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

/// Refuses good readings that pile up at the end of their range: what is cut off there is missing in the mean.
fn check_range(samples: &Samples, strips: &Strips, index: usize) -> Result<(), ReductionError> {
    let told = |axis: &usize| samples.white[*axis] > samples.digit[*axis];
    let looked_at = (0..3).filter(told).filter(|axis| may_be_piled_up(strips.most_at_an_end(*axis)));
    for axis in looked_at {
        if let Some((value, piled_up)) = piled_up(strips.good_readings(axis)) {
            let (window, samples) = (samples.window.span, samples.len());
            return Err(ReductionError::Saturated { index, window, axis, value, samples, piled_up });
        }
    }
    Ok(())
}

/// The strips' sums, gathered by cell.
fn cells(plateau: &Plateau, triangle: &Triangle, coefficients: &[Vector3<f64>]) -> Cells {
    let terms = coefficients.len();
    let [from, to] = plateau.window.span;
    let mut cells = Cells::empty(triangle, terms, (to - from) / CELLS as f64, plateau.blocks.interval);
    let mut sums = vec![(0, Vector3::zeros(), [0.0; TERMS]); CELLS];
    for (cell, of_strip) in plateau.fitted.sums(coefficients) {
        let (count, residuals, columns) = &mut sums[cell];
        *count += of_strip.count;
        *residuals += of_strip.residuals;
        columns.iter_mut().zip(of_strip.columns).for_each(|(sum, of_strip)| *sum += of_strip);
    }
    for (cell, (count, residuals, columns)) in sums.into_iter().enumerate() {
        cells.fill(cell, count, residuals, &triangle.orthonormal(columns, terms)[..terms]);
    }
    cells
}
