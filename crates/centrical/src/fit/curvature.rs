//! What the curvature of the model leaves in the estimates along directions that are determined poorly: by priors alone, or by
//! gravity alone in attitudes that hardly differ from six faces.
//!
//! Along such a direction an estimate may be off by far more than elsewhere, and the readings answer with a square. With the
//! covariance as a sum of independent directions, `C = sum_k d_k d_k^T`, the error of the estimate is `sum_k z_k d_k` of
//! independent `z_k` of unit variance, and the model linearised there misses
//!
//! `sum_k e_k z_k^2 + sum_(k<l) e_kl z_k z_l`,  `e_k = (f(x + d_k) + f(x - d_k)) / 2 - f(x)`,
//!
//! `e_kl = (f(x + d_k + d_l) - f(x + d_k - d_l) - f(x - d_k + d_l) + f(x - d_k - d_l)) / 4`.
//!
//! The gain takes this to the estimates. Its mean `sum_k e_k` and its covariance `2 sum_k e_k e_k^T + sum_(k<l) e_kl e_kl^T` add
//! to the covariance of the estimates, whatever the directions by which it is written as a sum. Without them the joint
//! covariance is far too narrow across the direction (test `joint_covariance_with_one_radius`).

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::data::Data;
use super::departure::{missed, whitened};
use super::structure::{Assembly, Hold, Structure};
use crate::linalg::least_squares::LeastSquares;
use crate::model::{FitError, Linearisation};

/// Directions along which the estimate is uncertain by more than this part of the typical magnitudes are wide: those that the data
/// hardly determine as well as those that they do not.
const WIDE: f64 = 1e-2;

/// Most directions that are taken: products of two grow with the square of their number.
const MOST: usize = 12;

/// The columns whose squares add to the covariance at the unknowns `x` of a fit of `data`, whose directions are held by
/// `hold`; none where the arm shows all directions without priors.
pub(super) fn left_by(
    data: &Data,
    structure: &Structure,
    hold: Hold,
    x: &DVector<f64>,
    linearisations: &[Linearisation],
) -> Result<DMatrix<f64>, FitError> {
    let of_priors = structure.lost_by_data();
    if of_priors == 0 && !data.model().experiment().has_free_attitudes() {
        return Ok(DMatrix::zeros(x.len(), 0));
    }
    // The rows of the plateaus themselves, not those that a filter turned them into.
    let design = Assembly::Batch.design(data, x.as_slice(), linearisations)?;
    let (equations, _) = structure.held.equations(&design, x, hold);
    let directions = if of_priors > 0 {
        widest(&equations, &data.typical(), of_priors)
    } else {
        let wide = equations.wider_than(WIDE).into_iter().take(MOST);
        wide.map(|direction| direction.component_mul(&data.typical())).collect()
    };
    if directions.is_empty() {
        return Ok(DMatrix::zeros(x.len(), 0));
    }
    let missed = whitened(data, linearisations, &missed(data, x, &directions))?;
    Ok(equations.unknowns(&equations.rotated(missed)))
}

/// The widest independent directions of the covariance, `least` of them or more, unknowns counted in their typical magnitudes.
fn widest(equations: &LeastSquares, typical: &DVector<f64>, least: usize) -> Vec<DVector<f64>> {
    let inverse = equations.inverse();
    let eigen = SymmetricEigen::new(&inverse * inverse.transpose());
    let mut order: Vec<usize> = (0..eigen.eigenvalues.len()).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    let direction =
        |k: usize| eigen.eigenvectors.column(k).component_mul(typical) * eigen.eigenvalues[k].max(0.0).sqrt();
    let wide = order.iter().filter(|k| eigen.eigenvalues[**k] > WIDE * WIDE).count();
    order.into_iter().take(wide.max(least).min(MOST)).map(direction).collect()
}
