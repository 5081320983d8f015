//! Many readings at once as rows of three, as arrays of shape `(n, 3)` have them.

use super::outside::{LANES, Outside};
use crate::compensation::Compensation;
use crate::error::UnequalRows;
use crate::inverse::Inverse;
use crate::term::Term;
use crate::vectors::lanes::Lanes;
use crate::vectors::machine::on_this_machine;

impl<T: AsRef<[Term]>> Compensation<T> {
    /// Takes readings `f'` [m/s^2], a row of three each, to specific forces [m/s^2] in place. Each becomes what
    /// [`Compensation::apply`] makes of it; where that is an error, NaN on all axes, and it is counted.
    pub fn apply_rows(&self, f: &mut [[f64; 3]]) -> Outside {
        self.inverse.sweep_in_place(self.terms(), f)
    }

    /// The same from `readings` to `forces`.
    ///
    /// # Errors
    /// [`UnequalRows`] when they are not of one length; nothing is touched then.
    pub fn apply_rows_to(&self, readings: &[[f64; 3]], forces: &mut [[f64; 3]]) -> Result<Outside, UnequalRows> {
        check(readings, forces)?;
        Ok(self.inverse.sweep_to(self.terms(), readings, forces))
    }

    /// [`Compensation::apply_rows_to`] on all threads of the current rayon pool. The same bytes for any number of them.
    ///
    /// # Errors
    /// As [`Compensation::apply_rows_to`].
    #[cfg(feature = "std")]
    pub fn apply_rows_to_parallel(
        &self,
        readings: &[[f64; 3]],
        forces: &mut [[f64; 3]],
    ) -> Result<Outside, UnequalRows> {
        check(readings, forces)?;
        Ok(self.inverse.sweep_to_parallel(self.terms(), readings, forces))
    }
}

impl Inverse {
    fn sweep_in_place(&self, terms: &[Term], f: &mut [[f64; 3]]) -> Outside {
        on_this_machine(
            #[inline(always)]
            || self.sweep_rows(terms, None, f),
        )
    }

    fn sweep_to(&self, terms: &[Term], readings: &[[f64; 3]], forces: &mut [[f64; 3]]) -> Outside {
        on_this_machine(
            #[inline(always)]
            || self.sweep_rows(terms, Some(readings), forces),
        )
    }

    #[cfg(feature = "std")]
    fn sweep_to_parallel(&self, terms: &[Term], readings: &[[f64; 3]], forces: &mut [[f64; 3]]) -> Outside {
        use super::outside::TASK;
        use rayon::prelude::*;
        let tasks = readings.par_chunks(TASK).zip(forces.par_chunks_mut(TASK)).enumerate();
        let outside = tasks.map(|(n, (readings, forces))| self.sweep_to(terms, readings, forces).after(n * TASK));
        outside.reduce(Outside::default, Outside::and)
    }

    /// From the `readings`, or from what stands in `f`, to `f`.
    #[inline(always)]
    fn sweep_rows(&self, terms: &[Term], readings: Option<&[[f64; 3]]>, f: &mut [[f64; 3]]) -> Outside {
        let mut outside = Outside::default();
        for (n, f) in f.chunks_mut(LANES).enumerate() {
            let first = n * LANES;
            let mut lanes = Lanes::<LANES>::ZERO;
            let readings = readings.map_or(&*f, |readings| &readings[first..first + f.len()]);
            for (w, reading) in readings.iter().enumerate() {
                lanes.put(w, *reading);
            }
            self.invert(terms, &mut lanes);
            for (w, f) in f.iter_mut().enumerate() {
                *f = lanes.at(w);
            }
            outside = outside.and(Outside::of(&lanes.0[0][..f.len()]).after(first));
        }
        outside
    }
}

fn check(readings: &[[f64; 3]], forces: &[[f64; 3]]) -> Result<(), UnequalRows> {
    let (readings, forces) = (readings.len(), forces.len());
    if readings == forces { Ok(()) } else { Err(UnequalRows { readings, forces }) }
}
