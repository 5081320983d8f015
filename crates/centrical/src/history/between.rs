//! The component of variance between sessions.
//!
//! A unit that is switched off and on, carried and mounted again is not quite the same unit. With `y_i` the value of session
//! `i`, `v_i` the variance that this session states and `x_i` the curve (a constant or a line in time),
//!
//! `y_i = x_i^T beta + u_i + e_i`,  `u_i ~ N(0, tau^2)`,  `e_i ~ N(0, v_i)`.
//!
//! `Q(tau^2) = min_beta sum_i (y_i - x_i^T beta)^2 / (v_i + tau^2)` follows chi^2 with `nu = k - q` degrees of freedom at the true
//! `tau^2`, exactly, and falls as `tau^2` grows. All that is said of `tau^2` solves `Q(tau^2) = c`: the estimate of R. C. Paule
//! and J. Mandel (J. Res. NBS 87, 1982) for `c = nu`; the interval of W. Viechtbauer (Statistics in Medicine 26, 2007) for quantiles of
//! chi^2; the law of a forecast for all of them.

use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::line::{Curve, Line};
use super::quantiles::Quantiles;
use super::series::Series;
use crate::uncertainty::chi_squared_tail;

/// The component of variance between sessions, beside the stated one.
#[derive(Debug, Clone, PartialEq)]
pub struct Between {
    /// `tau^2` of Paule and Mandel, zero where the stated uncertainties explain the scatter.
    pub variance: f64,
    /// The interval that covers it with the `coverage` asked for (profile of Q).
    pub interval: [f64; 2],
    /// Cochran's `Q(0)`: chi^2 if there is no such component.
    pub misfit: f64,
    /// Degrees of freedom `nu`.
    pub degrees_of_freedom: usize,
    /// Probability of so large a misfit without the component: that of `F = Q / nu` with `nu` and infinitely many degrees.
    pub probability: f64,
    /// `Q` at the estimate over `nu`: 1 where there is a component.
    pub(super) scale: f64,
    /// The confidence distribution: weights, and the `tau^2` with `Q(tau^2) = c` for values `c` of chi^2.
    pub(super) likely: Vec<(f64, f64)>,
}

impl Between {
    /// The component that `series` have in common, `sum_s Q_s(tau^2) = c`: one unit by itself, or units of one type with few
    /// sessions each. Series without a degree of freedom are left out; `None` where none has one.
    pub fn of(series: &[Series], curve: Curve, quantiles: &Quantiles, coverage: f64) -> Option<Self> {
        let is_used =
            |s: &&Series| degrees_of_freedom(s, curve).is_some() && Line::new(s.points(), curve, 0.0).is_some();
        let used: Vec<&Series> = series.iter().filter(is_used).collect();
        let nu = used.iter().filter_map(|s| degrees_of_freedom(s, curve)).sum();
        let misfit_and_fall = |tau: f64| {
            let lines = used.iter().filter_map(|s| Line::new(s.points(), curve, tau));
            lines.fold((0.0, 0.0), |(misfit, fall), line| (misfit + line.misfit, fall + line.fall))
        };
        let mut likely = Vec::new();
        let mut tau = 0.0;
        // From large values of chi^2 to small ones: tau^2 grows.
        for &(weight, chi_squared) in quantiles.of(nu)?.iter() {
            tau = solution(misfit_and_fall, chi_squared, tau)?;
            likely.push((weight, tau));
        }
        let variance = solution(misfit_and_fall, nu as f64, 0.0)?;
        let law = ChiSquared::new(nu as f64).ok()?;
        let end = |probability: f64| solution(misfit_and_fall, law.inverse_cdf(probability), 0.0);
        let interval = [end(0.5 + 0.5 * coverage)?, end(0.5 - 0.5 * coverage)?];
        let misfit = misfit_and_fall(0.0).0;
        let scale = misfit_and_fall(variance).0 / nu as f64;
        let probability = chi_squared_tail(misfit, nu);
        Some(Self { variance, interval, misfit, degrees_of_freedom: nu, probability, scale, likely })
    }

    /// `F = Q / nu`: the scatter about the curve over the one that the stated uncertainties explain, in squares.
    pub fn variance_ratio(&self) -> f64 {
        self.misfit / self.degrees_of_freedom as f64
    }
}

/// `k - q`, if positive.
fn degrees_of_freedom(series: &Series, curve: Curve) -> Option<usize> {
    series.points().len().checked_sub(curve.unknowns()).filter(|nu| *nu > 0)
}

/// Newton's method on `1 / Q`, a straight line where all `v_i` are equal, and concave otherwise: it never steps too far.
fn solution(misfit_and_fall: impl Fn(f64) -> (f64, f64), target: f64, start: f64) -> Option<f64> {
    let mut tau = start;
    for _ in 0..STEPS {
        let (misfit, fall) = misfit_and_fall(tau);
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

/// Far more than it takes.
const STEPS: usize = 100;

/// A step after which all digits are there.
const TOLERANCE: f64 = 1e-8;
