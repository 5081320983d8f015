//! The error model as the iteration needs it: the fast form, and the terms that do not fit it, for many readings.

use crate::lanes::Lanes;
use crate::separable::{Separable, is_separable};
use crate::term::Term;

/// An error model, its terms sorted by form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Model<'t> {
    pub separable: Separable,
    /// All terms, if some do not fit the fast form; else none.
    terms: &'t [Term],
}

/// What the terms that do not fit the fast form add to the errors of `W` readings and to the columns of their gains.
pub(crate) struct Others<const W: usize> {
    pub error: Lanes<W>,
    pub gain: [Lanes<W>; 3],
}

impl<'t> Model<'t> {
    pub fn new(terms: &'t [Term]) -> Self {
        let is_fast = terms.iter().all(is_separable);
        Self { separable: Separable::part_of(terms), terms: if is_fast { &[] } else { terms } }
    }

    /// Whether all terms fit the fast form.
    pub fn is_fast(&self) -> bool {
        self.terms.is_empty()
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

    fn others_terms(&self) -> impl Iterator<Item = &'t Term> {
        self.terms.iter().filter(|term| !is_separable(term))
    }
}
