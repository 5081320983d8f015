//! The component of variance between sessions.
//!
//! A unit that is switched off and on, carried and mounted again is not quite the same unit. With `y_i` the value of session
//! `i`, `v_i` the variance that this session states and `x_i` the curve (a constant or a line in time),
//!
//! `y_i = x_i^T beta + u_i + e_i`,  `u_i ~ N(0, tau^2)`,  `e_i ~ N(0, v_i)`.
//!
//! `Q(tau^2) = min_beta sum_i (y_i - x_i^T beta)^2 / (v_i + tau^2)` follows chi^2 with `nu = k - q` degrees of freedom at the true
//! `tau^2`, exactly, and falls as `tau^2` grows. Errors `s ~ N(0, 1)` that some sessions share and others do not, as after a move to another
//! station, change the values by `B s`:
//!
//! `Q(tau^2) = min_(beta, s) sum_i (y_i - x_i^T beta - (B s)_i)^2 / (v_i + tau^2) + |s|^2`.
//!
//! All that is said of `tau^2` solves `Q(tau^2) = c`: the estimate of R. C. Paule and J. Mandel (J. Res. NBS 87, 1982) for `c = nu`; the
//! interval of W. Viechtbauer (Statistics in Medicine 26, 2007) for quantiles of chi^2; the law of a forecast for all of them.

use std::mem;

use nalgebra::{DMatrix, DVector};

use super::law::{NormalMixture, Part};
use super::line::{Curve, Line};
use super::quantiles::Quantiles;
use super::series::{Point, Series};
use crate::linalg::least_squares::LeastSquares;
use crate::statistics::{chi_squared_quantiles, chi_squared_tail};

/// The component of variance between sessions, beside the stated one.
#[derive(Debug, Clone, PartialEq)]
pub struct Between {
    /// `tau^2` of Paule and Mandel, zero where the stated uncertainties explain the scatter.
    pub variance: f64,
    /// The interval that covers it with the `coverage` asked for (profile of Q).
    pub interval: [f64; 2],
    /// Cochran's `Q(0)`: chi^2 without such a component.
    pub misfit: f64,
    /// Degrees of freedom `nu`.
    pub degrees_of_freedom: usize,
    /// Probability of so large a misfit without the component: that of `F = Q / nu` with `nu` and infinitely many degrees.
    pub probability: f64,
    /// `Q` at the estimate over `nu`: 1 where there is a component.
    pub(super) scale: f64,
}

/// The confidence distribution of the component, which forecasts need: weights, and the `tau^2` with `Q(tau^2) = c` for values `c` of chi^2.
#[derive(Debug, Clone, PartialEq)]
pub struct Likely(pub(super) Vec<(f64, f64)>);

impl Between {
    /// The component that `series` have in common, `sum_s Q_s(tau^2) = c`: one unit by itself, or units of one type with few
    /// sessions each. Series without a degree of freedom are left out; `None` where none has one.
    pub fn of(series: &[Series], curve: Curve, coverage: f64) -> Option<Self> {
        let mut scatter = Scatter::of(series, curve);
        let nu = scatter.degrees_of_freedom;
        let [low, high] = chi_squared_quantiles(nu as f64, coverage)?;
        let variance = scatter.solution(nu as f64, 0.0)?;
        let interval = [scatter.solution(high, 0.0)?, scatter.solution(low, 0.0)?];
        let misfit = scatter.misfit_and_fall(0.0).0;
        let scale = scatter.misfit_and_fall(variance).0 / nu as f64;
        let probability = chi_squared_tail(misfit, nu);
        Some(Self { variance, interval, misfit, degrees_of_freedom: nu, probability, scale })
    }

    /// `F = Q / nu`: the scatter about the curve over the one that the stated uncertainties explain, in squares.
    pub fn variance_ratio(&self) -> f64 {
        self.misfit / self.degrees_of_freedom as f64
    }
}

impl Likely {
    /// The law of the error of a reading, compensated by a calibration that states the variance `stated` of it, after another switch-on: both
    /// sessions deviate, `N(0, stated + 2 tau^2)`.
    pub fn after_switch_on(&self, stated: f64) -> NormalMixture {
        let part =
            |(weight, tau): &(f64, f64)| Part { weight: *weight, mean: 0.0, deviation: (stated + 2.0 * tau).sqrt() };
        NormalMixture::new(self.0.iter().map(part))
    }

