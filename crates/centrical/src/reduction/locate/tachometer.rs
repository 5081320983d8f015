//! The speed of a plateau as a tachometer or a counter of revolutions shows it.
//!
//! The window is that of the mean reading, and so is the shape in time: `Omega(t) = Omega (1 + epsilon exp(-(t - t_0) / tau))`
//! with the settling time of the record, so that the speed is the settled one, to which the mean belongs. Reports of a
//! tachometer are fitted by it, times of pulses by its integral. The scatter of groups of neighbouring samples gives the
//! variance, so that slow noise counts as it acts.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

use super::clock::SpeedTrace;
use crate::linalg::least_squares::LeastSquares;
use crate::reduction::terms::{FADED, Window};
use crate::statistics::{MAD, median, whole};

/// Pulses of an index mark or of an encoder.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PulseTrain {
    /// Time of each pulse on the counter's clock [s], not decreasing.
    pub t: Vec<f64>,
    /// Pulses in one revolution.
    pub per_revolution: f64,
}

/// The speed of one plateau as measured, before the scatter of all plateaus is pooled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedReading {
    /// Settled speed, without sign [rad/s].
    pub speed: f64,
    /// Variance of one sample by the scatter of groups: [rad^2/s^2] of reports, [rad^2] of phases.
    pub sample_variance: f64,
    /// Variance of the speed per variance of one sample.
    pub gain: f64,
    /// Groups less fitted terms.
    pub degrees_of_freedom: usize,
    /// Step of the reports where their noise does not bridge it [rad/s]; 0 otherwise.
    pub resolution: f64,
    /// Slope of the speed over the window beyond its settling, and its standard uncertainty [rad/s^2]; `None` where the samples are
    /// too few.
    pub slope: Option<[f64; 2]>,
}

/// Groups into which the samples of a plateau are collected: as long as possible for slow noise, and enough for its variance.
const GROUPS: usize = 16;

/// Rounds of finding spikes.
const ROUNDS: usize = 4;

/// A speed farther from the median one, relative, is that of an interruption of the plateau: its readings are left out as well.
const INTERRUPTED: f64 = 0.01;

/// Samples farther than this many robust standard deviations from the fit are spikes.
const SPIKE: f64 = 8.0;

impl PulseTrain {
    /// The mean speed between neighbouring pulses, by the counter's clock: what finds the ramps.
    pub(super) fn trace(&self) -> SpeedTrace {
        let angle = TAU / self.per_revolution;
        let between = self.t.windows(2).filter(|pair| pair[1] > pair[0]);
        let (t, omega) = between.map(|pair| (0.5 * (pair[0] + pair[1]), angle / (pair[1] - pair[0]))).unzip();
        SpeedTrace { t, omega }
    }

    /// The speed of the plateau in `window`, `margin` [s] left out at both ends.
    pub(super) fn speed(&self, offset: f64, window: &Window, margin: f64) -> Option<SpeedReading> {
        let times = inside(&self.t, offset, window, margin)?;
        let t: Vec<f64> = self.t[times].iter().map(|t| t + offset).collect();
        let mut steps: Vec<f64> = t.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let step = median(&mut steps);
        if step.is_nan() || step <= 0.0 {
            return None;
        }
        // A pulse that was missed leaves a gap of a whole number of steps.
        let mut count = 0.0;
        let mut last = t[0];
        let phases = t.iter().map(|t| {
            count += ((t - last) / step).round();
            last = *t;
            count * TAU / self.per_revolution
        });
        let phases: Vec<f64> = phases.collect();
        let middle = 0.5 * (t[0] + t[t.len() - 1]);
        let mut columns = vec![t.iter().map(|t| t - middle).collect(), vec![1.0; t.len()]];
        columns.extend(settling(&t, window));
        // A speed that runs by a slope `a` turns by `a t^2 / 2`.
        let running: Vec<f64> = t.iter().map(|t| 0.5 * (t - middle).powi(2)).collect();
        Fitted::of(&columns, &running, &phases, 0.0)?.reading(0.0, t[t.len() - 1] - t[0])
    }
}

impl SpeedTrace {
    /// The speed of the plateau in `window`, `margin` [s] left out at both ends. `step` is that of the reports.
    pub(super) fn speed(&self, offset: f64, window: &Window, margin: f64, step: f64) -> Option<SpeedReading> {
        let times = inside(&self.t, offset, window, margin)?;
        let mut reports: Vec<f64> =
            self.omega[times.clone()].iter().copied().filter(|omega| omega.is_finite()).collect();
        let middle = median(&mut reports);
        let is_of_plateau = |k: &usize| (self.omega[*k] - middle).abs() <= INTERRUPTED * middle.abs();
        let (t, omega): (Vec<f64>, Vec<f64>) =
            times.filter(is_of_plateau).map(|k| (self.t[k] + offset, self.omega[k])).unzip();
        let mut columns = vec![vec![1.0; t.len()]];
        columns.extend(settling(&t, window));
        let fitted = Fitted::of(&columns, &t, &omega, step)?;
        let is_bridged = fitted.deviation >= step;
        fitted.reading(if is_bridged { 0.0 } else { step }, t.last()? - t[0])
    }

    /// The step of the reports [rad/s]: the smallest difference between two of them.
    pub(super) fn step(&self) -> f64 {
        let mut reports: Vec<f64> = self.omega.iter().copied().filter(|omega| omega.is_finite()).collect();
        reports.sort_unstable_by(f64::total_cmp);
        let rounding = 1e-12 * reports.last().map_or(0.0, |last| last.abs());
        let steps = reports.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > rounding);
        steps.reduce(f64::min).unwrap_or(0.0)
    }
}

