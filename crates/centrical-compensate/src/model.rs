//! The error model as the iteration needs it: the fast form, and the terms that do not fit it, for many readings.

use crate::lanes::Lanes;
use crate::separable::{Separable, is_separable};
use crate::term::Term;

/// An error model, its terms sorted by form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Model<T> {
    pub separable: Separable,
    terms: T,
    /// Whether all terms fit the fast form.
    is_fast: bool,
}

/// What the terms that do not fit the fast form add to the errors of `W` readings and to the columns of their gains.
pub(crate) struct Others<const W: usize> {
    pub error: Lanes<W>,
    pub gain: [Lanes<W>; 3],
}

impl<T: AsRef<[Term]>> Model<T> {
    pub fn new(terms: T) -> Self {
        let is_fast = terms.as_ref().iter().all(is_separable);
        Self { separable: Separable::part_of(terms.as_ref()), terms, is_fast }
    }

    /// Whether all terms fit the fast form.
    pub fn is_fast(&self) -> bool {
        self.is_fast
    }

    /// What the other terms add to the errors at `f`, term by term, each for all lanes at once.
    #[inline(always)]
    pub fn others_error<const W: usize>(&self, f: &Lanes<W>) -> Lanes<W> {
        let mut error = Lanes::ZERO;
        for term in self.others_terms() {
            term.add_value(f, &mut error);
        }
        error
    }

    /// The same, and what they add to the gains.
    #[inline(always)]
    pub fn others<const W: usize>(&self, f: &Lanes<W>) -> Others<W> {
        let mut others = Others { error: self.others_error(f), gain: [Lanes::ZERO; 3] };
        for term in self.others_terms() {
            term.add_gradient(f, &mut others.gain);
        }
        others
    }

    fn others_terms(&self) -> impl Iterator<Item = &Term> {
        self.terms.as_ref().iter().filter(|term| !is_separable(term))
    }
}
