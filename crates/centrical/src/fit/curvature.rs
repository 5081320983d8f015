//! The curvature of the model: how far it is linear, and what is left of it in estimates along directions that priors alone determine.
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

use std::cmp::Ordering;

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::assembly::Assembly;
use super::data::Data;
use super::structure::{Hold, Structure};
use crate::linalg::least_squares::LeastSquares;
use crate::model::whitening::Whitener;
use crate::model::{FitError, Linearisation};

/// Directions along which the estimate is uncertain by more than this part of the typical magnitudes are wide: those that the data
/// hardly determine as well as those that they do not.
const WIDE: f64 = 1e-2;

/// A model that misses readings by less than this part of a standard uncertainty, all together, is linear.
const LINEAR: f64 = 0.1;

/// Most directions that are taken: products of two grow with the square of their number.
const MOST: usize = 12;

/// The columns whose squares add to the covariance at the unknowns `x` of a fit of `data`, whose directions are held by
/// `hold`; none where priors determine nothing by themselves.
pub(super) fn left_by(
    data: &Data,
    structure: &Structure,
    hold: Hold,
    x: &DVector<f64>,
    linearisations: &[Linearisation],
) -> Result<DMatrix<f64>, FitError> {
    let of_priors = structure.lost_by_data();
    if of_priors == 0 {
        return Ok(DMatrix::zeros(x.len(), 0));
    }
    // The rows of the plateaus themselves, not those that a filter turned them into.
    let design = Assembly::Batch.design(data, x.as_slice(), linearisations)?;
    let (equations, _) = structure.held.equations(&design, x, hold);
    let directions = widest(&equations, &data.typical(), of_priors);
    let missed = whitened(data, linearisations, &missed(data, x, &directions))?;
    Ok(equations.unknowns(&equations.rotated(missed)))
}

/// Whether the model at `X = 0`, which has these linearisations, misses readings over the length of that direction.
pub(super) fn departs(data: &Data, linearisations: &[Linearisation], x: &DVector<f64>) -> Result<bool, FitError> {
    let missed = missed(data, &DVector::zeros(x.len()), std::slice::from_ref(x));
    let length = whitened(data, linearisations, &missed[1..])?.norm();
    // Also where the length is no number.
    Ok(!matches!(length.partial_cmp(&LINEAR), Some(Ordering::Less)))
}

/// Columns of `3 n` readings [m/s^2], counted in standard uncertainties.
fn whitened(data: &Data, linearisations: &[Linearisation], columns: &[DVector<f64>]) -> Result<DMatrix<f64>, FitError> {
    let mut whitened = DMatrix::zeros(3 * linearisations.len(), columns.len());
    for (n, (observation, at)) in data.observations().iter().zip(linearisations).enumerate() {
        let whitener = Whitener::new(&observation.into(), at)?;
        for (mut of_all, column) in whitened.column_iter_mut().zip(columns) {
            of_all.fixed_rows_mut::<3>(3 * n).copy_from(&whitener.apply(&column.fixed_rows::<3>(3 * n).into_owned()));
        }
    }
    Ok(whitened)
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

/// `sum_k e_k`, `sqrt(2) e_k` of every direction and `e_kl` of every two, `3 n` each [m/s^2].
fn missed(data: &Data, x: &DVector<f64>, directions: &[DVector<f64>]) -> Vec<DVector<f64>> {
    let reading = |x: DVector<f64>| {
        let residuals = data.residuals(x.as_slice());
        -DVector::from_iterator(3 * residuals.len(), residuals.iter().flat_map(|r| r.iter().copied()))
    };
    let mut columns = Vec::new();
    let here = reading(x.clone());
    let mut mean = DVector::zeros(here.len());
    for (k, d) in directions.iter().enumerate() {
        let square = (reading(x + d) + reading(x - d)) * 0.5 - &here;
        mean += &square;
        columns.push(square * std::f64::consts::SQRT_2);
        for e in &directions[k + 1..] {
            let [sum, difference] = [d + e, d - e];
            let alike = reading(x + &sum) + reading(x - sum);
            let apart = reading(x + &difference) + reading(x - difference);
            columns.push((alike - apart) * 0.25);
        }
    }
    columns.push(mean);
    columns
}
