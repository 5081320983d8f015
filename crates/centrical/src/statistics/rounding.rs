//! The bias that rounding leaves in a mean.

use std::f64::consts::PI;

/// Variance of the bias that rounding to the digit `d` leaves in a mean. The readings have the variance `v` and move by a
/// cosine of amplitude `a`; their level lies anywhere between two digits. The variance is
/// `sum_k d^2 / (2 pi^2 k^2) exp(-4 pi^2 k^2 v / d^2) J_0(2 pi k a / d)^2` (Widrow and Kollar, Quantization Noise, 2008). It
/// is `d^2 / 12` without noise and motion, and negligible once the noise is a digit.
pub fn bias_variance(digit: f64, variance: f64, amplitude: f64) -> f64 {
    // The hundredth term is 1e-4 of the first at most; what has faded so far is nothing beside any noise.
    const TERMS: i32 = 100;
    const FADED: f64 = 1e-30;
    let waves = 4.0 * PI * PI * variance / (digit * digit);
    let turns = 2.0 * PI * amplitude / digit;
    let fading = |k: &i32| (-waves * f64::from(k * k)).exp();
    let term = |k: i32| fading(&k) * bessel_squared(turns * f64::from(k)) / f64::from(k * k);
    digit * digit / (2.0 * PI * PI) * (1..=TERMS).take_while(|k| fading(k) > FADED).map(term).sum::<f64>()
}

/// `J_0(x)^2`: the mean of `cos(x cos phi)` over equal steps, exact to rounding while these are more than `x`; beyond, the mean of
/// its oscillation, `1 / (pi x)`.
fn bessel_squared(x: f64) -> f64 {
    const STEPS: u32 = 64;
    if x > 0.5 * f64::from(STEPS) {
        return 1.0 / (PI * x);
    }
    let step = |n: u32| (x * (PI * (f64::from(n) + 0.5) / f64::from(STEPS)).cos()).cos();
    ((0..STEPS).map(step).sum::<f64>() / f64::from(STEPS)).powi(2)
}

#[cfg(test)]
mod tests {
    use super::{bessel_squared, bias_variance};

    #[test]
    fn without_noise_rounding_is_uniform() {
        assert!((bias_variance(0.3, 0.0, 0.0) / (0.09 / 12.0) - 1.0).abs() < 0.01);
    }

    #[test]
    fn noise_of_a_digit_dithers() {
        assert!(bias_variance(1.0, 1.0, 0.0) < 1e-17);
    }

    /// Abramowitz and Stegun, table 9.1.
    #[test]
    fn bessel_function_as_tabulated() {
        for (x, j) in [(0.0, 1.0), (1.0, 0.765_197_686_6), (5.0, -0.177_596_771_3), (10.0, -0.245_935_764_5)] {
            assert!((bessel_squared(x) - j * j).abs() < 1e-10, "{x}");
        }
    }

    /// Means of rounded cosines over levels anywhere between two digits.
    #[test]
    fn motion_dithers() {
        for amplitude in [0.1, 0.3, 0.5, 1.3] {
            let levels = 200;
            let bias = |level: u32| {
                let level = f64::from(level) / f64::from(levels);
                let phases = 4000;
                let error = |n: u32| {
                    let f =
                        level + amplitude * (std::f64::consts::TAU * (f64::from(n) + 0.5) / f64::from(phases)).cos();
                    f.round() - f
                };
                (0..phases).map(error).sum::<f64>() / f64::from(phases)
            };
            let variance = (0..levels).map(|level| bias(level).powi(2)).sum::<f64>() / f64::from(levels);
            // Steps of 1/200 of a level, and of a phase where a reading flips, are seen at a hundredth.
            assert!((bias_variance(1.0, 0.0, amplitude) / variance - 1.0).abs() < 0.05, "{amplitude}: {variance}");
        }
    }
}
