//! Compensation of one error model, as others call it.

use crate::certificate::Certificate;
use crate::error::{NotInvertible, OutOfRange};
use crate::inverse::Inverse;
use crate::linear::Linear;
use crate::monomial::Monomial;
use crate::term::Term;

/// The inverse of an error model over a range; its terms are borrowed, `&[Term]`, or its own, `Vec<Term>`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compensation<T> {
    pub(crate) inverse: Inverse,
    terms: T,
}

impl<T: AsRef<[Term]>> Compensation<T> {
    /// The inverse of `f' = f + E(f)`, `E` the sum of `terms`, for all `f` with `|f_i| <= range` [m/s^2].
    ///
    /// # Errors
    /// [`NotInvertible`] when a term makes no sense, the gain at zero is singular, or the non-linear terms are too
    /// strong for an inverse that is certainly unique: then it is said over which part of the range it is.
    pub fn new(terms: T, range: f64) -> Result<Self, NotInvertible> {
        check(terms.as_ref(), range)?;
        Ok(Self { inverse: Inverse::new(terms.as_ref(), range)?, terms })
    }

    /// The same with specific forces in other axes: `c_zb`, a rotation by its rows, takes coordinates there to coordinates in
    /// instrument axes, so that `f_b = c_zb^T f_z`. The range stays one of the instrument axes.
    #[must_use]
    pub fn in_axes(self, c_zb: [[f64; 3]; 3]) -> Self {
        Self { inverse: self.inverse.in_axes(c_zb), ..self }
    }

    /// The rotation to instrument axes from those of the specific forces, if these are others.
    pub fn axes(&self) -> Option<&[[f64; 3]; 3]> {
        self.inverse.axes.as_ref()
    }

    /// What was shown of the inverse.
    pub fn certificate(&self) -> &Certificate {
        &self.inverse.certificate
    }

    /// The affine part of the error model, where the iteration starts.
    pub fn linear(&self) -> &Linear {
        &self.inverse.linear
    }

    /// Specific force `f` [m/s^2] whose reading is `reading` [m/s^2].
    ///
    /// # Errors
    /// [`OutOfRange`] when no `f` of the range has this reading.
    pub fn apply(&self, reading: [f64; 3]) -> Result<[f64; 3], OutOfRange> {
        self.inverse.apply(self.terms(), reading)
    }

    /// The terms.
    pub fn terms(&self) -> &[Term] {
        self.terms.as_ref()
    }
}

fn check(terms: &[Term], range: f64) -> Result<(), NotInvertible> {
    for (index, term) in terms.iter().enumerate() {
        let Monomial { powers, sign_of } = term.monomial;
        for axis in [Some(term.axis), sign_of].into_iter().flatten() {
            if axis > 2 {
                return Err(NotInvertible::Axis { term: index, axis });
            }
        }
        if !term.coefficient.is_finite() {
            return Err(NotInvertible::Coefficient { term: index, coefficient: term.coefficient });
        }
        if let Some(axis) = sign_of.filter(|j| powers[*j] == 0) {
            return Err(NotInvertible::Jump { term: index, axis });
        }
    }
    if range > 0.0 && range.is_finite() { Ok(()) } else { Err(NotInvertible::Range { range }) }
}
