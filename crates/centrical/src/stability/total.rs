//! The total estimators: the record, or each window of it, is reflected at its ends before differencing.

use super::phase::Phase;
use super::variance::{RawVariance, mean_square};
use crate::progress::Watch;

/// `1 / (2 tau^2 (N - 2)) sum_(i=2)^(N-1) (x*_(i-m) - 2 x*_i + x*_(i+m))^2`, x* being x continued at both ends by
/// odd reflection, `x*_(1-j) = 2 x_1 - x_(1+j)` [SP 1065, eq. 25].
pub(super) fn total(phase: &Phase, m: usize, watch: &Watch) -> Option<RawVariance> {
    let x = phase.points();
    let last = x.len() - 1;
    if m >= last {
        return None;
    }
    let before = |i: usize| if i >= m { x[i - m] } else { 2.0 * x[0] - x[m - i] };
    let after = |i: usize| if i + m <= last { x[i + m] } else { 2.0 * x[last] - x[2 * last - i - m] };
    let (square, terms) = mean_square((1..last).map(|i| before(i) - 2.0 * x[i] + after(i)), watch)?;
    let tau = m as f64 * phase.tau0();
    Some(RawVariance { value: square / (2.0 * tau * tau), terms, possible: terms })
}

/// Modified Allan variance of every window of 3m phase points, untilted and reflected [SP 1065, eq. 27].
pub(super) fn modified_total(phase: &Phase, m: usize, watch: &Watch) -> Option<RawVariance> {
    let tau = m as f64 * phase.tau0();
    windows(phase.points(), m, 2.0 * tau * tau, watch)
}

/// Hadamard variance of every window of 3m readings, untilted and reflected [SP 1065, eq. 29].
pub(super) fn hadamard_total(phase: &Phase, m: usize, watch: &Watch) -> Option<RawVariance> {
    let y: Vec<f64> = phase.points().windows(2).map(|pair| (pair[1] - pair[0]) / phase.tau0()).collect();
    windows(&y, m, 6.0, watch)
}

/// Mean over the windows of 3m values of the mean square of their 6m second differences of m-means, by `norm`.
fn windows(values: &[f64], m: usize, norm: f64, watch: &Watch) -> Option<RawVariance> {
    let terms = (values.len() + 1).checked_sub(3 * m).filter(|&terms| terms > 0)?;
    let mut sums = vec![0.0; 9 * m + 1];
    let together = 1 + 4096 / m;
    let windows = values.windows(3 * m).enumerate();
    let windows = windows.take_while(|(k, _)| !k.is_multiple_of(together) || !watch.is_stopped());
    let squares: f64 = windows.map(|(_, window)| reflected_square(window, m, &mut sums)).sum();
    Some(RawVariance { value: squares / (terms as f64 * norm), terms, possible: terms })
}

/// Mean square of the 6m second differences of m-means in the window untilted and continued by even reflection to
/// 9m values; `sums` is room for their running sums.
fn reflected_square(window: &[f64], m: usize, sums: &mut [f64]) -> f64 {
    let slope = half_slope(window);
    let length = window.len();
    let level = window[0];
    for k in 0..3 * length {
        let mirrored = if (length..2 * length).contains(&k) { k - length } else { length - 1 - k % length };
        sums[k + 1] = sums[k] + (window[mirrored] - level - slope * mirrored as f64);
    }
    let mean = |k: usize| sums[k + m] - sums[k];
    let square: f64 = (0..6 * m).map(|k| (mean(k + 2 * m) - 2.0 * mean(k + m) + mean(k)).powi(2)).sum();
    square / (6 * m * m * m) as f64
}

/// Slope per value from the means of the two halves; the middle of an odd number counts in neither.
fn half_slope(window: &[f64]) -> f64 {
    let half = window.len() / 2;
    let apart = window.len() - half;
    let difference: f64 = (0..half).map(|k| window[k + apart] - window[k]).sum();
    difference / (half * apart) as f64
}
