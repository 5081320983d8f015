//! Laws of what chance makes.

use statrs::function::beta::beta_reg;
use statrs::function::gamma::gamma_ur;

/// Probability that chi^2 with `nu` degrees of freedom exceeds `chi_squared`; 1 without any degree, 0 if it is not a
/// finite number.
pub fn chi_squared_tail(chi_squared: f64, nu: usize) -> f64 {
    // Below the normal numbers the series that gives the tail takes half of it for nothing and fails.
    if nu == 0 || chi_squared < f64::MIN_POSITIVE {
        1.0
    } else if chi_squared.is_finite() {
        gamma_ur(0.5 * nu as f64, 0.5 * chi_squared)
    } else {
        0.0
    }
}

/// Probability of an F statistic of at least `f` with `m` and `n` degrees of freedom; 1 without degrees of freedom.
pub fn f_tail(f: f64, m: usize, n: usize) -> f64 {
    if m == 0 || n == 0 || f.is_nan() || f <= 0.0 {
        return 1.0;
    }
    let (m, n) = (m as f64, n as f64);
    if f.is_infinite() { 0.0 } else { beta_reg(0.5 * n, 0.5 * m, n / (n + m * f)) }
}
