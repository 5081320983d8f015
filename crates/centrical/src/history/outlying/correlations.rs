//! Correlations of the parameters of units, which need not be the same for all.
//!
//! The mean of a unit has the errors of its sessions, with correlations `W_i`, and what the unit differs by from others, with correlations
//! `P`. Counted in `D_i`, with the part `w_ij = s_ij / D_ij` of the errors and `b_ij^2 = 1 - w_ij^2`, unit `i` has the correlations
//!
//! `R_i = w_i w_i^T * W_i + b_i b_i^T * P`  (products by elements).
//!
//! `W_i = lambda S_i + (1 - lambda) W`, where the sessions of the unit state `S_i` and differences of neighbouring sessions show `W`. `W`, and
//! `P` by the mean over all units, are those of normal scores of the ranks, which a few outlying units hardly move. With nearly as many
//! parameters as units `P` is shrunk towards zero, `(1 - lambda) r_jk`. Each `lambda` is that of J. Schaefer and K. Strimmer (Stat. Appl.
//! Genet. Mol. Biol. 4, 2005), `lambda = sum Var(r_jk) / sum (r_jk - t_jk)^2` with the target `t`: 1 where sessions scatter as they
//! state, near 0 where many of them contradict it.

use nalgebra::{Cholesky, DMatrix, DVectorView, Dyn};
use statrs::distribution::{ContinuousCDF, Normal};

/// `W_i` by the correlations `S_i` that sessions state and the differences of neighbouring sessions, `m x p`; `S_i` where there are none.
pub fn of_sessions(stated: &[DMatrix<f64>], differences: Option<&DMatrix<f64>>) -> Vec<DMatrix<f64>> {
    let Some(differences) = differences else { return stated.to_vec() };
    let count = differences.nrows();
    let shown = of_ranks(differences, &normal_scores(count));
    let lambda = shrinkage(&shown, &mean(stated), count);
    stated.iter().map(|stated| stated * lambda + &shown * (1.0 - lambda)).collect()
}

/// Cholesky factors of `R_i` by the scores of units, `n x p`, the [`normal_scores`] of as many, `W_i`, and `w`, `n x p`. `None` where one is
/// not positive definite.
pub fn factors(
    scores: &DMatrix<f64>,
    normal_scores: &[f64],
    errors: &[DMatrix<f64>],
    parts: &DMatrix<f64>,
) -> Option<Vec<Cholesky<f64, Dyn>>> {
    let (n, p) = scores.shape();
    // Rows of units as columns: their numbers then lie side by side.
    let parts = parts.transpose();
    let rests = parts.map(|part| (1.0 - part * part).max(0.0).sqrt());
    let mut known = DMatrix::zeros(p, p);
    for (errors, parts) in errors.iter().zip(parts.column_iter()) {
        add_scaled(&mut known, errors, parts.as_slice());
    }
    known /= n as f64;
    let ranked = of_ranks(scores, normal_scores);
    let lambda = shrinkage(&ranked, &known, n);
    let mut between = (ranked - known) * (1.0 - lambda);
    between.set_diagonal(&(rests.component_mul(&rests).column_sum() / n as f64));
    let between = as_correlations(between);
    let of_unit = |(errors, (parts, rests)): (&DMatrix<f64>, (DVectorView<f64>, DVectorView<f64>))| {
        let mut of_unit = DMatrix::zeros(p, p);
        add_scaled(&mut of_unit, errors, parts.as_slice());
        add_scaled(&mut of_unit, &between, rests.as_slice());
        of_unit.cholesky()
    };
    errors.iter().zip(parts.column_iter().zip(rests.column_iter())).map(of_unit).collect()
}

/// Adds `matrix_jk scale_j scale_k` on and below the diagonal.
fn add_scaled(sum: &mut DMatrix<f64>, matrix: &DMatrix<f64>, scale: &[f64]) {
    for (k, (mut sum, matrix)) in sum.column_iter_mut().zip(matrix.column_iter()).enumerate() {
        for ((sum, matrix), of_row) in sum.as_mut_slice()[k..].iter_mut().zip(&matrix.as_slice()[k..]).zip(&scale[k..])
        {
            *sum += matrix * of_row * scale[k];
        }
    }
}

fn mean(matrices: &[DMatrix<f64>]) -> DMatrix<f64> {
    matrices.iter().sum::<DMatrix<f64>>() / matrices.len() as f64
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

/// `lambda` of the correlations of `n` rows and their target.
fn shrinkage(correlations: &DMatrix<f64>, target: &DMatrix<f64>, n: usize) -> f64 {
    let (mut doubt, mut size) = (0.0, 0.0);
    for i in 0..correlations.nrows() {
        for j in 0..i {
            let correlation = correlations[(i, j)];
            doubt += (1.0 - correlation.powi(2)).powi(2) / (n - 1) as f64;
            size += (correlation - target[(i, j)]).powi(2);
        }
    }
    if size > doubt { doubt / size } else { 1.0 }
}

/// The correlations of the nearest matrix without negative eigenvalues, by the lower triangle; none where the diagonal is zero.
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
