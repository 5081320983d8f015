//! Linearised equations of full rank, and a step by least squares.

use nalgebra::{DMatrix, DVector, Dyn, QR};

/// Whitened equations of full rank in typical units.
pub(super) struct Equations<'a> {
    pub rows: DMatrix<f64>,
    pub misfit: DVector<f64>,
    pub typical: &'a DVector<f64>,
}

impl<'a> Equations<'a> {
    /// Householder QR and back substitution.
    pub fn solve(self) -> Step<'a> {
        Step::of(&self.rows.qr(), self.misfit, self.typical)
    }
}

/// A solution of the linearised equations.
pub(super) struct Step<'a> {
    pub dx: DVector<f64>,
    /// Length of the step in standard uncertainties, all unknowns together.
    pub whitened_length: f64,
    /// `R` of the equations in typical units.
    r: DMatrix<f64>,
    typical: &'a DVector<f64>,
}

impl<'a> Step<'a> {
    /// Back substitution of `misfit` in the factored equations.
    pub fn of(factored: &QR<f64, Dyn, Dyn>, mut misfit: DVector<f64>, typical: &'a DVector<f64>) -> Self {
        factored.q_tr_mul(&mut misfit);
        let head = misfit.rows(0, typical.len()).into_owned();
        let (r, whitened_length, mut dx) = (factored.r(), head.norm(), head);
        // Held null directions leave no zero on the diagonal.
        let solved = r.solve_upper_triangular_mut(&mut dx);
        debug_assert!(solved, "the held equations are of full rank");
        dx.component_mul_assign(typical);
        Step { dx, whitened_length, r, typical }
    }

    /// `R^-1`, in typical units.
    pub fn inverse(&self) -> DMatrix<f64> {
        let mut inverse = DMatrix::identity(self.typical.len(), self.typical.len());
        self.r.solve_upper_triangular_mut(&mut inverse);
        inverse
    }

    /// `R^-1 R^-T`, in physical units.
    pub fn covariance(&self) -> DMatrix<f64> {
        let mut inverse = self.inverse();
        inverse.row_iter_mut().zip(self.typical.iter()).for_each(|(mut row, typical)| row *= *typical);
        &inverse * inverse.transpose()
    }
}
