//! Rows of values with the covariances of their errors, which are made one after the other where they are needed.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rayon::prelude::*;

/// `n` rows of `p` values.
pub struct Rows<'a> {
    /// Values, `n x p`.
    pub values: DMatrix<f64>,
    /// Variances of their errors, `n x p`.
    pub variances: DMatrix<f64>,
    /// Adds the covariance `V_i` of the errors of a row, times a weight, to a sum, `p x p`; on and below the diagonal at least.
    pub add_errors: &'a (dyn Fn(usize, f64, &mut DMatrix<f64>) + Sync),
}

impl Rows<'_> {
    /// The weighted mean of `V_i`.
    pub fn mean_errors(&self, weights: &[f64]) -> DMatrix<f64> {
        let p = self.values.ncols();
        let of_piece = |(piece, weights): (usize, &[f64])| {
            let mut sum = DMatrix::zeros(p, p);
            for (row, weight) in (piece * PIECE..).zip(weights).filter(|(_, weight)| **weight > 0.0) {
                (self.add_errors)(row, *weight, &mut sum);
            }
            sum
        };
        let of_pieces: Vec<DMatrix<f64>> = weights.par_chunks(PIECE).enumerate().map(of_piece).collect();
        let mut sum: DMatrix<f64> = of_pieces.into_iter().sum();
        sum.fill_upper_triangle_with_lower_triangle();
        sum / weights.iter().sum::<f64>()
    }

    /// `(x_i - m)^T (B + V_i)^-1 (x_i - m)`; `None` where a covariance is not positive definite.
    pub fn squared_distances(&self, centre: &DVector<f64>, between: &DMatrix<f64>) -> Option<Vec<f64>> {
        let of_row = |row: usize| Some(self.whitened(row, centre, between)?.0.norm_squared());
        (0..self.values.nrows()).into_par_iter().with_min_len(PIECE).map(of_row).collect()
    }

    /// Squared distances, and `ln det (B + V_i)`; `None` as before.
    pub fn likelihoods(&self, centre: &DVector<f64>, between: &DMatrix<f64>) -> Option<Vec<(f64, f64)>> {
        let of_row = |row: usize| {
            let (residual, factor) = self.whitened(row, centre, between)?;
            Some((residual.norm_squared(), 2.0 * factor.l_dirty().diagonal().iter().map(|l| l.ln()).sum::<f64>()))
        };
        (0..self.values.nrows()).into_par_iter().with_min_len(PIECE).map(of_row).collect()
    }

    fn whitened(
        &self,
        row: usize,
        centre: &DVector<f64>,
        between: &DMatrix<f64>,
    ) -> Option<(DVector<f64>, Cholesky<f64, Dyn>)> {
        let mut covariance = between.clone();
        (self.add_errors)(row, 1.0, &mut covariance);
        let mut residual = self.values.row(row).transpose() - centre;
        let factor = Cholesky::new(covariance)?;
        factor.l_dirty().solve_lower_triangular_mut(&mut residual);
        Some((residual, factor))
    }
}

/// Rows for one thread at a time. Sums over pieces are the same on any number of threads.
const PIECE: usize = 256;

/// Adds `matrix`, times a weight, to `sum`.
pub fn add_scaled(matrix: &DMatrix<f64>, weight: f64, sum: &mut DMatrix<f64>) {
    sum.zip_apply(matrix, |sum, value| *sum += weight * value);
}
