//! The affine part of the error model and its inverse, and the algebra of three dimensions.

use crate::term::Term;
use crate::vectors::fused::{cross, dot, fused};

/// `f' = A f + b`: the reading without its non-linear terms, and `C = A^-1`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Linear {
    /// `b` [m/s^2].
    pub bias: [f64; 3],
    /// `A`, by rows.
    pub gain: [[f64; 3]; 3],
    /// `C`, by rows.
    pub inverse: [[f64; 3]; 3],
}

impl Linear {
    /// The affine part of the model with `terms`; none if its gain has no finite inverse.
    pub(crate) fn of(terms: &[Term]) -> Option<Self> {
        let mut bias = [0.0; 3];
        let mut gain = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for term in terms {
            match term.monomial.as_power() {
                Some((_, 0)) => bias[term.axis] += term.coefficient,
                Some((j, 1)) => gain[term.axis][j] += term.coefficient,
                _ => {}
            }
        }
        let [a, b, c] = gain;
        // The columns of the inverse are the cross products of the rows over the determinant.
        let (bc, ca, ab) = (cross(b, c), cross(c, a), cross(a, b));
        let determinant = dot(a, bc);
        let inverse = [0, 1, 2].map(|i| [bc[i] / determinant, ca[i] / determinant, ab[i] / determinant]);
        inverse.as_flattened().iter().all(|c| c.is_finite()).then_some(Self { bias, gain, inverse })
    }

    /// `C d`.
    #[inline(always)]
    pub(crate) fn inverse_times(&self, d: [f64; 3]) -> [f64; 3] {
        self.inverse.map(|row| dot(row, d))
    }
}

/// Whether a term is constant or linear, without a kink.
pub(crate) fn is_affine(term: &Term) -> bool {
    term.monomial.as_power().is_some_and(|(_, power)| power <= 1)
}

/// `x + g^-1 d` by Cramer's rule, `g` given by columns. Accurate enough for a Newton step, which is small beside the error
/// `x` it corrects, and without a branch, so that it goes into vectors. Products are shared: the first unknown is
/// `d . (b x c) = b . (c x d)` over the determinant `a . (b x c) = c . (a x b)`.
#[inline(always)]
pub(crate) fn corrected(x: [f64; 3], g: [[f64; 3]; 3], d: [f64; 3]) -> [f64; 3] {
    let [a, b, c] = g;
    let (ab, cd) = (cross(a, b), cross(c, d));
    let scale = 1.0 / dot(c, ab);
    [fused(dot(b, cd), scale, x[0]), fused(dot(a, cd), -scale, x[1]), fused(dot(d, ab), scale, x[2])]
}
