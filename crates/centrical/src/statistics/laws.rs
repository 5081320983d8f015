//! Laws of what chance makes, and of many tests at once.

use statrs::distribution::{ChiSquared, ContinuousCDF};
use statrs::function::beta::beta_reg;
use statrs::function::gamma::gamma_ur;

/// A test of what chance alone explains: its statistic and the probability of one as large.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Test {
    /// chi^2, or an F statistic.
    pub statistic: f64,
    /// Degrees of freedom of chi^2, or those that F sets against the scatter.
    pub degrees_of_freedom: usize,
    /// Probability of so large a statistic by chance; 1 without degrees of freedom.
    pub probability: f64,
}

impl Test {
    /// The test of a chi^2; its probability is 0 where it is not a finite number.
    pub fn chi_squared(statistic: f64, degrees_of_freedom: usize) -> Self {
        Self { statistic, degrees_of_freedom, probability: chi_squared_tail(statistic, degrees_of_freedom) }
    }

    /// Whether it stands out of `count` independent tests, when these do by chance with the probability `false_alarm` (Sidak).
    pub fn is_alarm(&self, false_alarm: f64, count: usize) -> bool {
        sidak(self.probability, count.max(1) as f64) < false_alarm
    }
}

/// Probability that chi^2 with `nu` degrees of freedom exceeds `chi_squared`; 1 without any degree, 0 if it is not a
/// finite number.
pub fn chi_squared_tail(chi_squared: f64, nu: usize) -> f64 {
    // Below the normal numbers the series that gives the tail takes half of it for nothing and fails.
    if nu == 0 || chi_squared < f64::MIN_POSITIVE {
        1.0
    } else if chi_squared.is_finite() {
        gamma_ur(0.5 * nu as f64, 0.5 * chi_squared)
    } else {
        0.0
    }
}

/// The quantiles of chi^2 with `nu` degrees of freedom between which it lies with probability `confidence`, as much on either side.
/// `None` without degrees of freedom, or where `confidence` is not in (0, 1).
pub fn chi_squared_quantiles(nu: f64, confidence: f64) -> Option<[f64; 2]> {
    let law = ChiSquared::new(nu).ok().filter(|_| confidence > 0.0 && confidence < 1.0)?;
    let tail = 0.5 * (1.0 - confidence);
    Some([tail, 1.0 - tail].map(|probability| law.inverse_cdf(probability)))
}

/// Probability of an F statistic of at least `f` with `m` and `n` degrees of freedom; 1 without degrees of freedom.
pub fn f_tail(f: f64, m: f64, n: f64) -> f64 {
    if m <= 0.0 || n <= 0.0 || f.is_nan() || f <= 0.0 {
        return 1.0;
    }
    if f.is_infinite() { 0.0 } else { beta_reg(0.5 * n, 0.5 * m, n / (n + m * f)) }
}

/// Probability of a t with `nu` degrees of freedom at least as far from zero; 1 without degrees of freedom.
pub fn t_tail(t: f64, nu: f64) -> f64 {
    /// Degrees beyond which the law is normal to five digits, and the continued fraction of the beta function loses all of its own.
    const MANY: f64 = 1e8;
    if nu > MANY { chi_squared_tail(t * t, 1) } else { f_tail(t * t, 1.0, nu) }
}

/// Holm's step-down family-wise probabilities of tests whose `probabilities` rise.
pub(crate) fn holm(probabilities: impl ExactSizeIterator<Item = f64>) -> Vec<f64> {
    let count = probabilities.len();
    let mut highest: f64 = 0.0;
    let family_wise = probabilities.enumerate().map(|(n, probability)| {
        highest = highest.max((count - n) as f64 * probability).min(1.0);
        highest
    });
    family_wise.collect()
}

/// The family-wise probabilities of tests in any order (S. Holm, Scandinavian Journal of Statistics 6, 1979), whatever their
/// dependence: what is below a level is wrongly so for any test of a true hypothesis with at most that probability.
pub fn family_wise(probabilities: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..probabilities.len()).collect();
    order.sort_by(|&a, &b| probabilities[a].total_cmp(&probabilities[b]));
    let mut family_wise = vec![1.0; probabilities.len()];
    for (&test, probability) in order.iter().zip(holm(order.iter().map(|&test| probabilities[test]))) {
        family_wise[test] = probability;
    }
    family_wise
}

/// The family-wise probability of one of `count` independent tests (Z. Sidak, Journal of the American Statistical Association 62, 1967).
pub(crate) fn sidak(probability: f64, count: f64) -> f64 {
    // Without the cancellation of 1 - (1 - p)^n.
    -(count * (-probability).ln_1p()).exp_m1()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `2 * scipy.stats.t.sf(t, nu)` of SciPy 1.17, for few and very many degrees of freedom: `1 - t^2 / nu` has lost the digits of `t`
    /// that the tolerance allows for, and the normal law takes over.
    #[test]
    fn t_as_scipy_has_it() {
        for (t, nu, expected) in T {
            let found = t_tail(t, nu);
            assert!(
                (found / expected - 1.0).abs() < 1e-11 + 1e-15 * nu.min(1e8),
                "{t} {nu}: {found:e}, expected {expected:e}"
            );
        }
    }

    const T: [(f64, f64, f64); 24] = [
        (0.3, 2.5, 7.873_423_714_951_973e-1),
        (2.0, 2.5, 1.573_914_957_579_659e-1),
        (6.0, 2.5, 1.528_172_988_552_29e-2),
        (0.3, 30.0, 7.662_461_052_843_528e-1),
        (2.0, 30.0, 5.462_504_496_298_309e-2),
        (6.0, 30.0, 1.394_276_876_720_476e-6),
        (0.3, 101.0, 7.647_937_230_745_11e-1),
        (2.0, 101.0, 4.818_521_120_739_07e-2),
        (6.0, 101.0, 3.101_884_361_321_023e-8),
        (0.3, 1e4, 7.641_833_912_293_323e-1),
        (2.0, 1e4, 4.552_726_066_143_543e-2),
        (6.0, 1e4, 2.041_618_472_922_621e-9),
        (0.3, 1e6, 7.641_772_179_789_942e-1),
        (2.0, 1e6, 4.550_053_385_131_924e-2),
        (6.0, 1e6, 1.973_849_812_354_43e-9),
        (0.3, 1e8, 7.641_771_562_456_637e-1),
        (2.0, 1e8, 4.550_026_659_590_669e-2),
        (6.0, 1e8, 1.973_182_034_315_279e-9),
        (0.3, 1e10, 7.641_771_556_283_306e-1),
        (2.0, 1e10, 4.550_026_392_335_392e-2),
        (6.0, 1e10, 1.973_175_357_517_696e-9),
        (0.3, 1e15, 7.641_771_556_220_948e-1),
        (2.0, 1e15, 4.550_026_389_635_871e-2),
        (6.0, 1e15, 1.973_175_290_076_059e-9),
    ];
}
