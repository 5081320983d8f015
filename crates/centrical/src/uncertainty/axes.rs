//! A calibrated error model in other axes, with its covariance.
//!
//! In instrument axes a reading is `f' = b + A f_z + N(f_z)` [K4.1]: bias, scale matrix `A = E + G0`, and the other terms. Another frame
//! `b` is turned from it, `f_z = c_zb f_b`, so that `f' = b + T f_b + N(c_zb f_b)` with the scale matrix `T = A c_zb`. The other terms stay
//! along the axes of the newtonometers: turned, a square of `f_1` would be products of all three components.
//!
//! A small further turn `w` of the instrument, in axes `b`, makes `c_zb (E + hat(w))` of `c_zb`. With it `dT = dA c_zb + T hat(w)`.

use centrical_compensate::{Monomial, Term};
use nalgebra::{DMatrix, Matrix3, Matrix3xX, Vector3};

use super::compensated::Compensated;
use crate::model::{hat, rotation};

/// What makes the axes of a unit unique, up to its own error model: a condition on the scale matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ScaleForm {
    /// `T_12 = T_13 = T_23 = 0`: axis 1 is that of newtonometer 1, and newtonometer 2 lies in the plane of axes 1 and 2.
    LowerTriangular,
    /// `T_21 = T_31 = T_32 = 0`: axis 3 is that of newtonometer 3, and newtonometer 2 lies in the plane of axes 2 and 3.
    UpperTriangular,
    /// `T = T^T`: the axes that are nearest to those of all three newtonometers.
    Symmetric,
}

/// Steps of Newton's method: a few for newtonometers that are nearly orthogonal, more for others.
const STEPS: usize = 20;

impl ScaleForm {
    /// The attitude `c_zb` of the axes in which the scale matrix of `terms` has this form; `None` where no turn brings it there.
    pub fn attitude(self, terms: &[Term]) -> Option<Matrix3<f64>> {
        let scale_z = scale_at_zero(terms);
        let mut c_zb = Matrix3::identity();
        for _ in 0..STEPS {
            let scale_b = scale_z * c_zb;
            // Rotations stay rotations: the step is an exact one.
            c_zb *= rotation(&self.turn(&scale_b, &scale_b)?);
        }
        let (scale_b, size) = (scale_z * c_zb, scale_z.amax());
        (self.violation(&scale_b).amax() <= 1e-12 * size).then_some(c_zb)
    }

    /// The small turn `w` that undoes what a change of the scale matrix, `change_b = dA c_zb`, does to the form of `scale_b`; `None` where no
    /// turn does.
    fn turn(self, scale_b: &Matrix3<f64>, change_b: &Matrix3<f64>) -> Option<Vector3<f64>> {
        let by_turn = unit_turns().map(|hat| self.violation(&(scale_b * hat)));
        Matrix3::from_columns(&by_turn).lu().solve(&-self.violation(change_b))
    }

    /// What the form holds at zero.
    fn violation(self, scale_b: &Matrix3<f64>) -> Vector3<f64> {
        let t = |i: usize, j: usize| scale_b[(i - 1, j - 1)];
        match self {
            Self::LowerTriangular => Vector3::new(t(1, 2), t(1, 3), t(2, 3)),
            Self::UpperTriangular => Vector3::new(t(2, 1), t(3, 1), t(3, 2)),
            Self::Symmetric => Vector3::new(t(2, 3) - t(3, 2), t(3, 1) - t(1, 3), t(1, 2) - t(2, 1)),
        }
    }

    /// The turns `w` by changes of the coefficients of `terms`, a column each, at the attitude `c_zb` [rad per unit of the coefficient];
    /// `None` as [`ScaleForm::attitude`].
    pub fn turn_by_coefficient(self, terms: &[Term], c_zb: &Matrix3<f64>) -> Option<Matrix3xX<f64>> {
        let scale_b = scale_at_zero(terms) * c_zb;
        let columns: Option<Vec<Vector3<f64>>> = terms
            .iter()
            .map(|term| match linear_in(term) {
                Some(j) => self.turn(&scale_b, &(unit(term.axis, j) * c_zb)),
                None => Some(Vector3::zeros()),
            })
            .collect();
        Some(Matrix3xX::from_columns(&columns?))
    }
}

/// Where the scale matrix stands among the quantities of [`ModelInAxes::covariance`].
const SCALE: usize = 3;

/// Where the coefficients of the other terms stand there.
const OTHERS: usize = 12;

/// A calibrated error model in axes `b`.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelInAxes {
    terms: Vec<Term>,
    c_zb: Matrix3<f64>,
    /// Of the coefficients, then the turn.
    covariance: DMatrix<f64>,
}

impl ModelInAxes {
    /// The error model in the axes at the attitude `c_zb`, a rotation. `covariance` is that of the coefficients of `terms`, SI, then of the
    /// turn `w` [rad]; `None` unless it has a row and a column for each of these.
    pub fn new(terms: Vec<Term>, c_zb: Matrix3<f64>, covariance: DMatrix<f64>) -> Option<Self> {
        let size = terms.len() + 3;
        (covariance.shape() == (size, size)).then_some(Self { terms, c_zb, covariance })
    }

