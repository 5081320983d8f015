//! Robust statistics: the median, the spread it gives, and the limit beyond which a value is a spike.

/// Normal law: standard deviation over median absolute value.
pub(crate) const MAD: f64 = 1.482_602_218_505_602;

/// Median; of an even number the upper of the middle two. Zero of an empty slice.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The limit for `n` good samples, in standard deviations: fewer than one in twenty such sets has a sample beyond it, since
/// the normal law leaves less than `exp(-c^2 / 2)` beyond `c`.
pub(crate) fn cut(n: usize) -> f64 {
    (2.0 * (20.0 * n as f64).ln()).sqrt()
}

/// The whole part of a number of blocks, cells or revolutions; zero of a negative number.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
pub(crate) fn whole(number: f64) -> usize {
    number.max(0.0) as usize
}
