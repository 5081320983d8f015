//! Mean and covariance of the logarithms of a record's Hadamard variances, given the spectrum of its noise.

use nalgebra::{DMatrix, DVector};
use statrs::function::gamma::digamma;

use super::stochastic_terms::{STOCHASTIC, density, hadamard_response};

/// The moments of the logarithms of overlapping Hadamard variances, as a function of the spectrum.
///
/// A variance is the mean over M terms of a squared Gaussian process of spectrum `S(f) |H_m(f)|^2`, so that
/// `cov(s_i^2, s_j^2) = 2/M int S^2 |H_i|^2 |H_j|^2 df` and `edf = 2 s^4 / var` (D. B. Percival, "On estimation of the
/// wavelet variance", Biometrika 82, 1995). Near the record's length the terms at its ends count less: the edf is
/// divided by `1 - 0.6 m / M`, 0.6 being a_1 / a_0 in table 2 of Greenhall and Riley (0.64, 0.62, 0.59 for white,
/// flicker, random walk). A chi^2 of that edf has the logarithm's mean and variance
/// `psi(edf/2) - ln(edf/2)` and `psi'(edf/2)`.
pub(super) struct MomentModel {
    /// Frequencies in cycles per sample, evenly spaced in logarithm.
    frequency: Vec<f64>,
    /// `|H_m|^2` times the frequency (the measure of the logarithm), one row per averaging factor.
    response: DMatrix<f64>,
    factors: Vec<usize>,
    terms: Vec<usize>,
}

/// Moments of the logarithms at one model spectrum.
pub(super) struct LogMoments {
    /// Expected logarithm of estimate over truth.
    pub(super) mean: DVector<f64>,
    /// Covariance of the logarithms.
    pub(super) covariance: DMatrix<f64>,
}

impl MomentModel {
    /// For the averaging factors `factors`, ascending, whose variances are means over `terms` terms.
    pub(super) fn new(factors: Vec<usize>, terms: Vec<usize>) -> Self {
        const PER_OCTAVE: f64 = 96.0;
        let lowest = 1e-3 / factors.last().copied().unwrap_or(1) as f64;
        let mut frequency = Vec::new();
        while let f = lowest * (frequency.len() as f64 / PER_OCTAVE).exp2()
            && f < 0.5
        {
            frequency.push(f);
        }
        let response = DMatrix::from_fn(factors.len(), frequency.len(), |i, k| {
            frequency[k] * hadamard_response(factors[i], frequency[k])
        });
        Self { frequency, response, factors, terms }
    }

    /// Moments where the spectrum is the sum of the terms with squared coefficients `theta`.
    pub(super) fn moments(&self, theta: &[f64; STOCHASTIC]) -> LogMoments {
        let spectrum: Vec<f64> = self.frequency.iter().map(|&f| density(theta, f)).collect();
        let mut filtered = self.response.clone();
        for (mut column, s) in filtered.column_iter_mut().zip(&spectrum) {
            column *= *s;
        }
        // In d(ln f): the response carries one factor f, so the product of two is divided by one.
        let mean = filtered.column_sum();
        let mut weighted = filtered.clone();
        for (mut column, f) in weighted.column_iter_mut().zip(&self.frequency) {
            column /= *f;
        }
        let step = (self.frequency[1] / self.frequency[0]).ln();
        let product = &weighted * filtered.transpose() / step;
        let count = self.factors.len();
        let edf = |i: usize| {
            let terms = self.terms[i] as f64;
            let edge = 1.0 - 0.6 * (self.factors[i] as f64 / terms).min(1.0);
            2.0 * terms * mean[i] * mean[i] / product[(i, i)] / edge
        };
        let edf: Vec<f64> = (0..count).map(edf).collect();
        let deviation: Vec<f64> = edf.iter().map(|edf| trigamma(edf / 2.0).sqrt()).collect();
        LogMoments {
            mean: DVector::from_fn(count, |i, _| digamma(edf[i] / 2.0) - (edf[i] / 2.0).ln()),
            covariance: DMatrix::from_fn(count, count, |i, j| {
                let correlation = product[(i, j)] / (product[(i, i)] * product[(j, j)]).sqrt();
                correlation * deviation[i] * deviation[j]
            }),
        }
    }
}

/// Derivative of digamma: upward recurrence, then the asymptotic series (Abramowitz and Stegun 6.4.6, 6.4.12).
fn trigamma(x: f64) -> f64 {
    let (mut x, mut sum) = (x, 0.0);
    while x < 10.0 {
        sum += 1.0 / (x * x);
        x += 1.0;
    }
    let square = 1.0 / (x * x);
    sum + 1.0 / x + square / 2.0 + square / x * (1.0 / 6.0 - square * (1.0 / 30.0 - square / 42.0))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::super::stochastic_terms::hadamard_shares;
    use super::*;

    /// The spectra and the shares of the variance are two statements of the same noises.
    #[test]
    fn the_integral_of_each_spectrum_is_its_hadamard_variance() {
        let model = MomentModel::new(vec![16, 64], vec![1, 1]);
        let step = (model.frequency[1] / model.frequency[0]).ln();
        for k in 0..STOCHASTIC {
            let mut theta = [0.0; STOCHASTIC];
            theta[k] = 1.0;
            for (i, m) in [16, 64].into_iter().enumerate() {
                let two_sided = 2.0 * step;
                let sum: f64 =
                    model.frequency.iter().enumerate().map(|(n, &f)| model.response[(i, n)] * density(&theta, f)).sum();
                let expected = hadamard_shares(m)[k];
                // The band's upper end falls between two frequencies: half a step of 1 %.
                assert!(
                    (two_sided * sum / expected - 1.0).abs() < 0.01,
                    "term {k}, m = {m}: {} for {expected}",
                    two_sided * sum
                );
            }
        }
    }

    #[test]
    fn trigamma_is_known_at_one_and_one_half() {
        // The series' next term at 10 is 1 / (30 x^9) = 3e-11.
        assert!((trigamma(1.0) - PI * PI / 6.0).abs() < 5e-11);
        assert!((trigamma(0.5) - PI * PI / 2.0).abs() < 5e-11);
    }
}
