//! Correlations of the parameters of units, which need not be the same for all.
//!
//! The mean of a unit has the errors of its sessions, whose correlations `W` differences of neighbouring sessions show, and what the unit
//! differs by from others, with correlations `P`. Counted in `D_i`, with the part `w_ij = s_ij / D_ij` of the errors and
//! `b_ij^2 = 1 - w_ij^2`, unit `i` has the correlations
//!
//! `R_i = w_i w_i^T * W + b_i b_i^T * P`  (products by elements).
//!
//! `W`, and `P` by the mean over all units, are those of normal scores of the ranks, which a few outlying units hardly move. With nearly as
//! many parameters as units they are shrunk towards zero, `(1 - lambda) r_jk`, by the `lambda` of J. Schaefer and K. Strimmer (Stat. Appl.
//! Genet. Mol. Biol. 4, 2005): `lambda = sum Var(r_jk) / sum r_jk^2`.

use nalgebra::{Cholesky, DMatrix, Dyn};
use statrs::distribution::{ContinuousCDF, Normal};

/// `W` by the differences of neighbouring sessions, `m x p`.
pub fn of_sessions(differences: &DMatrix<f64>) -> DMatrix<f64> {
    shrunk(&of_ranks(differences, &normal_scores(differences.nrows())), None, differences.nrows())
}

/// Cholesky factors of `R_i` by the scores of units, `n x p`, and the [`normal_scores`] of as many: one of all units, or one of each where `W` is known and `w`, `n x p`. `None` where
/// one is not positive definite.
pub fn factors(
    scores: &DMatrix<f64>,
    normal_scores: &[f64],
    errors: Option<(&DMatrix<f64>, DMatrix<f64>)>,
) -> Option<Vec<Cholesky<f64, Dyn>>> {
    let (n, p) = scores.shape();
    let ranked = of_ranks(scores, normal_scores);
    let Some((sessions, parts)) = errors else { return Some(vec![shrunk(&ranked, None, n).cholesky()?]) };
    let rests = parts.map(|part| (1.0 - part * part).max(0.0).sqrt());
    let mean = |factors: &DMatrix<f64>| factors.tr_mul(factors) / n as f64;
    let mut between = shrunk(&ranked, Some(&mean(&parts).component_mul(sessions)), n);
    between.set_diagonal(&mean(&rests).diagonal());
    let between = as_correlations(between);
    let of_unit = |i: usize| {
        DMatrix::from_fn(p, p, |j, k| {
            let products = (parts[(i, j)] * parts[(i, k)], rests[(i, j)] * rests[(i, k)]);
            products.0 * sessions[(j, k)] + products.1 * between[(j, k)]
        })
    };
    (0..n).map(|unit| of_unit(unit).cholesky()).collect()
}

/// Correlations of normal scores of the ranks in each column.
fn of_ranks(values: &DMatrix<f64>, normal_scores: &[f64]) -> DMatrix<f64> {
    let mut ranked = DMatrix::zeros(values.nrows(), values.ncols());
    for (column, mut ranked) in values.column_iter().zip(ranked.column_iter_mut()) {
        let mut order: Vec<usize> = (0..column.len()).collect();
        order.sort_by(|&a, &b| column[a].total_cmp(&column[b]));
        for (score, row) in normal_scores.iter().zip(order) {
            ranked[row] = *score;
        }
    }
    ranked.tr_mul(&ranked)
}

/// Correlations of `n` rows less those that are `known`, if any, shrunk; 1 on the diagonal.
fn shrunk(correlations: &DMatrix<f64>, known: Option<&DMatrix<f64>>, n: usize) -> DMatrix<f64> {
    let p = correlations.nrows();
    let rest = |i: usize, j: usize| correlations[(i, j)] - known.map_or(0.0, |known| known[(i, j)]);
    let (mut doubt, mut size) = (0.0, 0.0);
    for i in 0..p {
        for j in 0..i {
            doubt += (1.0 - correlations[(i, j)].powi(2)).powi(2) / (n - 1) as f64;
            size += rest(i, j).powi(2);
        }
    }
    let lambda = if size > doubt { doubt / size } else { 1.0 };
    DMatrix::from_fn(p, p, |i, j| if i == j { 1.0 } else { (1.0 - lambda) * rest(i, j) })
}

/// The correlations of the nearest matrix without negative eigenvalues; none where the diagonal is zero.
fn as_correlations(covariance: DMatrix<f64>) -> DMatrix<f64> {
    let p = covariance.nrows();
    let positive = if covariance.clone().cholesky().is_some() {
        covariance
    } else {
        let mut eigen = covariance.symmetric_eigen();
        eigen.eigenvalues.apply(|value| *value = value.max(0.0));
        eigen.recompose()
    };
    let scale = positive.diagonal().map(|variance| if variance > NOTHING { 1.0 / variance.sqrt() } else { 0.0 });
    DMatrix::from_fn(p, p, |i, j| if i == j { 1.0 } else { positive[(i, j)] * scale[i] * scale[j] })
}

/// A variance that rounding leaves.
const NOTHING: f64 = 1e-12;

/// Blom's normal scores, of unit length.
pub fn normal_scores(n: usize) -> Vec<f64> {
    let normal = Normal::standard();
    let score = |rank: usize| normal.inverse_cdf((rank as f64 + 0.625) / (n as f64 + 0.25));
    let scores: Vec<f64> = (0..n).map(score).collect();
    let length = scores.iter().map(|s| s * s).sum::<f64>().sqrt();
    scores.into_iter().map(|s| s / length).collect()
}
