//! A variance as the estimators compute it: the mean of the squares of its terms.

use crate::progress::Watch;

/// A variance as computed, before any correction of its bias.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RawVariance {
    /// Value, in the square of the readings' unit (for the time deviations: of the phase's).
    pub value: f64,
    /// Terms in the mean.
    pub terms: usize,
    /// Number of terms without gaps.
    pub possible: usize,
}

/// Mean of the squares and their number; `None` without values. Summed by blocks, so that rounding grows with the number
/// of blocks only. It ends early when it is stopped.
pub(super) fn mean_square(values: impl Iterator<Item = f64>, watch: &Watch) -> Option<(f64, usize)> {
    const BLOCK: usize = 4096;
    let (mut total, mut block, mut terms) = (0.0, 0.0, 0);
    for value in values {
        block += value * value;
        terms += 1;
        if terms % BLOCK == 0 {
            total += block;
            block = 0.0;
            if watch.is_stopped() {
                break;
            }
        }
    }
    (terms > 0).then(|| ((total + block) / terms as f64, terms))
}
