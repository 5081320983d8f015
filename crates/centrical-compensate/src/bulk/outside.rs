//! What forms of bulk share: their pieces, and the count of readings without an answer.

use crate::error::UnequalLengths;

/// Readings of a bulk that are out of a range. Those that no specific force within the range of a compensation gives are NaN on all
/// axes afterwards.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Outside {
    /// How many.
    pub count: usize,
    /// Index of the first.
    pub first: Option<usize>,
}

/// Whether arrays of the axes have one length.
pub(super) fn check(f: [&[f64]; 3]) -> Result<(), UnequalLengths> {
    let lengths = f.map(<[f64]>::len);
    if lengths[0] == lengths[1] && lengths[1] == lengths[2] { Ok(()) } else { Err(UnequalLengths { lengths }) }
}

/// Readings worked on together: long enough for any vectors, short enough to stay in the first-level cache.
pub(crate) const LANES: usize = 64;

/// Readings in a task: 384 KiB, some tenths of a millisecond.
#[cfg(feature = "std")]
pub(crate) const TASK: usize = 16 * 1024;

impl Outside {
    /// Readings with a component beyond the limit of its axis [m/s^2], given as an array for each axis. NaN is beyond no limit.
    ///
    /// # Errors
    /// [`UnequalLengths`] when the arrays are not of one length.
    pub fn beyond(limit: [f64; 3], f: [&[f64]; 3]) -> Result<Self, UnequalLengths> {
        check(f)?;
        // Each axis is counted in vectors first: readings beyond a limit are rare.
        let is_any = (0..3).any(|axis| f[axis].iter().filter(|f| f.abs() > limit[axis]).count() > 0);
        let is_beyond = |k: &usize| (0..3).any(|axis| f[axis][*k].abs() > limit[axis]);
        let mut beyond = (0..if is_any { f[0].len() } else { 0 }).filter(is_beyond).peekable();
        Ok(Self { first: beyond.peek().copied(), count: beyond.count() })
    }

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
