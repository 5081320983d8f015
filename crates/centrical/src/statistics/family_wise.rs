//! Many tests at once.

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
