//! The error model as this crate has it: monomial terms with their coefficients.

use crate::lanes::Lanes;

/// `c f1^p1 f2^p2 f3^p3` on one axis, with the sign of a component if the term is odd: `c |f1| f1`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Term {
    /// Newtonometer it acts on, 0 to 2.
    pub axis: usize,
    /// Powers of `f1, f2, f3`.
    pub powers: [u8; 3],
    /// Component whose sign it takes, 0 to 2. Zero counts as positive.
    pub sign_of: Option<usize>,
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
        error[term.axis] += term.value(f);
    }
    [f[0] + error[0], f[1] + error[1], f[2] + error[2]]
}

impl Term {
    /// `c f_of^power` on `axis`; the bias with `power` 0.
    ///
    /// # Panics
    /// If `of` is not 0, 1 or 2.
    pub const fn power(axis: usize, of: usize, power: u8, coefficient: f64) -> Self {
        let mut powers = [0; 3];
        powers[of] = power;
        Self { axis, powers, sign_of: None, coefficient }
    }

    /// Sum of the powers.
    pub fn degree(&self) -> u32 {
        self.powers.iter().map(|p| u32::from(*p)).sum()
    }

    /// Value at `f` [m/s^2].
    pub fn value(&self, f: [f64; 3]) -> f64 {
        self.signed_coefficient(f) * product(f, self.powers)
    }

    /// Derivatives by `f1, f2, f3` at `f`; at a kink, those of the positive side.
    pub fn gradient(&self, f: [f64; 3]) -> [f64; 3] {
        let c = self.signed_coefficient(f);
        let mut gradient = [0.0; 3];
        for j in 0..3 {
            if self.powers[j] > 0 {
                let mut lower = self.powers;
                lower[j] -= 1;
                gradient[j] = c * f64::from(self.powers[j]) * product(f, lower);
            }
        }
        gradient
    }

    /// Adds the term at `f` to errors.
    #[inline(always)]
    pub(crate) fn add_value<const W: usize>(&self, f: &Lanes<W>, error: &mut Lanes<W>) {
        add(&self.monomials(self.coefficient, self.powers, f), &mut error.0[self.axis]);
    }

    /// Adds its derivatives at `f` to the columns of gains; at a kink, those of the positive side.
    #[inline(always)]
    pub(crate) fn add_gradient<const W: usize>(&self, f: &Lanes<W>, columns: &mut [Lanes<W>; 3]) {
        for j in 0..3 {
            if let Some(power) = self.powers[j].checked_sub(1) {
                let mut lower = self.powers;
                lower[j] = power;
                let coefficient = f64::from(self.powers[j]) * self.coefficient;
                add(&self.monomials(coefficient, lower, f), &mut columns[j].0[self.axis]);
            }
        }
    }

    /// `c f1^p1 f2^p2 f3^p3`, and the term's sign, in each lane.
    #[inline(always)]
    fn monomials<const W: usize>(&self, c: f64, powers: [u8; 3], f: &Lanes<W>) -> [f64; W] {
        let mut products = match self.sign_of {
            None => [c; W],
            Some(j) => f.0[j].map(|f| if f < 0.0 { -c } else { c }),
        };
        for (f, power) in f.0.iter().zip(powers) {
            for _ in 0..power {
                for w in 0..W {
                    products[w] *= f[w];
                }
            }
        }
        products
    }

    /// Largest magnitude over the cube `|f_j| <= h`: at its corners.
    pub(crate) fn largest(&self, h: f64) -> f64 {
        self.coefficient.abs() * product([h; 3], self.powers)
    }

    fn signed_coefficient(&self, f: [f64; 3]) -> f64 {
        if self.sign_of.is_some_and(|j| f[j] < 0.0) { -self.coefficient } else { self.coefficient }
    }
}

/// `f1^p1 f2^p2 f3^p3`.
fn product(f: [f64; 3], powers: [u8; 3]) -> f64 {
    let mut product = 1.0;
    for (x, power) in f.into_iter().zip(powers) {
        for _ in 0..power {
            product *= x;
        }
    }
    product
}

#[inline(always)]
fn add<const W: usize>(more: &[f64; W], sum: &mut [f64; W]) {
    for w in 0..W {
        sum[w] += more[w];
    }
}
