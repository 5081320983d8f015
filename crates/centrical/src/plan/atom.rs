//! Atoms: what a plan visits.
//!
//! A *candidate* is a set point that a plan may use, by its index among [`crate::Experiment::set_points`]. An *atom* is a
//! candidate with one of the *durations*. A *visit* is one stay at it; a continuous design and a schedule say how often each
//! atom is visited, the one in any parts, the other in whole numbers, as a list by the number of the atom.

use std::ops::Range;

/// A candidate with one of the durations, both as indices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Atom {
    pub candidate: usize,
    pub duration: usize,
}

/// All atoms, numbered candidate by candidate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Atoms {
    pub candidates: usize,
    pub durations: usize,
}

impl Atoms {
    /// How many there are.
    pub fn count(self) -> usize {
        self.candidates * self.durations
    }

    /// The number of an atom.
    pub fn number(self, atom: Atom) -> usize {
        atom.candidate * self.durations + atom.duration
    }

    /// The atom of a number.
    pub fn at(self, number: usize) -> Atom {
        Atom { candidate: number / self.durations, duration: number % self.durations }
    }

    /// Numbers of the atoms of a candidate.
    pub fn of(self, candidate: usize) -> Range<usize> {
        candidate * self.durations..(candidate + 1) * self.durations
    }
}
