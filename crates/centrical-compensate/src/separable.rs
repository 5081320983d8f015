//! The fast form: errors that are sums of cubics in one component each, as the source's model is [K4.2].

use crate::term::Term;

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
            let (i, j) = (term.axis, term.powers.iter().position(|p| *p > 0).unwrap_or(0));
            match term.degree() {
                0 => part.bias[i] += term.coefficient,
                1 => part.g0[i][j] += term.coefficient,
                2 => part.g1[i][j] += term.coefficient,
                _ => part.g2[i] += term.coefficient,
            }
        }
        part
    }

    /// `N(f)`: the quadratic and cubic terms [m/s^2].
    #[inline(always)]
    pub fn nonlinear(&self, f: [f64; 3]) -> [f64; 3] {
        let square = f.map(|f| f * f);
        [0, 1, 2].map(|i| {
            let mut g1 = self.g1[i];
            g1[i] += self.g2[i] * f[i];
            g1[0] * square[0] + g1[1] * square[1] + g1[2] * square[2]
        })
    }

    /// `E(f)` [m/s^2], and the columns of the gain `I + dE/df`.
    #[inline(always)]
    pub fn error_and_gain(&self, f: [f64; 3]) -> ([f64; 3], [[f64; 3]; 3]) {
        let mut error = self.bias;
        let mut columns = [[0.0; 3]; 3];
        for i in 0..3 {
            for j in 0..3 {
                let (g0, g1) = (self.g0[i][j], self.g1[i][j]);
                if i == j {
                    let g2 = self.g2[i];
                    error[i] += ((g2 * f[j] + g1) * f[j] + g0) * f[j];
                    columns[j][i] = (3.0 * g2 * f[j] + 2.0 * g1) * f[j] + (1.0 + g0);
                } else {
                    let slope = g1 * f[j];
                    let chord = slope + g0;
                    error[i] += chord * f[j];
                    columns[j][i] = chord + slope;
                }
            }
        }
        (error, columns)
    }
}

/// Whether a term fits the fast form.
pub(crate) fn is_separable(term: &Term) -> bool {
    let components = term.powers.iter().filter(|p| **p > 0).count();
    let is_cubic = term.powers[term.axis] == 3;
    term.sign_of.is_none() && components <= 1 && (term.degree() <= 2 || (is_cubic && term.degree() == 3))
}
