//! What Monte Carlo runs show by chance alone.

use centrical::uncertainty::{MonteCarlo, WeightedSquare};

/// Two standard deviations of the part of the runs, in percent, whose intervals cover the truth, if each does with the probability
/// `coverage`.
pub(crate) fn chance_of_coverage(coverage: f64, of: &MonteCarlo) -> f64 {
    let percent = 100.0 * coverage;
    2.0 * (percent * (100.0 - percent) / runs(of)).sqrt()
}

/// Standard deviation of a quadratic form that has its chi^2 distribution.
pub(crate) fn expected_deviation(square: &WeightedSquare) -> f64 {
    (2.0 * square.degrees_of_freedom as f64).sqrt()
}

/// Distance from the distribution that as many runs pass by chance once in twenty (Kolmogorov).
pub(crate) fn chance_distance(of: &MonteCarlo) -> f64 {
    1.36 / runs(of).sqrt()
}

fn runs(of: &MonteCarlo) -> f64 {
    of.runs.max(1) as f64
}
