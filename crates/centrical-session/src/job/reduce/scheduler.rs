//! Which mountings are reduced side by side.

use std::sync::atomic::{AtomicUsize, Ordering};

use centrical::OnProgress;
use centrical_table::estimate_rows;
use rayon::prelude::*;

use super::mounting::{OfRecord, reduce_mounting};
use crate::error::Error;
use crate::experiment::Session;
use crate::record::{MemoryBudget, SampleCache};

/// A mounting's number, and its plateaus or why they are missing.
type Numbered = (usize, Result<OfRecord, Error>);

/// Hands out the mountings of a session in their order, to as many lanes as their samples fit into memory.
pub(super) struct Scheduler<'a> {
    session: &'a Session,
    progress: OnProgress<'a>,
    budget: MemoryBudget,
    /// The next mounting.
    next: AtomicUsize,
}

impl<'a> Scheduler<'a> {
    /// Begins with the first mounting.
    pub fn new(session: &'a Session, progress: OnProgress<'a>) -> Self {
        Self { session, progress, budget: MemoryBudget::default(), next: AtomicUsize::new(0) }
    }

    /// Reduces all mountings. Where the files do not show their length, the first record is read on all threads, and shows it.
    pub fn run(&self) -> Result<Vec<OfRecord>, Error> {
        let mut done = Vec::new();
        let lanes = match (mountings_in_flight(), self.estimate_samples()) {
            (1, _) => 1,
            (most, Some(samples)) => self.budget.capacity(samples).min(most),
            (most, None) => {
                let mut cache = SampleCache::new(&self.budget);
                done.extend(self.reduce_next(&mut cache));
                cache.capacity().min(most)
            }
        };
        done.par_extend((0..lanes).into_par_iter().flat_map_iter(|_| self.lane()));
        done.sort_by_key(|(number, _)| *number);
        done.into_iter().map(|(_, reduced)| reduced).collect()
    }

    /// Reduces one mounting after the other, with the same memory, to the last.
    fn lane(&self) -> Vec<Numbered> {
        let mut cache = SampleCache::new(&self.budget);
        std::iter::from_fn(|| self.reduce_next(&mut cache)).collect()
    }

    /// Reduces the next mounting; none after the last.
    fn reduce_next(&self, cache: &mut SampleCache) -> Option<Numbered> {
        let count = self.session.mountings.len();
        let number = self.next.fetch_add(1, Ordering::Relaxed);
        let reduced = (number < count).then(|| reduce_mounting(self.session, number, self.progress, cache))?;
        if reduced.is_err() {
            // Those before it are in flight: which error is the first does not depend on the threads.
            self.next.store(count, Ordering::Relaxed);
        }
        Some((number, reduced))
    }

    /// Samples of the longest record, if all files show them.
    fn estimate_samples(&self) -> Option<u64> {
        let numbers = 0..self.session.mountings.len();
        let rows = |number| estimate_rows(self.session.open_record(number).ok()?.first()?);
        let samples = numbers.map(rows);
        samples.collect::<Option<Vec<_>>>()?.into_iter().max()
    }
}

/// Mountings reduced at a time: while one is searched for its plateaus, which threads cannot share well, the other is
/// read. Per-thread buffers grow with the thread count; above two threads only one mounting fits.
fn mountings_in_flight() -> usize {
    if rayon::current_num_threads() > 2 { 1 } else { 2 }
}