    /// The distribution of the component that `series` have in common; `None` as of [`Between::of`].
    pub fn of(series: &[Series], curve: Curve, quantiles: &Quantiles) -> Option<Self> {
        let mut scatter = Scatter::of(series, curve);
        let mut tau = 0.0;
        let mut likely: Vec<(f64, f64)> = Vec::new();
        // From large values of chi^2 to small ones: tau^2 grows, from zero where the stated uncertainties explain the scatter.
        for &(weight, chi_squared) in quantiles.of(scatter.degrees_of_freedom)?.iter() {
            tau = scatter.solution(chi_squared, tau)?;
            match likely.last_mut() {
                Some((of_last, last)) if *last == tau => *of_last += weight,
                _ => likely.push((weight, tau)),
            }
        }
        Some(Self(likely))
    }
}

/// `Q` of several series as a function of `tau^2`.
struct Scatter<'a> {
    used: Vec<(&'a Series, Option<DMatrix<f64>>)>,
    curve: Curve,
    degrees_of_freedom: usize,
    /// Room for weights: `Q` is asked for hundreds of times.
    weights: Vec<f64>,
}

impl<'a> Scatter<'a> {
    fn of(series: &'a [Series], curve: Curve) -> Self {
        let is_used =
            |s: &&Series| degrees_of_freedom(s, curve).is_some() && Line::new(s.points(), curve, 0.0).is_some();
        let used: Vec<_> = series.iter().filter(is_used).map(|series| (series, series.shared_by_some())).collect();
        let nu = used.iter().filter_map(|(series, _)| degrees_of_freedom(series, curve)).sum();
        Self { used, curve, degrees_of_freedom: nu, weights: Vec::new() }
    }

    fn misfit_and_fall(&mut self, tau: f64) -> (f64, f64) {
        let (mut misfit, mut fall) = (0.0, 0.0);
        for (series, shared) in &self.used {
            if let Some(shared) = shared {
                let (of_series, its_fall) = misfit_and_fall(series.points(), shared, self.curve, tau);
                misfit += of_series;
                fall += its_fall;
                continue;
            }
            let weights = mem::take(&mut self.weights);
            if let Some(line) = Line::with_room(weights, series.points(), self.curve, tau) {
                misfit += line.misfit;
                fall += line.fall;
                self.weights = line.into_room();
            }
        }
        (misfit, fall)
    }

    /// Newton's method on `1 / Q`, a straight line where all `v_i` are equal, and concave otherwise: it never steps too far.
    fn solution(&mut self, target: f64, start: f64) -> Option<f64> {
        let mut tau = start;
        for _ in 0..STEPS {
            let (misfit, fall) = self.misfit_and_fall(tau);
            if misfit <= target {
                break;
            }
            let step = (misfit / target - 1.0) * misfit / fall;
            tau += step;
            // The digits double in each step.
            if step <= TOLERANCE * tau {
                break;
            }
        }
        tau.is_finite().then_some(tau)
    }
}

/// `Q` and `-dQ / d tau^2` with errors that some sessions share: the errors are unknowns, each with an equation that says `0 +- 1`.
fn misfit_and_fall(points: &[Point], shared: &DMatrix<f64>, curve: Curve, tau: f64) -> (f64, f64) {
    let (k, q, m) = (points.len(), curve.unknowns(), shared.ncols());
    let middle = points.iter().map(|p| p.time).sum::<f64>() / k as f64;
    let weights: Vec<f64> = points.iter().map(|p| 1.0 / (p.variance + tau)).collect();
    let design = DMatrix::from_fn(k, q + m, |i, j| match j {
        0 => 1.0,
        1 if q == 2 => points[i].time - middle,
        _ => shared[(i, j - q)],
    });
    let whitened = DMatrix::from_fn(k + m, q + m, |i, j| {
        if i < k { weights[i].sqrt() * design[(i, j)] } else { f64::from(u8::from(i - k + q == j)) }
    });
    let sizes = DVector::from_iterator(q + m, whitened.column_iter().map(|column| 1.0 / column.norm()));
    let values = DVector::from_iterator(k, points.iter().zip(&weights).map(|(p, w)| w.sqrt() * p.value));
    let solution = LeastSquares::new(whitened * DMatrix::from_diagonal(&sizes), sizes).solve(values);
    let (fitted, errors) = (design * &solution, solution.rows(q, m).norm_squared());
    let (mut misfit, mut fall) = (errors, 0.0);
    for ((point, weight), fitted) in points.iter().zip(&weights).zip(fitted.iter()) {
        let part = weight * (point.value - fitted).powi(2);
        misfit += part;
        fall += weight * part;
    }
    (misfit, fall)
}

/// `k - q`, if positive.
fn degrees_of_freedom(series: &Series, curve: Curve) -> Option<usize> {
    series.points().len().checked_sub(curve.unknowns()).filter(|nu| *nu > 0)
}

/// Far more than it takes.
const STEPS: usize = 100;

/// A step after which all digits are there.
const TOLERANCE: f64 = 1e-8;
