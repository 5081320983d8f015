//! Equivalent degrees of freedom: a variance estimate scatters as chi^2 over its degrees of freedom.
//!
//! Difference estimators: C. A. Greenhall and W. J. Riley, "Uncertainty of stability variances based on finite
//! differences", 35th PTTI Meeting, 2003 [GR]. Its letters are kept: d order, m averaging factor, F = m (F = 1 if
//! modified) filter factor, S = m (S = 1 if not overlapping) stride factor, M terms, r = M / S, alpha the power law.
//! Total estimators: W. J. Riley, NIST Special Publication 1065, tables 7 (total) and 8 (modified total), p. 41, and
//! its formula for the Hadamard total.

use super::estimator::Estimator;
use super::power_law::PowerLaw;

/// Sums longer than this are replaced by their limits [GR, section on the evaluation].
const J_MAX: usize = 100;

impl Estimator {
    /// Equivalent degrees of freedom of the estimator at averaging factor `m` on `points` gapless phase points, if
    /// their noise follows `law`. A factor too long for the record counts as one term.
    pub fn degrees_of_freedom(self, law: PowerLaw, m: usize, points: usize) -> f64 {
        let span = points as f64 / m as f64;
        let difference = |modified, overlapping| {
            Differences { alpha: law.alpha(), d: self.order(), m, modified, overlapping }.degrees_of_freedom(points)
        };
        match (self, law) {
            (Estimator::Allan | Estimator::Hadamard, _) => difference(false, false),
            (Estimator::Total, PowerLaw::White) => 1.5 * span,
            (Estimator::Total, PowerLaw::Flicker) => 1.17 * span - 0.22,
            (Estimator::Total, PowerLaw::RandomWalk) => 0.93 * span - 0.36,
            (Estimator::ModifiedTotal | Estimator::TimeTotal, _) if m >= SHORTEST_TOTAL => modified_total(law, span),
            (Estimator::HadamardTotal, _) if m >= SHORTEST_TOTAL && law <= PowerLaw::White => hadamard_total(law, span),
            // Where the totals have no formula they have at least the degrees of freedom of the estimators they improve on.
            (Estimator::ModifiedAllan | Estimator::Time | Estimator::ModifiedTotal | Estimator::TimeTotal, _) => {
                difference(true, true)
            }
            _ => difference(false, true),
        }
    }
}

/// The formulas of the modified and Hadamard totals hold from this averaging factor on; Stable32 too keeps to it.
const SHORTEST_TOTAL: usize = 16;

/// `b T/tau - c` [SP 1065, table 8].
fn modified_total(law: PowerLaw, span: f64) -> f64 {
    let (b, c) = match law {
        PowerLaw::WhitePhase => (1.90, 2.1),
        PowerLaw::FlickerPhase => (1.20, 1.40),
        PowerLaw::White => (1.10, 1.2),
        PowerLaw::Flicker => (0.85, 0.50),
        _ => (0.75, 0.31),
    };
    b * span - c
}

/// `(T/tau) / (b_0 + b_1 tau/T)` [SP 1065, Hadamard total].
fn hadamard_total(law: PowerLaw, span: f64) -> f64 {
    let (b_0, b_1) = match law {
        PowerLaw::RandomRun => (1.276, 3.149),
        PowerLaw::FlickerWalk => (0.974, 2.554),
        PowerLaw::RandomWalk => (0.938, 1.696),
        PowerLaw::Flicker => (0.868, 1.140),
        _ => (0.559, 1.004),
    };
    span / (b_0 + b_1 / span)
}

/// A difference estimator in the letters of [GR].
struct Differences {
    alpha: i32,
    d: usize,
    m: usize,
    modified: bool,
    overlapping: bool,
}

impl Differences {
    /// Degrees of freedom on `n` phase points: the four cases of [GR].
    fn degrees_of_freedom(&self, n: usize) -> f64 {
        let s = if self.overlapping { self.m } else { 1 };
        let length = if self.modified { self.m } else { 1 } + self.m * self.d;
        let terms = 1 + s * n.saturating_sub(length) / self.m;
        let r = terms as f64 / s as f64;
        if !self.modified && self.alpha == 2 {
            return self.white_phase(terms, r);
        }
        let j = terms.min((self.d + 1) * s);
        let is_long = r > (self.d + 1) as f64;
        if j <= J_MAX {
            let f = self.filter_factor();
            let variance = self.s_z(0.0, f);
            variance * variance * terms as f64 / self.basic_sum(j, terms as f64, s as f64, f)
        } else if is_long {
            let (a_0, a_1) = self.limit();
            self.flicker_scale() * r / (a_0 - a_1 / r)
        } else {
            let stride = J_MAX as f64 / r;
            let f = if self.modified {
                1.0
            } else if self.alpha == 1 {
                stride
            } else {
                f64::INFINITY
            };
            let variance = match self.alpha {
                1 if !self.modified => self.flicker_scale().sqrt(),
                _ => self.s_z(0.0, f),
            };
            variance * variance * J_MAX as f64 / self.basic_sum(J_MAX, J_MAX as f64, stride, f)
        }
    }

