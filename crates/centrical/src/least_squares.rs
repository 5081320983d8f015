//! Linear least squares by Householder QR: `min |A x - b|`, columns of `A` scaled to unit length first.
//!
//! With `A = Q R` the solution is `R^-1 Q^T b` and its covariance for errors of unit variance `R^-1 R^-T`. Scaling the
//! columns costs nothing and takes the units of the unknowns out of the condition number.

use nalgebra::{DMatrix, DVector};

/// A solution and what is needed to judge it.
#[derive(Debug, Clone, PartialEq)]
pub struct LeastSquares {
    /// `x`.
    pub solution: DVector<f64>,
    /// Sum of squared residuals `|A x - b|^2`: of the part of `b` that is outside the columns of `A`.
    pub sum_of_squares: f64,
    /// Rows less columns.
    pub degrees_of_freedom: usize,
    /// `R^-1`, in the units of the unknowns.
    inverse: DMatrix<f64>,
}

impl LeastSquares {
    /// Solves `min |A x - b|`; `None` if there are fewer rows than columns or a column depends on the others exactly.
    pub fn solve(mut a: DMatrix<f64>, b: &DVector<f64>) -> Option<Self> {
        let (n, p) = a.shape();
        let degrees_of_freedom = n.checked_sub(p)?;
        let norms = DVector::from_iterator(p, a.column_iter().map(|column| column.norm()));
        a.column_iter_mut().zip(norms.iter()).for_each(|(mut column, norm)| column /= *norm);
        let qr = a.qr();
        let mut rotated = b.clone();
        qr.q_tr_mul(&mut rotated);
        let r = qr.unpack_r();
        let mut solution = rotated.rows(0, p).into_owned();
        let mut inverse = DMatrix::identity(p, p);
        let solved = r.solve_upper_triangular_mut(&mut solution) && r.solve_upper_triangular_mut(&mut inverse);
        solution.component_div_assign(&norms);
        inverse.row_iter_mut().zip(norms.iter()).for_each(|(mut row, norm)| row /= *norm);
        let sum_of_squares = rotated.rows(p, degrees_of_freedom).norm_squared();
        let finite = solution.iter().chain(inverse.iter()).all(|v| v.is_finite());
        (solved && finite).then_some(Self { solution, sum_of_squares, degrees_of_freedom, inverse })
    }

    /// Covariance of the solution for errors of `b` of unit variance, `R^-1 R^-T`.
    pub fn covariance(&self) -> DMatrix<f64> {
        &self.inverse * self.inverse.transpose()
    }

    /// Variance of the errors of `b` as the residuals show it; `None` if nothing is redundant.
    pub fn residual_variance(&self) -> Option<f64> {
        (self.degrees_of_freedom > 0).then(|| self.sum_of_squares / self.degrees_of_freedom as f64)
    }
}
