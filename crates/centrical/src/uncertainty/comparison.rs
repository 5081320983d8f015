//! Two calibrations of one unit: differences over their uncertainties, drift, and a test of all of them together.
//!
//! The covariances are those of errors that the other calibration does not share: the same gravity or the same radii cancel in the
//! difference.

use nalgebra::{DMatrix, DVector};

use super::verdict::Level;
use crate::statistics::chi_squared_tail;

/// The estimates of one calibration.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimates {
    /// Values, SI.
    pub values: DVector<f64>,
    /// Covariance of the errors that belong to this calibration alone, SI.
    pub covariance: DMatrix<f64>,
}

/// Calibration B less calibration A.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// By parameter.
    pub differences: Vec<ParameterDifference>,
    /// `d^T (C_A + C_B)^-1 d` of all of them; `None` if the sum is not positive definite.
    pub chi_squared: Option<f64>,
    /// Probability of so large a `chi_squared` if nothing has changed.
    pub probability: Option<f64>,
}

/// One parameter in both.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterDifference {
    /// Name.
    pub name: String,
    /// B less A [its unit].
    pub difference: f64,
    /// Standard uncertainty of the difference [its unit].
    pub standard_uncertainty: f64,
    /// `E_n = d / sqrt(U_A^2 + U_B^2)` with expanded uncertainties, `k = 2` (ISO/IEC 17043): beyond 1 in size the two
    /// disagree. Of parameters that have not changed one in twenty is beyond 1.
    pub e_n: f64,
    /// Probability that any of the compared parameters differs by as many of its uncertainties if nothing has changed
    /// (Bonferroni).
    pub probability: f64,
}

impl ParameterDifference {
    /// Whether this parameter alone shows that the two calibrations disagree.
    pub fn is_real(&self) -> bool {
        self.probability < 0.5 * Level::Disagreement.probability()
    }
}

/// Coverage factor of the expanded uncertainties in `E_n` (ISO 13528, 9.7).
const COVERAGE_FACTOR: f64 = 2.0;

impl Comparison {
    /// Of estimates of the parameters `names`: the second less the first.
    pub fn of(names: &[String], [first, second]: [&Estimates; 2]) -> Self {
        let covariance = &first.covariance + &second.covariance;
        let parameter = |(n, name): (usize, &String)| {
            let (difference, standard_uncertainty) = (second.values[n] - first.values[n], covariance[(n, n)].sqrt());
            let e_n = difference / (COVERAGE_FACTOR * standard_uncertainty);
            let square = (difference / standard_uncertainty).powi(2);
            let alone = if difference == 0.0 { 1.0 } else { chi_squared_tail(square, 1) };
            let probability = (names.len() as f64 * alone).min(1.0);
            ParameterDifference { name: name.clone(), difference, standard_uncertainty, e_n, probability }
        };
        let differences: Vec<ParameterDifference> = names.iter().enumerate().map(parameter).collect();
        let chi_squared = weighted_square(differences.iter().map(|d| d.difference), &covariance);
        let probability = chi_squared.map(|chi_squared| chi_squared_tail(chi_squared, names.len()));
        Self { differences, chi_squared, probability }
    }

    /// Whether the two agree: neither the joint test nor the test of any parameter rejects it. Each of the two has half of the
    /// level, so that at most 1 % of unchanged pairs are said to disagree. Without a common parameter they do not agree.
    pub fn agrees(&self) -> bool {
        let agree_jointly =
            self.probability.is_some_and(|probability| probability > 0.5 * Level::Disagreement.probability());
        !self.differences.is_empty() && agree_jointly && !self.differences.iter().any(ParameterDifference::is_real)
    }
}

/// `e^T C^-1 e`, by the Cholesky factor of the correlation matrix; `None` if `C` is not a covariance.
pub(super) fn weighted_square(errors: impl Iterator<Item = f64>, covariance: &DMatrix<f64>) -> Option<f64> {
    let u = covariance.diagonal().map(f64::sqrt);
    let correlation = DMatrix::from_fn(u.len(), u.len(), |i, j| covariance[(i, j)] / (u[i] * u[j]));
    let scaled = DVector::from_iterator(u.len(), errors.zip(u.iter()).map(|(e, u)| e / u));
    Some(correlation.cholesky()?.l_dirty().solve_lower_triangular(&scaled)?.norm_squared())
}
