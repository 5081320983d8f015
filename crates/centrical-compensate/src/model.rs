//! The error model as the iteration needs it: the fast form, and the terms that do not fit it, for many readings.

use crate::separable::{Separable, is_separable};
use crate::term::Term;
use crate::vectors::lanes::Lanes;

/// An error model by form: its fast form, and whether that is all. The terms come with each call.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Model {
    pub separable: Separable,
    /// Whether all terms fit the fast form.
    is_fast: bool,
}

/// What the terms that do not fit the fast form add to the errors of `W` readings and to the columns of their gains.
pub(crate) struct Others<const W: usize> {
    pub error: Lanes<W>,
    pub gain: [Lanes<W>; 3],
}

impl Model {
    pub fn new(terms: &[Term]) -> Self {
        Self { separable: Separable::part_of(terms), is_fast: terms.iter().all(is_separable) }
    }

    /// Whether all terms fit the fast form.
    pub fn is_fast(&self) -> bool {
        self.is_fast
    }
}

/// What the terms that do not fit the fast form add to the errors at `f`, term by term, each for all lanes at once.
#[inline(always)]
pub(crate) fn others_error<const W: usize>(terms: &[Term], f: &Lanes<W>) -> Lanes<W> {
    let mut error = Lanes::ZERO;
    for term in others_terms(terms) {
        term.add_value(f, &mut error);
    }
    error
}

/// The same, and what they add to the gains.
#[inline(always)]
pub(crate) fn others<const W: usize>(terms: &[Term], f: &Lanes<W>) -> Others<W> {
    let mut others = Others { error: others_error(terms, f), gain: [Lanes::ZERO; 3] };
    for term in others_terms(terms) {
        term.add_gradient(f, &mut others.gain);
    }
    others
}

fn others_terms(terms: &[Term]) -> impl Iterator<Item = &Term> {
    terms.iter().filter(|term| !is_separable(term))
}
