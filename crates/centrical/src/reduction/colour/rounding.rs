//! The bias that rounding leaves in a mean.

use std::f64::consts::PI;

/// Variance of the bias that rounding to the digit `d` leaves in the mean of readings of variance `v`, the level
/// being anywhere between two digits: `sum_k d^2 / (2 pi^2 k^2) exp(-4 pi^2 k^2 v / d^2)` (Widrow and Kollar,
/// Quantization Noise, 2008): `d^2 / 12` without noise, and negligible once the noise is a digit.
pub(super) fn bias_variance(digit: f64, variance: f64) -> f64 {
    // The hundredth term is 1e-4 of the first at most.
    const TERMS: i32 = 100;
    let waves = 4.0 * PI * PI * variance / (digit * digit);
    let term = |k: i32| (-waves * f64::from(k * k)).exp() / f64::from(k * k);
    digit * digit / (2.0 * PI * PI) * (1..=TERMS).map(term).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::bias_variance;

    #[test]
    fn without_noise_rounding_is_uniform() {
        assert!((bias_variance(0.3, 0.0) / (0.09 / 12.0) - 1.0).abs() < 0.01);
    }

    #[test]
    fn noise_of_a_digit_dithers() {
        assert!(bias_variance(1.0, 1.0) < 1e-17);
    }
}
