//! The stochastic noise terms Q, N, B, K: their spectra and their Hadamard variances.

use std::f64::consts::PI;

/// Stochastic terms: Q, N, B, K.
pub(super) const STOCHASTIC: usize = 4;

/// Hadamard variance at averaging factor `m` of the sampled noises Q, N, B, K = 1 with tau0 = 1:
/// `10 / (3 m^2), 1 / m, ln(256/27) / (2 pi) as m grows, (1 + 1/m^2) m / 6`.
pub(super) fn hadamard_shares(m: usize) -> [f64; STOCHASTIC] {
    let tau = m as f64;
    [10.0 / (3.0 * tau * tau), 1.0 / tau, flicker_share(m), (tau + 1.0 / tau) / 6.0]
}

/// Integral over the band of `|H_m|^2 / (2 sin pi f)`: the trapezium rule where sampling matters, else the limit.
fn flicker_share(m: usize) -> f64 {
    const SAMPLED: usize = 64;
    const NODES: usize = 64 * SAMPLED;
    if m > SAMPLED {
        return (256.0_f64 / 27.0).ln() / (2.0 * PI);
    }
    let half_band = (1..NODES).map(|k| {
        let f = 0.5 * k as f64 / NODES as f64;
        hadamard_response(m, f) / (2.0 * (PI * f).sin())
    });
    half_band.sum::<f64>() / NODES as f64
}

/// Two-sided spectral density at `f` cycles per sample of the sampled noises Q, N, B, K with squared coefficients
/// `theta` and tau0 = 1: the table's `2 pi f` becomes `2 sin(pi f)`.
pub(super) fn density(theta: &[f64; STOCHASTIC], f: f64) -> f64 {
    let omega = 2.0 * (PI * f).sin();
    theta[0] * omega * omega + theta[1] + theta[2] / omega + theta[3] / (omega * omega)
}

/// `|H_m(f)|^2 = (2 sin pi f m)^6 / (6 (2 m sin pi f)^2)`: the response of the Hadamard variance to `f` cycles per sample.
pub(super) fn hadamard_response(m: usize, f: f64) -> f64 {
    let m = m as f64;
    (2.0 * (PI * f * m).sin()).powi(6) / (6.0 * (2.0 * m * (PI * f).sin()).powi(2))
}