/// The samples in a window without its margins; `None` if these leave nothing.
fn inside(t: &[f64], offset: f64, window: &Window, margin: f64) -> Option<std::ops::Range<usize>> {
    let [from, to] = [window.span[0] + margin, window.span[1] - margin].map(|end| end - offset);
    let range = t.partition_point(|t| *t < from)..t.partition_point(|t| *t <= to);
    (range.len() >= 4).then_some(range)
}

/// The settling of the speed, 1 at the first of the times, if it has not faded by then.
fn settling(t: &[f64], window: &Window) -> Option<Vec<f64>> {
    let time = window.shape.settling?.time;
    let first = *t.first()?;
    let is_faded = (first - window.shape.start) > 0.5 * FADED * time;
    (!is_faded).then(|| t.iter().map(|t| (-(t - first) / time).exp()).collect())
}

/// A least-squares fit without spikes.
struct Fitted {
    /// First coefficient, and its variance per variance of a sample.
    value: f64,
    gain: f64,
    /// Robust standard deviation of the residuals.
    deviation: f64,
    /// Variance of a sample by the scatter of groups, and its degrees of freedom.
    variance: f64,
    degrees_of_freedom: usize,
    /// Coefficient of a further column, and its standard uncertainty.
    further: Option<[f64; 2]>,
}

impl Fitted {
    /// Fits `values`; a residual below `step` is not a spike. The column `further` is fitted to what the others leave.
    fn of(columns: &[Vec<f64>], further: &[f64], values: &[f64], step: f64) -> Option<Self> {
        let mut kept: Vec<usize> = (0..values.len()).collect();
        // Spikes hide one another in a fit: a few rounds find them all. What a last round leaves is not a spike but a misfit,
        // which the scatter of groups shows.
        for round in 1..=ROUNDS {
            let design = DMatrix::from_fn(kept.len(), columns.len(), |row, column| columns[column][kept[row]]);
            let of_kept = |values: &[f64]| DVector::from_fn(kept.len(), |row, _| values[kept[row]]);
            let equations = (kept.len() > columns.len()).then(|| LeastSquares::of_columns(design.clone())).flatten()?;
            let coefficients = equations.solve(of_kept(values));
            let residual =
                |k: &usize| values[*k] - columns.iter().zip(&coefficients).map(|(c, x)| c[*k] * x).sum::<f64>();
            let residuals: Vec<f64> = kept.iter().map(residual).collect();
            let mut sizes: Vec<f64> = residuals.iter().map(|r| r.abs()).collect();
            let deviation = MAD * median(&mut sizes);
            let limit = SPIKE * deviation.max(step).max(1e-14 * coefficients[0].abs());
            let good: Vec<usize> = kept.iter().copied().filter(|k| residual(k).abs() <= limit).collect();
            if good.len() == kept.len() || round == ROUNDS {
                let (variance, degrees_of_freedom) = scatter(&residuals, columns.len());
                let further = of_kept(further);
                let beside = &further - design * equations.solve(further.clone());
                let further = coefficient_beside(&beside, columns.len(), &residuals);
                let gain = equations.standard_uncertainties()[0].powi(2);
                return Some(Self { value: coefficients[0], gain, deviation, variance, degrees_of_freedom, further });
            }
            kept = good;
        }
        None
    }

    /// The reading over a window of a duration [s]; reports by steps may miss a slope by a step over the window.
    fn reading(self, resolution: f64, duration: f64) -> Option<SpeedReading> {
        let Self { value, gain, variance, degrees_of_freedom, further, .. } = self;
        let speed = value.abs();
        let slope = further.map(|[slope, u]| [slope * value.signum(), u.hypot(resolution / duration)]);
        let reading = SpeedReading { speed, sample_variance: variance, gain, degrees_of_freedom, resolution, slope };
        (degrees_of_freedom > 0 && speed.is_finite() && variance.is_finite()).then_some(reading)
    }
}

/// Coefficient of a column, which is what other columns leave of it, in the residuals of the fit by these `others`; and its standard
/// uncertainty by their scatter about it.
fn coefficient_beside(beside: &DVector<f64>, others: usize, residuals: &[f64]) -> Option<[f64; 2]> {
    let square: f64 = beside.iter().map(|c| c * c).sum();
    let coefficient = beside.iter().zip(residuals).map(|(c, r)| c * r).sum::<f64>() / square;
    let about: Vec<f64> = beside.iter().zip(residuals).map(|(c, r)| r - coefficient * c).collect();
    let (variance, degrees_of_freedom) = scatter(&about, others + 1);
    (degrees_of_freedom > 0 && coefficient.is_finite()).then(|| [coefficient, (variance / square).sqrt()])
}

/// Variance of one sample from the means of groups, and its degrees of freedom.
fn scatter(residuals: &[f64], terms: usize) -> (f64, usize) {
    let size = whole(residuals.len() as f64 / GROUPS as f64).max(1);
    let groups = residuals.chunks_exact(size).map(|group| group.iter().sum::<f64>() / size as f64);
    let (count, squares) = groups.fold((0, 0.0), |(count, squares), mean| (count + 1, squares + mean * mean));
    let degrees_of_freedom = usize::saturating_sub(count, terms);
    (size as f64 * squares / (degrees_of_freedom.max(1) as f64), degrees_of_freedom)
}
