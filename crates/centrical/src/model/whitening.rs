//! From plateaus to rows of independent errors of unit variance, three per plateau.
//!
//! The covariance of a plateau is that of its mean, a rank-one term `d d^T` and its rounding. The term is that of the
//! speed, `d = sigma d f' / d ln Omega` of the full model (`docs/source-and-findings.md`), or at rest that of the angle.
//! Its Cholesky factor whitens the rows. Least squares on them is the generalised least squares of the plateaus.

use nalgebra::{Cholesky, Const, DMatrix, Matrix3, Vector3};

use super::error::FitError;
use super::measurement::Linearisation;
use super::observation::Weight;

/// The whitened rows of plateaus of given weights, `3 n x (p + q)`, for all `unknowns`: parameters, then influences.
///
/// # Errors
/// [`FitError::Covariance`] when a covariance is not positive definite.
pub(crate) fn whitened_rows(
    weights: &[Weight],
    linearisations: &[Linearisation],
    unknowns: usize,
) -> Result<DMatrix<f64>, FitError> {
    let mut rows = DMatrix::zeros(3 * weights.len(), unknowns);
    for (n, (weight, linearisation)) in weights.iter().zip(linearisations).enumerate() {
        Whitener::new(weight, linearisation)?.fill(&mut rows, n, linearisation);
    }
    Ok(rows)
}

/// Takes a plateau's errors to independent ones of unit variance.
#[derive(Debug, Clone)]
pub(crate) struct Whitener(Cholesky<f64, Const<3>>);

impl Whitener {
    /// From the covariance of the mean and the errors of the plateau alone.
    pub fn new(weight: &Weight, linearisation: &Linearisation) -> Result<Self, FitError> {
        let total = total_covariance(&weight.covariance, linearisation);
        Cholesky::new(total)
            .map(Self)
            .ok_or(FitError::Covariance { set_point: weight.set_point, diagonal: weight.covariance.diagonal().into() })
    }

    /// `L^-1 v`.
    pub fn apply(&self, v: &Vector3<f64>) -> Vector3<f64> {
        // A Cholesky factor has no zero on its diagonal, so the triangular system has a solution.
        self.0.l_dirty().solve_lower_triangular(v).unwrap_or_else(Vector3::zeros)
    }

    /// Writes the three rows of plateau `n`.
    pub fn fill(&self, rows: &mut DMatrix<f64>, n: usize, linearisation: &Linearisation) {
        let mut block = rows.fixed_rows_mut::<3>(3 * n);
        for (unknown, derivative) in linearisation.by_unknowns() {
            block.set_column(unknown, &self.apply(derivative));
        }
    }
}

/// `C + d d^T + r^2 E` [m^2/s^4]: the covariance of the mean with the errors of what was set and of the plateau's rounding.
pub(crate) fn total_covariance(mean: &Matrix3<f64>, at: &Linearisation) -> Matrix3<f64> {
    let set = noise_covariance(mean, at) + at.setting_error * at.setting_error.transpose();
    if at.rounding > 0.0 { set + Matrix3::from_diagonal_element(at.rounding * at.rounding) } else { set }
}

/// `C`, the covariance of the mean as the fit takes it [m^2/s^4].
///
/// Where only gravity shows the attitude, `C` is `(n^T C n) E`, with the normal `n`. The two unknowns of the attitude follow the mean across
/// `n`, whatever its variance there. A hand trembles across: taken for an error, that would let the fit turn the attitude by as much, to where
/// the sphere of readings bends towards the mean.
pub(crate) fn noise_covariance(mean: &Matrix3<f64>, at: &Linearisation) -> Matrix3<f64> {
    at.normal.map_or(*mean, |n| Matrix3::from_diagonal_element(n.dot(&(mean * n))))
}

/// `L` of that covariance, `C = L L^T` [m/s^2].
pub(crate) fn noise_factor(weight: &Weight, at: &Linearisation) -> Result<Matrix3<f64>, FitError> {
    let Weight { set_point, covariance } = weight;
    let factor = noise_covariance(covariance, at).cholesky().map(|factor| factor.l());
    factor.ok_or(FitError::Covariance { set_point: *set_point, diagonal: covariance.diagonal().into() })
}