    /// Filter factor of the sum: m itself while the sum stays short, else its limit [GR, cases 1 to 3].
    fn filter_factor(&self) -> f64 {
        if self.modified {
            1.0
        } else if self.alpha == 1 || self.m * (self.d + 1) <= J_MAX {
            self.m as f64
        } else {
            f64::INFINITY
        }
    }

    /// White phase, unmodified: the differences are correlated only at multiples of m [GR, case 4].
    fn white_phase(&self, terms: usize, r: f64) -> f64 {
        let d = self.d;
        let top = binomial(2 * d, d);
        let sum = if r.ceil() <= d as f64 {
            let lags = (1..d).take_while(|&k| (k as f64) < r);
            1.0 + 2.0 * lags.map(|k| (1.0 - k as f64 / r) * (binomial(2 * d, d - k) / top).powi(2)).sum::<f64>()
        } else {
            binomial(4 * d, 2 * d) / (top * top) - d as f64 / 2.0 / r
        };
        terms as f64 / sum
    }

    /// Unmodified flicker phase grows with ln m: `(b_0 + b_1 ln m)^2` [GR, table 3]; 1 for every other noise.
    fn flicker_scale(&self) -> f64 {
        if self.modified || self.alpha != 1 {
            return 1.0;
        }
        let (b_0, b_1) = if self.d == 2 { (15.23, 12.0) } else { (47.8, 40.0) };
        (b_0 + b_1 * (self.m as f64).ln()).powi(2)
    }

    /// `a_0, a_1` of the long-record limit [GR, tables 1 (modified) and 2].
    fn limit(&self) -> (f64, f64) {
        match (self.modified, self.d, self.alpha) {
            (true, 2, 2) => (7.0 / 9.0, 0.5),
            (true, 2, 1) => (0.997, 0.616),
            (true, 2, 0) => (1.033, 0.607),
            (true, 2, -1) => (1.048, 0.534),
            (true, 2, _) => (1.302, 0.535),
            (true, _, 2) => (22.0 / 25.0, 2.0 / 3.0),
            (true, _, 1) => (1.141, 0.843),
            (true, _, 0) => (1.184, 0.848),
            (true, _, -1) => (1.180, 0.816),
            (true, _, -2) => (1.175, 0.777),
            (true, _, -3) => (1.194, 0.703),
            (true, ..) => (1.489, 0.702),
            (false, 2, 1) => (790.0, 410.0),
            (false, 2, 0) => (2.0 / 3.0, 1.0 / 3.0),
            (false, 2, -1) => (0.852, 0.375),
            (false, 2, _) => (1.079, 0.368),
            (false, _, 1) => (9950.0, 6520.0),
            (false, _, 0) => (7.0 / 9.0, 0.5),
            (false, _, -1) => (0.997, 0.617),
            (false, _, -2) => (1.033, 0.607),
            (false, _, -3) => (1.053, 0.553),
            (false, ..) => (1.302, 0.535),
        }
    }

    /// `s_z(0)^2 + (1 - J/M) s_z(J/S)^2 + 2 sum_(j=1)^(J-1) (1 - j/M) s_z(j/S)^2` [GR, eq. 10].
    fn basic_sum(&self, j: usize, terms: f64, s: f64, f: f64) -> f64 {
        let square = |j: f64| (1.0 - j / terms) * self.s_z(j / s, f).powi(2);
        square(0.0) + square(j as f64) + 2.0 * (1..j).map(|j| square(j as f64)).sum::<f64>()
    }

    /// Autocovariance of the d-th difference: minus the 2d-th difference of `s_x`, alternating [GR, eq. 9].
    fn s_z(&self, t: f64, f: f64) -> f64 {
        let (d, order) = (self.d as f64, 2 * self.d);
        (0..=order)
            .map(|k| {
                let sign = if (k + self.d).is_multiple_of(2) { 1.0 } else { -1.0 };
                sign * binomial(order, k) * self.s_x(t + k as f64 - d, f)
            })
            .sum()
    }

    /// `F^2 (2 s_w(t) - s_w(t - 1/F) - s_w(t + 1/F))`, its limit for infinite F [GR, eq. 8].
    fn s_x(&self, t: f64, f: f64) -> f64 {
        if f.is_infinite() {
            return s_w(t, self.alpha + 2);
        }
        f * f * (2.0 * s_w(t, self.alpha) - s_w(t - 1.0 / f, self.alpha) - s_w(t + 1.0 / f, self.alpha))
    }
}

/// Generalised autocovariance of the power law [GR, eq. 7]: `-|t|, t^2 ln|t|, |t|^3, t^4 ln|t|, |t|^5, ...`
/// for alpha = 2, 1, 0, -1, -2, ...
fn s_w(t: f64, alpha: i32) -> f64 {
    let t = t.abs();
    let power = 3 - alpha;
    let size = match (t == 0.0, power % 2 == 0) {
        (true, _) => 0.0,
        (_, true) => t.powi(power) * t.ln(),
        (_, false) => t.powi(power),
    };
    if alpha == 2 { -size } else { size }
}

fn binomial(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |product, i| product * (n - i) as f64 / (i + 1) as f64)
}
