//! Many readings at once as an array for each axis.

use super::outside::{LANES, Outside, check};
use crate::compensation::Compensation;
use crate::error::UnequalLengths;
use crate::inverse::Inverse;
use crate::term::Term;
use crate::vectors::lanes::Lanes;
use crate::vectors::machine::on_this_machine;

impl<T: AsRef<[Term]>> Compensation<T> {
    /// Takes readings `f'` [m/s^2], an array per axis, to specific forces [m/s^2] in place. Each becomes what
    /// [`Compensation::apply`] makes of it; where that is an error, NaN on all axes, and it is counted.
    ///
    /// # Errors
    /// [`UnequalLengths`] when the arrays are not of one length; nothing is touched then.
    pub fn apply_all(&self, f: [&mut [f64]; 3]) -> Result<Outside, UnequalLengths> {
        check(f.each_ref().map(|f| &**f))?;
        Ok(self.inverse.sweep(self.terms(), f))
    }

    /// [`Compensation::apply_all`] on all threads of the current rayon pool. The same bytes for any number of them.
    ///
    /// # Errors
    /// As [`Compensation::apply_all`].
    #[cfg(feature = "std")]
    pub fn apply_all_parallel(&self, f: [&mut [f64]; 3]) -> Result<Outside, UnequalLengths> {
        check(f.each_ref().map(|f| &**f))?;
        Ok(self.inverse.sweep_parallel(self.terms(), f))
    }
}

impl Inverse {
    fn sweep(&self, terms: &[Term], f: [&mut [f64]; 3]) -> Outside {
        on_this_machine(
            #[inline(always)]
            || self.sweep_blocks(terms, f),
        )
    }

    #[cfg(feature = "std")]
    fn sweep_parallel(&self, terms: &[Term], f: [&mut [f64]; 3]) -> Outside {
        use super::outside::TASK;
        use rayon::prelude::*;
        let [f1, f2, f3] = f.map(|f| f.par_chunks_mut(TASK));
        let outside =
            f1.zip(f2).zip(f3).enumerate().map(|(n, ((f1, f2), f3))| self.sweep(terms, [f1, f2, f3]).after(n * TASK));
        outside.reduce(Outside::default, Outside::and)
    }

    #[inline(always)]
    fn sweep_blocks(&self, terms: &[Term], f: [&mut [f64]; 3]) -> Outside {
        let mut outside = Outside::default();
        let [f1, f2, f3] = f.map(|f| f.as_chunks_mut::<LANES>());
        let rest_from = LANES * f1.0.len();
        let mut lanes = Lanes::ZERO;
        for (n, ((f1, f2), f3)) in f1.0.iter_mut().zip(f2.0).zip(f3.0).enumerate() {
            // One axis after the other: an array of all would be made elsewhere first.
            lanes.0[0] = *f1;
            lanes.0[1] = *f2;
            lanes.0[2] = *f3;
            self.invert(terms, &mut lanes);
            (*f1, *f2, *f3) = (lanes.0[0], lanes.0[1], lanes.0[2]);
            outside = outside.and(Outside::of(&lanes.0[0]).after(n * LANES));
        }
        let rest = [f1.1, f2.1, f3.1];
        lanes = Lanes::ZERO;
        for (lane, f) in lanes.0.iter_mut().zip(&rest) {
            lane[..f.len()].copy_from_slice(f);
        }
        self.invert(terms, &mut lanes);
        outside = outside.and(Outside::of(&lanes.0[0][..rest[0].len()]).after(rest_from));
        for (lane, f) in lanes.0.iter().zip(rest) {
            f.copy_from_slice(&lane[..f.len()]);
        }
        outside
    }
}