    /// The same from `stated`, a covariance as [`ModelInAxes::covariance`] gives it; `None` if it is of another size.
    pub fn with_covariance(terms: Vec<Term>, c_zb: Matrix3<f64>, stated: &DMatrix<f64>) -> Option<Self> {
        let (count, others) = (terms.len(), terms.iter().filter(|term| is_other(term)).count());
        let turn = OTHERS + others;
        if stated.shape() != (turn + 3, turn + 3) {
            return None;
        }
        // The inverse of `dT = dA c_zb + T hat(w)`.
        let scale_b = scale_at_zero(&terms) * c_zb;
        let by_turn = unit_turns().map(|hat| scale_b * hat * c_zb.transpose());
        let mut by = DMatrix::zeros(count + 3, turn + 3);
        let mut other = OTHERS;
        for (row, term) in terms.iter().enumerate() {
            let i = term.axis;
            if let Some(j) = linear_in(term) {
                for k in 0..3 {
                    by[(row, SCALE + 3 * i + k)] = c_zb[(j, k)];
                    by[(row, turn + k)] = -by_turn[k][(i, j)];
                }
            } else if is_constant(term) {
                by[(row, i)] = 1.0;
            } else {
                by[(row, other)] = 1.0;
                other += 1;
            }
        }
        for k in 0..3 {
            by[(count + k, turn + k)] = 1.0;
        }
        Self::new(terms, c_zb, &by * stated * by.transpose())
    }

    /// Takes coordinates in these axes to coordinates in instrument axes.
    pub fn c_zb(&self) -> &Matrix3<f64> {
        &self.c_zb
    }

    /// Bias [m/s^2].
    pub fn bias(&self) -> Vector3<f64> {
        let constant = self.terms.iter().filter(|term| is_constant(term));
        constant.fold(Vector3::zeros(), |mut bias, term| {
            bias[term.axis] += term.coefficient;
            bias
        })
    }

    /// Gain `T`: row `i` is what newtonometer `i` reads per unit of each component.
    pub fn scale(&self) -> Matrix3<f64> {
        scale_at_zero(&self.terms) * self.c_zb
    }

    /// The other terms, along the axes of the newtonometers.
    pub fn others(&self) -> impl Iterator<Item = &Term> {
        self.terms.iter().filter(|term| is_other(term))
    }

    /// Covariance, SI, of bias (3), scale matrix by rows (9), coefficients of the other terms in their order, and turn (3).
    pub fn covariance(&self) -> DMatrix<f64> {
        let by = self.by_coefficients();
        &by * &self.covariance * by.transpose()
    }

    /// Change of these quantities by each coefficient and by the turn.
    fn by_coefficients(&self) -> DMatrix<f64> {
        let count = self.terms.len();
        let others = self.others().count();
        let mut by = DMatrix::zeros(OTHERS + others + 3, count + 3);
        let mut set_scale = |column: usize, change_b: &Matrix3<f64>| {
            for (k, change) in change_b.transpose().iter().enumerate() {
                by[(SCALE + k, column)] = *change;
            }
        };
        for (column, term) in self.terms.iter().enumerate() {
            if let Some(j) = linear_in(term) {
                set_scale(column, &(unit(term.axis, j) * self.c_zb));
            }
        }
        for (k, hat) in unit_turns().iter().enumerate() {
            set_scale(count + k, &(self.scale() * hat));
        }
        let mut other = OTHERS;
        for (column, term) in self.terms.iter().enumerate() {
            if is_constant(term) {
                by[(term.axis, column)] = 1.0;
            } else if is_other(term) {
                by[(other, column)] = 1.0;
                other += 1;
            }
        }
        for k in 0..3 {
            by[(OTHERS + others + k, count + k)] = 1.0;
        }
        by
    }

    /// Covariance [m^2/s^4] of a compensated reading in these axes, at the specific force `f_b` [m/s^2]; `None` where the error model
    /// cannot be inverted. With `f_b = c_bz f_z` an error `w` of the turn leaves `hat(f_b) w` in it.
    pub fn covariance_at(&self, f_b: &Vector3<f64>) -> Option<Matrix3<f64>> {
        let compensated = Compensated::new(self.terms.clone(), self.of_coefficients())?;
        let by_coefficient = self.c_zb.transpose() * compensated.sensitivity(&(self.c_zb * f_b))?;
        let mut by = Matrix3xX::zeros(self.terms.len() + 3);
        by.columns_mut(0, self.terms.len()).copy_from(&by_coefficient);
        by.columns_mut(self.terms.len(), 3).copy_from(&hat(f_b));
        Some(&by * &self.covariance * by.transpose())
    }

    fn of_coefficients(&self) -> DMatrix<f64> {
        let count = self.terms.len();
        self.covariance.view((0, 0), (count, count)).into_owned()
    }
}

/// `hat` of the unit vectors.
fn unit_turns() -> [Matrix3<f64>; 3] {
    [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| hat(&axis))
}

/// One at row `i`, column `j`, and zero elsewhere.
fn unit(i: usize, j: usize) -> Matrix3<f64> {
    let mut one = Matrix3::zeros();
    one[(i, j)] = 1.0;
    one
}

/// `A = E + G0`.
fn scale_at_zero(terms: &[Term]) -> Matrix3<f64> {
    terms.iter().fold(Matrix3::identity(), |scale, term| match linear_in(term) {
        Some(j) => scale + unit(term.axis, j) * term.coefficient,
        None => scale,
    })
}

/// The component that a term is linear in.
fn linear_in(term: &Term) -> Option<usize> {
    term.monomial.as_power().filter(|(_, power)| *power == 1).map(|(j, _)| j)
}

fn is_constant(term: &Term) -> bool {
    term.monomial == Monomial::ONE
}

fn is_other(term: &Term) -> bool {
    !is_constant(term) && linear_in(term).is_none()
}
