//! Linear least squares `min |A x - b|` by Householder QR.
//!
//! The unknowns are counted in sizes of theirs, `x = S y` with a diagonal `S`, which takes their units out of the
//! condition number. With `A S = Q R` the solution is `S R^-1 Q^T b`, its covariance for errors of `b` of unit variance
//! `S R^-1 R^-T S`.

use nalgebra::{DMatrix, DVector, Dyn, QR};

/// Equations of full rank, at least as many as unknowns, factored.
#[derive(Debug, Clone)]
pub struct LeastSquares {
    qr: QR<f64, Dyn, Dyn>,
    r: DMatrix<f64>,
    rows: usize,
    sizes: DVector<f64>,
}

/// A solution.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// `x`.
    pub x: DVector<f64>,
    /// Length of `x` in standard uncertainties, all unknowns together.
    pub whitened_length: f64,
}

impl LeastSquares {
    /// Factors `A S`, the equations in units of the `sizes` of the unknowns.
    pub fn new(scaled: DMatrix<f64>, sizes: DVector<f64>) -> Self {
        let rows = scaled.nrows();
        let qr = scaled.qr();
        Self { r: qr.r(), qr, rows, sizes }
    }

    /// The solution for `b`; rows that it lacks at its end are zeros.
    pub fn solve(&self, b: DVector<f64>) -> Solution {
        let mut rotated = b.resize_vertically(self.rows, 0.0);
        self.qr.q_tr_mul(&mut rotated);
        let mut x = rotated.rows_range(..self.columns()).into_owned();
        let whitened_length = x.norm();
        let solved = self.r.solve_upper_triangular_mut(&mut x);
        debug_assert!(solved, "the equations are of full rank");
        x.component_mul_assign(&self.sizes);
        Solution { x, whitened_length }
    }

    /// `Q^T B`: the first rows, one per unknown, are what the unknowns follow; the others are what none of them can. Rows
    /// that `B` lacks at its end are zeros.
    pub fn rotated(&self, b: DMatrix<f64>) -> DMatrix<f64> {
        let mut rotated = b.resize_vertically(self.rows, 0.0);
        self.qr.q_tr_mul(&mut rotated);
        rotated
    }

    /// The solutions, column by column, for the first rows of a matrix [`LeastSquares::rotated`].
    pub fn unknowns(&self, rotated: &DMatrix<f64>) -> DMatrix<f64> {
        let mut unknowns = rotated.rows_range(..self.columns()).into_owned();
        let solved = self.r.solve_upper_triangular_mut(&mut unknowns);
        debug_assert!(solved, "the equations are of full rank");
        self.in_units(unknowns)
    }

    /// The part of `b`, rotated, that no unknown can follow: its squares are those of the residuals. Rows that it lacks at
    /// its end are zeros.
    pub fn redundant(&self, b: &DVector<f64>) -> DVector<f64> {
        let mut rotated = b.clone().resize_vertically(self.rows, 0.0);
        self.qr.q_tr_mul(&mut rotated);
        rotated.rows_range(self.columns()..).into_owned()
    }

    /// The first `rows` rows of `Q`, an orthonormal basis of the columns.
    pub fn basis(&self, rows: usize) -> DMatrix<f64> {
        self.qr.q().rows(0, rows).into_owned()
    }

    /// Number of unknowns.
    pub fn columns(&self) -> usize {
        self.sizes.len()
    }

    /// `R`, in units of the sizes.
    pub fn triangle(&self) -> &DMatrix<f64> {
        &self.r
    }

    /// `R^-1`, in units of the sizes.
    pub fn inverse(&self) -> DMatrix<f64> {
        let mut inverse = DMatrix::identity(self.columns(), self.columns());
        let solved = self.r.solve_upper_triangular_mut(&mut inverse);
        debug_assert!(solved, "the equations are of full rank");
        inverse
    }

    /// Covariance of the solution for errors of `b` of unit variance.
    pub fn covariance(&self) -> DMatrix<f64> {
        let inverse = self.in_units(self.inverse());
        &inverse * inverse.transpose()
    }

    /// Standard uncertainties of the solution for errors of `b` of unit variance: lengths of the rows of `S R^-1`.
    pub fn standard_uncertainties(&self) -> Vec<f64> {
        self.inverse().row_iter().zip(self.sizes.iter()).map(|(row, size)| row.norm() * size).collect()
    }

    /// From units of the sizes to those of the unknowns, row by row.
    fn in_units(&self, mut rows: DMatrix<f64>) -> DMatrix<f64> {
        rows.row_iter_mut().zip(self.sizes.iter()).for_each(|(mut row, size)| row *= *size);
        rows
    }
}

/// The equations of the first `columns` unknowns alone, where the others are zero with a standard uncertainty of 1 and are
/// eliminated: with `[B J; E 0] = Q [R_b R_bj; 0 R_j]`, the rows `R_j`. The equations themselves where there are no others.
pub(crate) fn marginal(rows: DMatrix<f64>, columns: usize) -> DMatrix<f64> {
    let (count, others) = (rows.nrows(), rows.ncols() - columns);
    if others == 0 {
        return rows;
    }
    let mut stacked = DMatrix::zeros(count + others, columns + others);
    stacked.view_mut((0, 0), (count, others)).copy_from(&rows.columns(columns, others));
    stacked.view_mut((0, others), (count, columns)).copy_from(&rows.columns(0, columns));
    stacked.view_mut((count, 0), (others, others)).fill_with_identity();
    let triangle = stacked.qr().r();
    let left = triangle.nrows().saturating_sub(others);
    triangle.view((others, others), (left, columns)).into_owned()
}
