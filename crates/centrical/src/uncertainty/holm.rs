//! Many tests at once.

/// Holm's step-down family-wise probabilities of tests whose `probabilities` rise.
pub(super) fn holm(probabilities: impl ExactSizeIterator<Item = f64>) -> Vec<f64> {
    let count = probabilities.len();
    let mut highest: f64 = 0.0;
    let family_wise = probabilities.enumerate().map(|(n, probability)| {
        highest = highest.max((count - n) as f64 * probability).min(1.0);
        highest
    });
    family_wise.collect()
}
