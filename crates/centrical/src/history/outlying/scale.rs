//! Centre and deviations of values with errors of different sizes, hardly moved by a few that are far off.
//!
//! `x_i ~ N(m, D_i^2)` with `D_i^2 = sigma^2 + s_i^2`: `m` is the median with weights `1 / D_i`, and `sigma` makes the median of
//! `|x_i - m| / D_i` that of a normal law, `1 / q`. Half of the values are within that if and only if half of `q^2 (x_i - m)^2 - s_i^2` are
//! within `sigma^2`, which is thus their median. Where it is negative, errors alone explain more than the scatter: `sigma = 0` and
//! `D_i = c s_i` with `c < 1`.

use crate::statistics::{MAD, median};

/// Values counted from their centre.
#[derive(Debug, Clone)]
pub struct Counted {
    /// `m`.
    pub centre: f64,
    /// `(x_i - m) / D_i`.
    pub scores: Vec<f64>,
    /// `D_i`.
    pub deviations: Vec<f64>,
}

impl Counted {
    /// `values` with the `variances` of their errors; `None` where they do not vary.
    pub fn of(values: &[f64], variances: &[f64]) -> Option<Self> {
        let mut deviations = vec![1.0; values.len()];
        let (mut centre, mut scores) = (0.0, Vec::new());
        for _ in 0..ROUNDS {
            centre = weighted_median(values, &deviations);
            scores = values.iter().map(|value| value - centre).collect();
            let (common, factor) = components(&scores, variances)?;
            deviations = variances.iter().map(|v| (factor * (common + v)).sqrt()).collect();
        }
        scores.iter_mut().zip(&deviations).for_each(|(score, deviation)| *score /= deviation);
        Some(Self { centre, scores, deviations })
    }
}

/// `sigma^2` and `c^2` by distances from the centre.
fn components(distances: &[f64], variances: &[f64]) -> Option<(f64, f64)> {
    let squares = || distances.iter().map(|distance| (MAD * distance).powi(2)).zip(variances);
    let common = median(&mut squares().map(|(square, variance)| square - variance).collect::<Vec<f64>>());
    if common > 0.0 {
        return common.is_finite().then_some((common, 1.0));
    }
    let factor = median(&mut squares().map(|(square, variance)| square / variance).collect::<Vec<f64>>());
    (factor > 0.0).then_some((0.0, factor))
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
