//! The error model prepared for many samples: powers of one `f_j` alone are summed by Horner's scheme.

use centrical_compensate::Monomial;
use nalgebra::Vector3;

use crate::model::ErrorModel;

/// Highest power gathered into the polynomials.
const DEGREE: usize = 3;

/// `f'_i = sum_j p_ij(f_j) + other terms`.
#[derive(Debug, Clone)]
pub(super) struct Response {
    /// Coefficients of `p_ij` from power 0 up; the identity `f_i` is in `p_ii`.
    polynomials: [[[f64; DEGREE + 1]; 3]; 3],
    /// (Newtonometer, coefficient, monomial).
    others: Vec<(usize, f64, Monomial)>,
}

impl Response {
    pub fn new(error_model: &ErrorModel, coefficients: &[f64]) -> Self {
        let mut polynomials = [[[0.0; DEGREE + 1]; 3]; 3];
        for i in 0..3 {
            polynomials[i][i][1] = 1.0;
        }
        let mut others = Vec::new();
        for (term, &c) in error_model.terms.iter().zip(coefficients) {
            match term.monomial.as_power().map(|(j, power)| (j, usize::from(power))) {
                Some((j, power)) if power <= DEGREE => polynomials[term.axis][j][power] += c,
                _ => others.push((term.axis, c, term.monomial)),
            }
        }
        Self { polynomials, others }
    }

    /// Reading `f'` [m/s^2] of the ideal specific force `f` [m/s^2].
    #[inline]
    pub fn reading(&self, f: &Vector3<f64>) -> Vector3<f64> {
        let horner = |p: &[f64; DEGREE + 1], x: f64| p.iter().rev().fold(0.0, |sum, c| sum * x + c);
        let along = |i: usize| (0..3).map(|j| horner(&self.polynomials[i][j], f[j])).sum::<f64>();
        let mut reading = Vector3::new(along(0), along(1), along(2));
        for (axis, c, monomial) in &self.others {
            reading[*axis] += c * monomial.value((*f).into());
        }
        reading
    }
}
