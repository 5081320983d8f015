//! The error model with its coefficients: monomial terms, each on one axis.

use crate::monomial::Monomial;
use crate::vectors::lanes::Lanes;

/// `c m(f)` on one axis, `m` a monomial.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Term {
    /// Newtonometer it acts on, 0 to 2.
    pub axis: usize,
    /// `m`.
    pub monomial: Monomial,
    /// `c`, SI: m/s^2 per (m/s^2)^degree.
    pub coefficient: f64,
}

/// Reading `f' = f + E(f)` [m/s^2] of the specific force `f` [m/s^2].
///
/// # Panics
/// If a term acts on an axis that is not 0, 1 or 2; [`crate::Compensation::new`] refuses such terms.
pub fn reading(terms: &[Term], f: [f64; 3]) -> [f64; 3] {
    let mut error = [0.0; 3];
    for term in terms {
        error[term.axis] += term.coefficient * term.monomial.value(f);
    }
    [f[0] + error[0], f[1] + error[1], f[2] + error[2]]
}

/// Gain `d f' / d f`, by rows, at the specific force `f` [m/s^2]; at a kink, that of the positive side.
///
/// # Panics
/// As [`reading`].
pub fn gain(terms: &[Term], f: [f64; 3]) -> [[f64; 3]; 3] {
    let mut gain = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for term in terms {
        for (entry, derivative) in gain[term.axis].iter_mut().zip(term.monomial.gradient(f)) {
            *entry += derivative * term.coefficient;
        }
    }
    gain
}

impl Term {
    /// `c f_of^power` on `axis`; the bias with `power` 0.
    ///
    /// # Panics
    /// If `of` is not 0, 1 or 2.
    pub const fn power(axis: usize, of: usize, power: u8, coefficient: f64) -> Self {
        Self { axis, monomial: Monomial::power(of, power), coefficient }
    }

    /// Adds the term at `f` to errors.
    #[inline(always)]
    pub(crate) fn add_value<const W: usize>(&self, f: &Lanes<W>, error: &mut Lanes<W>) {
        add(&self.monomial.values(self.coefficient, f), &mut error.0[self.axis]);
    }

    /// Adds its derivatives at `f` to the columns of gains; at a kink, those of the positive side.
    #[inline(always)]
    pub(crate) fn add_gradient<const W: usize>(&self, f: &Lanes<W>, columns: &mut [Lanes<W>; 3]) {
        for j in 0..3 {
            if let Some((factor, lower)) = self.monomial.derivative(j) {
                add(&lower.values(factor * self.coefficient, f), &mut columns[j].0[self.axis]);
            }
        }
    }

    /// Largest magnitude over the cube `|f_j| <= h`: at its corners.
    pub(crate) fn largest(&self, h: f64) -> f64 {
        (self.coefficient * self.monomial.value([h; 3])).abs()
    }
}

#[inline(always)]
fn add<const W: usize>(more: &[f64; W], sum: &mut [f64; W]) {
    for w in 0..W {
        sum[w] += more[w];
    }
}
