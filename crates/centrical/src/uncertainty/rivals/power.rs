//! The power of an F test.

use statrs::function::beta::beta_reg;
use statrs::function::gamma::ln_gamma;

use crate::statistics::f_tail;

/// Halvings of an interval: to a millionth of it.
const HALVINGS: usize = 24;

/// Non-centrality with which an F test of `m` and `n` degrees of freedom at the `level` has the power asked for; `None`
/// without degrees of freedom.
pub(super) fn non_centrality(m: usize, n: usize, level: f64, power: f64) -> Option<f64> {
    if m == 0 || n == 0 {
        return None;
    }
    let critical = bisect(|f| f_tail(f, m as f64, n as f64) < level)?;
    bisect(|lambda| 1.0 - non_central_f(critical, m, n, lambda) > power)
}

/// Where a condition that holds from some positive number on begins.
fn bisect(holds: impl Fn(f64) -> bool) -> Option<f64> {
    let mut high = 1.0;
    while !holds(high) {
        high *= 2.0;
        if high > 1e6 {
            return None;
        }
    }
    let mut low = 0.0;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if holds(middle) { high = middle } else { low = middle }
    }
    Some(high)
}

/// Probability that a non-central F is at most `f`: a Poisson mixture of central ones.
fn non_central_f(f: f64, m: usize, n: usize, lambda: f64) -> f64 {
    let (m, n) = (m as f64, n as f64);
    let y = m * f / (m * f + n);
    let half = 0.5 * lambda;
    // Beyond eight standard deviations of the Poisson number nothing is left.
    let spread = 8.0 * half.sqrt() + 8.0;
    let (first, last) = ((half - spread).max(0.0).floor(), (half + spread).ceil());
    let mut sum = 0.0;
    let mut j = first;
    while j <= last {
        let weight = (j * half.max(f64::MIN_POSITIVE).ln() - half - ln_gamma(j + 1.0)).exp();
        sum += weight * beta_reg(0.5 * m + j, 0.5 * n, y);
        j += 1.0;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `scipy.stats.ncf.cdf(q, m, n, lambda)`, and `f.cdf(q, m, n)` without non-centrality, of SciPy 1.17.
    #[test]
    fn as_scipy_has_it() {
        for (q, m, n, lambda, expected) in [
            (3.0, 3, 275, 0.0, 0.968_956_534_582_658),
            (5.0, 3, 275, 20.0, 0.202_291_105_544_712),
            (2.0, 21, 250, 60.0, 0.005_264_271_838_177),
        ] {
            let p = non_central_f(q, m, n, lambda);
            assert!((p - expected).abs() < 1e-12, "{q} {m} {n} {lambda}: {p} and {expected}");
        }
    }
}
