//! Many readings at once: in place, an array per axis, in vectors and on all cores where there is `std`.

use crate::compensation::Compensation;
use crate::error::UnequalLengths;
use crate::lanes::Lanes;
use crate::machine::on_this_machine;
use crate::term::Term;

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

impl<T: AsRef<[Term]>> Compensation<T> {
    /// Takes readings `f'` [m/s^2], an array per axis, to specific forces [m/s^2] in place. Each becomes what
    /// [`Compensation::apply`] makes of it; where that is an error, NaN on all axes, and it is counted.
    ///
    /// # Errors
    /// [`UnequalLengths`] when the arrays are not of one length; nothing is touched then.
    pub fn apply_all(&self, f: [&mut [f64]; 3]) -> Result<Outside, UnequalLengths> {
        check(&f)?;
        Ok(self.sweep(f))
    }

    /// [`Compensation::apply_all`] on all threads of the current rayon pool. The same bytes for any number of them.
    ///
    /// # Errors
    /// As [`Compensation::apply_all`].
    #[cfg(feature = "std")]
    pub fn apply_all_parallel(&self, f: [&mut [f64]; 3]) -> Result<Outside, UnequalLengths>
    where
        T: Sync,
    {
        use rayon::prelude::*;
        check(&f)?;
        let [f1, f2, f3] = f.map(|f| f.par_chunks_mut(TASK));
        let outside =
            f1.zip(f2).zip(f3).enumerate().map(|(n, ((f1, f2), f3))| self.sweep([f1, f2, f3]).after(n * TASK));
        Ok(outside.reduce(Outside::default, Outside::and))
    }

    fn sweep(&self, f: [&mut [f64]; 3]) -> Outside {
        on_this_machine(
            #[inline(always)]
            || self.sweep_blocks(f),
        )
    }

    #[inline(always)]
    fn sweep_blocks(&self, f: [&mut [f64]; 3]) -> Outside {
        let mut outside = Outside::default();
        let [f1, f2, f3] = f.map(|f| f.as_chunks_mut::<LANES>());
        let rest_from = LANES * f1.0.len();
        let mut lanes = Lanes::ZERO;
        for (n, ((f1, f2), f3)) in f1.0.iter_mut().zip(f2.0).zip(f3.0).enumerate() {
            // One axis after the other: an array of all would be made elsewhere first.
            lanes.0[0] = *f1;
            lanes.0[1] = *f2;
            lanes.0[2] = *f3;
            self.invert(&mut lanes);
            (*f1, *f2, *f3) = (lanes.0[0], lanes.0[1], lanes.0[2]);
            outside = outside.and(Outside::of(&lanes.0[0]).after(n * LANES));
        }
        let rest = [f1.1, f2.1, f3.1];
        lanes = Lanes::ZERO;
        for (lane, f) in lanes.0.iter_mut().zip(&rest) {
            lane[..f.len()].copy_from_slice(f);
        }
        self.invert(&mut lanes);
        outside = outside.and(Outside::of(&lanes.0[0][..rest[0].len()]).after(rest_from));
        for (lane, f) in lanes.0.iter().zip(rest) {
            f.copy_from_slice(&lane[..f.len()]);
        }
        outside
    }
}

impl Outside {
    pub(crate) fn of(f: &[f64]) -> Self {
        let count = f.iter().filter(|f| f.is_nan()).count();
        Self { count, first: if count > 0 { f.iter().position(|f| f.is_nan()) } else { None } }
    }

    /// The same, of readings that come after `earlier` others.
    pub(crate) fn after(self, earlier: usize) -> Self {
        Self { first: self.first.map(|first| first + earlier), ..self }
    }

    /// These and later ones.
    pub(crate) fn and(self, later: Self) -> Self {
        Self { count: self.count + later.count, first: self.first.or(later.first) }
    }
}

fn check(f: &[&mut [f64]; 3]) -> Result<(), UnequalLengths> {
    let lengths = [f[0].len(), f[1].len(), f[2].len()];
    if lengths[0] == lengths[1] && lengths[1] == lengths[2] { Ok(()) } else { Err(UnequalLengths { lengths }) }
}
