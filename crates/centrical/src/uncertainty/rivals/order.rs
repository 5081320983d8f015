//! The order of rivals whose figures differ by rounding alone.

use std::cmp::Ordering;

/// The order of two figures by 32 binary digits. Of mirrored mountings two rivals explain and move the same but for rounding, which
/// differs between processors.
pub(super) fn beyond_rounding(a: f64, b: f64) -> Ordering {
    const LAST: u64 = 1 << 20;
    let digits = |figure: f64| f64::from_bits((figure.to_bits() + LAST / 2) & !(LAST - 1));
    digits(a).total_cmp(&digits(b))
}
