//! Linear least squares `min |A x - b|` by Householder QR.
//!
//! The unknowns are counted in sizes of theirs, `x = S y` with a diagonal `S`, which takes their units out of the
//! condition number. With `A S = Q R` the solution is `S R^-1 Q^T b`, its covariance for errors of `b` of unit variance
//! `S R^-1 R^-T S`. Unknowns that few equations contain are eliminated with these first.

use nalgebra::{DMatrix, DVector, Dyn, QR};

use super::elimination::{Elimination, Own};

/// Equations of full rank, at least as many as unknowns, factored.
#[derive(Debug, Clone)]
pub struct LeastSquares {
    elimination: Elimination,
    /// Of the equations left by the elimination.
    qr: QR<f64, Dyn, Dyn>,
    r: DMatrix<f64>,
    /// Numbers of equations left, and of all.
    left: usize,
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
        Self::eliminating(&[], scaled, sizes)
    }

    /// Factors `A`, its columns scaled to unit length. `None` where they are dependent or more than the rows.
    pub(crate) fn of_columns(mut columns: DMatrix<f64>) -> Option<Self> {
        /// What rounding leaves of a column of unit length that others make up.
        const ROUNDING: f64 = 1e-12;
        let sizes = DVector::from_iterator(columns.ncols(), columns.column_iter().map(|column| 1.0 / column.norm()));
        columns.column_iter_mut().zip(&sizes).for_each(|(mut column, size)| column *= *size);
        let equations = (columns.nrows() >= columns.ncols()).then(|| Self::new(columns, sizes))?;
        equations.r.diagonal().iter().all(|length| length.abs() > ROUNDING).then_some(equations)
    }

    /// The same as [`Self::new`], and the unknowns of some groups are eliminated first.
    pub(crate) fn eliminating(groups: &[Own], scaled: DMatrix<f64>, sizes: DVector<f64>) -> Self {
        let rows = scaled.nrows();
        let (elimination, left) = Elimination::of(scaled, groups);
        let (left, qr) = (left.nrows(), left.qr());
        Self { elimination, r: qr.r(), qr, left, rows, sizes }
    }

    /// The solution for `b`; rows that it lacks at its end are zeros.
    pub fn solve(&self, b: DVector<f64>) -> Solution {
        let rotated = self.rotated(DMatrix::from_columns(&[b]));
        let whitened_length = rotated.rows_range(..self.columns()).norm();
        Solution { x: self.unknowns(&rotated).column(0).into_owned(), whitened_length }
    }

    /// `Q^T B`: the first rows, one per unknown, are what the unknowns follow; the others are what none of them can. Rows
    /// that `B` lacks at its end are zeros.
    pub fn rotated(&self, b: DMatrix<f64>) -> DMatrix<f64> {
        let mut rotated = self.elimination.rotated(b.resize_vertically(self.rows, 0.0));
        self.qr.q_tr_mul(&mut rotated.rows_mut(self.elimination.columns(), self.left));
        rotated
    }

    /// The solutions, column by column, for the first rows of a matrix [`LeastSquares::rotated`].
    pub fn unknowns(&self, rotated: &DMatrix<f64>) -> DMatrix<f64> {
        self.in_units(self.in_sizes(rotated))
    }

    /// The part of `b`, rotated, that no unknown can follow: its squares are those of the residuals. Rows that it lacks at
    /// its end are zeros.
    pub fn redundant(&self, b: &DVector<f64>) -> DVector<f64> {
        let rotated = self.rotated(DMatrix::from_columns(std::slice::from_ref(b)));
        rotated.column(0).rows_range(self.columns()..).into_owned()
    }

    /// The first `rows` rows of `Q`, an orthonormal basis of the columns.
    pub fn basis(&self, rows: usize) -> DMatrix<f64> {
        let (eliminated, left) = (self.elimination.columns(), self.qr.q());
        let mut basis = DMatrix::identity(self.rows, self.columns());
        basis.view_mut((eliminated, eliminated), left.shape()).copy_from(&left);
        self.elimination.turned_back(basis).rows(0, rows).into_owned()
    }

    /// Number of unknowns.
    pub fn columns(&self) -> usize {
        self.sizes.len()
    }

    /// `R` of the unknowns that are not eliminated, in units of the sizes.
    pub fn triangle(&self) -> &DMatrix<f64> {
        &self.r
    }

    /// `R^-1`, in units of the sizes.
    pub fn inverse(&self) -> DMatrix<f64> {
        self.in_sizes(&DMatrix::identity(self.columns(), self.columns()))
    }

    /// Principal directions of the covariance whose standard uncertainty, in sizes of the unknowns, is above a limit, and as long
    /// as it; the unknowns that are eliminated follow the others.
    pub fn wider_than(&self, limit: f64) -> Vec<DVector<f64>> {
        let svd = self.r.clone().svd(false, true);
        let Some(directions) = svd.v_t else { return Vec::new() };
        let pairs = svd.singular_values.iter().zip(directions.row_iter());
        let wide = pairs.filter(|(s, _)| **s * limit < 1.0).map(|(s, direction)| direction.transpose() / *s);
        let none = DMatrix::zeros(self.elimination.columns(), 1);
        wide.map(|d| self.elimination.completed(&none, DMatrix::from_columns(&[d])).column(0).into_owned()).collect()
    }

    /// Covariance of the solution for errors of `b` of unit variance.
    pub fn covariance(&self) -> DMatrix<f64> {
        let root = self.root();
        &root * root.transpose()
    }

    /// Standard uncertainties of the solution for errors of `b` of unit variance: lengths of the rows of `S R^-1`.
    pub fn standard_uncertainties(&self) -> Vec<f64> {
        self.inverse().row_iter().zip(self.sizes.iter()).map(|(row, size)| row.norm() * size).collect()
    }

    /// A root of the covariance, `S R^-1`.
    pub fn root(&self) -> DMatrix<f64> {
        self.in_units(self.inverse())
    }

    /// [`LeastSquares::unknowns`] in units of the sizes.
    fn in_sizes(&self, rotated: &DMatrix<f64>) -> DMatrix<f64> {
        let mut left = rotated.rows_range(self.elimination.columns()..self.columns()).into_owned();
        let solved = self.r.solve_upper_triangular_mut(&mut left);
        debug_assert!(solved, "the equations are of full rank");
        self.elimination.completed(rotated, left)
    }

    /// From units of the sizes to those of the unknowns, row by row.
    fn in_units(&self, mut rows: DMatrix<f64>) -> DMatrix<f64> {
        rows.row_iter_mut().zip(self.sizes.iter()).for_each(|(mut row, size)| row *= *size);
        rows
    }
}
