//! The fast form: errors that are sums of cubics in one component each, as the source's model is [K4.2].

use crate::term::Term;
use crate::vectors::fused::{dot, fused};

/// `E_i(f) = b_i + sum_j (g1_ij f_j + g0_ij) f_j + g2_i f_i^3`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Separable {
    bias: [f64; 3],
    g0: [[f64; 3]; 3],
    g1: [[f64; 3]; 3],
    g2: [f64; 3],
}

impl Separable {
    /// Those of the terms that fit: neither odd, nor a product of components, nor above the third degree.
    pub fn part_of(terms: &[Term]) -> Self {
        let mut part = Self { bias: [0.0; 3], g0: [[0.0; 3]; 3], g1: [[0.0; 3]; 3], g2: [0.0; 3] };
        for term in terms.iter().filter(|term| is_separable(term)) {
            let Term { axis: i, monomial, coefficient } = *term;
            match monomial.as_power() {
                Some((_, 0)) => part.bias[i] += coefficient,
                Some((j, 1)) => part.g0[i][j] += coefficient,
                Some((j, 2)) => part.g1[i][j] += coefficient,
                _ => part.g2[i] += coefficient,
            }
        }
        part
    }

    /// `E(f) - e` [m/s^2], and the columns of the gain `I + dE/df`.
    #[inline(always)]
    pub fn misfit_and_gain(&self, f: [f64; 3], e: [f64; 3]) -> ([f64; 3], [[f64; 3]; 3]) {
        let mut misfit = [0, 1, 2].map(|i| self.bias[i] - e[i]);
        let mut columns = [[0.0; 3]; 3];
        for i in 0..3 {
            for j in 0..3 {
                let (g0, g1) = (self.g0[i][j], self.g1[i][j]);
                if i == j {
                    let g2 = self.g2[i];
                    misfit[i] = fused(fused(fused(g2, f[j], g1), f[j], g0), f[j], misfit[i]);
                    columns[j][i] = fused(fused(3.0 * g2, f[j], 2.0 * g1), f[j], 1.0 + g0);
                } else {
                    let chord = fused(g1, f[j], g0);
                    misfit[i] = fused(chord, f[j], misfit[i]);
                    columns[j][i] = fused(g1, f[j], chord);
                }
            }
        }
        (misfit, columns)
    }

    /// What a fixed-point step takes off, for the inverse `C` of the gain at zero.
    pub fn shift(&self, inverse: &[[f64; 3]; 3]) -> Shift {
        let mut shift = Shift { square: [[0.0; 3]; 3], cube: [[0.0; 3]; 3] };
        for i in 0..3 {
            for j in 0..3 {
                shift.square[i][j] = dot(inverse[i], [0, 1, 2].map(|k| self.g1[k][j]));
                shift.cube[i][j] = inverse[i][j] * self.g2[j];
            }
        }
        shift
    }
}

/// `C N(f)`, the quadratic and cubic terms as the inverse of the gain at zero takes them: in component `i`
/// `sum_j (square_ij + cube_ij f_j) f_j^2`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Shift {
    square: [[f64; 3]; 3],
    cube: [[f64; 3]; 3],
}

impl Shift {
    /// `start - C N(f)` [m/s^2].
    #[inline(always)]
    pub fn step(&self, start: [f64; 3], f: [f64; 3]) -> [f64; 3] {
        let square = f.map(|f| f * f);
        let mut next = start;
        for i in 0..3 {
            for j in 0..3 {
                next[i] = fused(-fused(self.cube[i][j], f[j], self.square[i][j]), square[j], next[i]);
            }
        }
        next
    }
}

/// Whether a term fits the fast form.
pub(crate) fn is_separable(term: &Term) -> bool {
    term.monomial.as_power().is_some_and(|(j, power)| power <= 2 || (j == term.axis && power == 3))
}
