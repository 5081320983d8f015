//! The covariance `B` that is beside known errors in the scatter of rows, `T = B + V` in the mean.
//!
//! `T - V` alone would be too noisy for nearly as many parameters as rows, and have negative eigenvalues.
//!
//! 1. The target `T_0 = V + diag(s)` has independent parameters. Fisher's scoring solves `(S^-1 * S^-1) s = diag(S^-1 (T - V) S^-1)` with the
//!    product by elements and the last `S = V + diag(s)` (T. W. Anderson, Ann. Statist. 1, 1973). So a parameter whose errors are large is
//!    determined by the combinations that are well known.
//! 2. `T* = lambda T_0 + (1 - lambda) T`, where `lambda = sum Var(t_jk) / sum (t_jk - delta_jk)^2` with `t = L^-1 T L^-T`, `T_0 = L L^T`
//!    (J. Schaefer and K. Strimmer, Stat. Appl. Genet. Mol. Biol. 4, 2005), `Var(t_jk) = (t_jj t_kk + t_jk^2) / n` of normal rows.
//! 3. `B = L (1 - M)_+ L^T` with `M = L^-1 V L^-T` and `T* = L L^T`: where errors explain more than the scatter, `B` has nothing, which is
//!    the estimate of highest restricted likelihood for rows that are alike (Y. Amemiya, Am. Statist. 39, 1985).

use nalgebra::{DMatrix, DVector};

/// `B` by the scatter `T` of as many `rows`, and the mean `V` of their errors. `None` where `T_0` is not positive definite.
pub fn between(scatter: &DMatrix<f64>, errors: &DMatrix<f64>, rows: usize) -> Option<DMatrix<f64>> {
    let independent = independent(scatter, errors)?;
    let target = errors + DMatrix::from_diagonal(&independent);
    let lower = shrunk(scatter, &target, rows)?.cholesky()?.unpack();
    let mut rest = (DMatrix::identity(lower.nrows(), lower.nrows()) - whitened(&lower, errors)?).symmetric_eigen();
    rest.eigenvalues.apply(|value| *value = value.max(0.0));
    let root = &lower * rest.eigenvectors * DMatrix::from_diagonal(&rest.eigenvalues.map(f64::sqrt));
    Some(&root * root.transpose())
}

/// `s`, not below zero.
fn independent(scatter: &DMatrix<f64>, errors: &DMatrix<f64>) -> Option<DVector<f64>> {
    let mut variances = scatter.diagonal();
    for _ in 0..STEPS {
        let inverse = (errors + DMatrix::from_diagonal(&variances)).cholesky()?.inverse();
        let slopes = (&inverse * (scatter - errors) * &inverse).diagonal();
        variances = inverse.component_mul(&inverse).cholesky()?.solve(&slopes).map(|variance| variance.max(0.0));
    }
    Some(variances)
}

/// `T*`.
fn shrunk(scatter: &DMatrix<f64>, target: &DMatrix<f64>, rows: usize) -> Option<DMatrix<f64>> {
    let found = whitened(&target.clone().cholesky()?.unpack(), scatter)?;
    let (mut doubt, mut size) = (0.0, 0.0);
    for ((j, k), value) in (0..found.ncols()).flat_map(|k| (0..found.nrows()).map(move |j| (j, k))).zip(found.iter()) {
        doubt += (found[(j, j)] * found[(k, k)] + value * value) / rows as f64;
        size += (value - f64::from(u8::from(j == k))).powi(2);
    }
    let lambda = if size > doubt { doubt / size } else { 1.0 };
    Some(target * lambda + scatter * (1.0 - lambda))
}

/// `L^-1 C L^-T`.
fn whitened(lower: &DMatrix<f64>, covariance: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let half = lower.solve_lower_triangular(covariance)?;
    lower.solve_lower_triangular(&half.transpose())
}

/// Steps of scoring: a target need not be exact.
const STEPS: usize = 3;
