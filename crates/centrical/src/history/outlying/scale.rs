//! Centre and deviations of values with errors of different sizes, hardly moved by a few that are far off.
//!
//! `x_i ~ N(m, D_i^2)` with `D_i^2 = sigma^2 + s_i^2`: `m` is the median with weights `1 / D_i`, and `sigma` makes the median of
//! `|x_i - m| / D_i` that of a normal law. Where the errors alone explain more than the scatter, `sigma = 0` and `D_i = c s_i` with `c < 1`.

use crate::statistics::{MAD, median};

/// Values counted from their centre.
#[derive(Debug, Clone)]
pub struct Counted {
    /// `(x_i - m) / D_i`.
    pub scores: Vec<f64>,
    /// `D_i`.
    pub deviations: Vec<f64>,
    /// `sigma^2`.
    pub common: f64,
    /// `c^2`, 1 where `sigma` is not zero.
    pub factor: f64,
}

impl Counted {
    /// `values` with the `variances` of their errors; `None` where they do not vary.
    pub fn of(values: &[f64], variances: &[f64]) -> Option<Self> {
        let (mut deviations, mut common, mut factor) = (vec![1.0; values.len()], 0.0, 1.0);
        let mut scores = Vec::new();
        for _ in 0..ROUNDS {
            let centre = weighted_median(values, &deviations);
            scores = values.iter().map(|value| value - centre).collect();
            (common, factor) = components(&scores, variances)?;
            deviations = variances.iter().map(|v| (factor * (common + v)).sqrt()).collect();
        }
        scores.iter_mut().zip(&deviations).for_each(|(score, deviation)| *score /= deviation);
        Some(Self { scores, deviations, common, factor })
    }
}

/// `sigma^2` and `c^2` by distances from the centre.
fn components(distances: &[f64], variances: &[f64]) -> Option<(f64, f64)> {
    let ratio = |common: f64| {
        let squares = distances.iter().zip(variances).map(|(distance, v)| distance * distance / (common + v));
        MAD * MAD * median(&mut squares.collect::<Vec<f64>>())
    };
    let whole = MAD * MAD * median(&mut distances.iter().map(|distance| distance * distance).collect::<Vec<f64>>());
    if !(whole > 0.0 && whole.is_finite()) {
        return None;
    }
    if let Some(error) = variances.first().filter(|first| variances.iter().all(|v| v == *first)) {
        return Some(if whole > *error { (whole - error, 1.0) } else { (0.0, whole / error) });
    }
    if variances.iter().all(|v| *v > 0.0) && ratio(0.0) <= 1.0 {
        return Some((0.0, ratio(0.0)));
    }
    // The ratio falls, and is below 1 at the scatter as a whole.
    Some((crossing(|common| ratio(common).ln(), whole), 1.0))
}

/// Where `f`, which falls from above zero at 0, is no more above zero, up to `high`: regula falsi with halved values at an end that stays
/// (Illinois).
fn crossing(f: impl Fn(f64) -> f64, high: f64) -> f64 {
    let (mut low, mut high) = ((0.0, f(0.0).min(MOST)), (high, f(high)));
    for _ in 0..STEPS {
        if high.0 - low.0 <= TOLERANCE * high.0 || high.1 >= 0.0 {
            break;
        }
        let middle = high.0 - high.1 * (high.0 - low.0) / (high.1 - low.1);
        let at_middle = f(middle);
        if at_middle > 0.0 {
            low = (middle, at_middle);
            high.1 *= 0.5;
        } else {
            high = (middle, at_middle);
            low.1 *= 0.5;
        }
    }
    high.0
}

/// The first value up to which more than half of the weight `1 / D_i` lies.
fn weighted_median(values: &[f64], deviations: &[f64]) -> f64 {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let half = 0.5 * deviations.iter().map(|deviation| 1.0 / deviation).sum::<f64>();
    let mut sum = 0.0;
    let is_beyond = |i: &&usize| {
        sum += 1.0 / deviations[**i];
        sum > half
    };
    order.iter().find(is_beyond).map_or(f64::NAN, |&i| values[i])
}

/// Centre and deviations in turn: they hardly change after that.
const ROUNDS: usize = 2;

/// Steps of a search, which ends earlier as a rule.
const STEPS: usize = 30;

/// A median of some hundred values is not known to more.
const TOLERANCE: f64 = 1e-3;

/// Stands for a ratio that is not bounded.
const MOST: f64 = 1e3;
