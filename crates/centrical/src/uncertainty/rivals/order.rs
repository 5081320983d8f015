//! The order of rivals whose figures differ by rounding alone.

/// A figure to 32 binary digits. Of mirrored mountings two rivals explain and move the same but for rounding, which differs between
/// processors; their order is then that of the catalogue.
pub(super) fn to_rounding(figure: f64) -> f64 {
    const LAST: u64 = 1 << 20;
    f64::from_bits((figure.to_bits() + LAST / 2) & !(LAST - 1))
}
