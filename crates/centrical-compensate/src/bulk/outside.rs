//! What forms of bulk share: their pieces, and the count of readings without an answer.

/// Readings of a bulk that no specific force within the range gives; they are NaN on all axes afterwards.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Outside {
    /// How many.
    pub count: usize,
    /// Index of the first.
    pub first: Option<usize>,
}

/// Readings worked on together: long enough for any vectors, short enough to stay in the first-level cache.
pub(crate) const LANES: usize = 64;

/// Readings in a task: 384 KiB, some tenths of a millisecond.
#[cfg(feature = "std")]
pub(crate) const TASK: usize = 16 * 1024;

impl Outside {
    pub(super) fn of(f: &[f64]) -> Self {
        let count = f.iter().filter(|f| f.is_nan()).count();
        Self { count, first: if count > 0 { f.iter().position(|f| f.is_nan()) } else { None } }
    }

    /// The same, of readings that come after `earlier` others.
    pub(super) fn after(self, earlier: usize) -> Self {
        Self { first: self.first.map(|first| first + earlier), ..self }
    }

    /// These and later ones.
    pub(super) fn and(self, later: Self) -> Self {
        Self { count: self.count + later.count, first: self.first.or(later.first) }
    }
}
