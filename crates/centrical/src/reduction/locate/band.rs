//! The best path of a record through a long schedule, in time and memory that grow with the record and not with the schedule too.
//!
//! Every plateau is a steady stretch of the record. Of `N` plateaus and `S` stretches, number `N s / S` is expected in the block
//! before which `s` stretches have ended, and a block is asked for the plateaus near that number alone. Stretches that nobody
//! scheduled, and plateaus that do not look steady, lead away from it: the band is widened until the path keeps clear of its edges.
//! A record that lacks a plateau is always searched as a whole.

use std::ops::Range;

use super::path::Trellis;

/// Plateaus to both sides of the expected one, to begin with. A schedule of no more is searched as a whole.
const NARROWEST: usize = 16;

/// Blocks of each of `count` plateaus on the best path of a record with these steady stretches; an empty range for a plateau passed over.
/// `between` and `on` are those of [`Trellis::best_path`].
pub(super) fn best_path(
    stretches: &[Range<usize>],
    count: usize,
    between: &[f64],
    on: impl Fn(usize, usize, &mut [f64]),
) -> Vec<Range<usize>> {
    let mut band = Band { expected: expected(stretches, between.len(), count), count, reach: NARROWEST };
    loop {
        let path = Trellis::new(&band.within(), between.len()).best_path(between, &on);
        if band.is_whole() || band.holds(&path) {
            return path;
        }
        band.reach *= 2;
    }
}

/// Number of the plateau expected at each block, not decreasing.
fn expected(stretches: &[Range<usize>], blocks: usize, count: usize) -> Vec<usize> {
    let mut ended = 0;
    let expected = (0..blocks).map(|block| {
        ended += stretches[ended..].iter().take_while(|stretch| stretch.end <= block).count();
        ended * count / stretches.len().max(1)
    });
    expected.collect()
}

/// The plateaus that each block is asked for.
struct Band {
    /// Number of the plateau expected at each block.
    expected: Vec<usize>,
    count: usize,
    /// Plateaus to both sides of it.
    reach: usize,
}

impl Band {
    /// Whether every block is asked for every plateau.
    fn is_whole(&self) -> bool {
        self.reach >= self.count
    }

    /// The blocks that each plateau may be in.
    fn within(&self) -> Vec<Range<usize>> {
        let of = |k: usize| {
            let start = self.expected.partition_point(|expected| expected + self.reach < k);
            start..self.expected.partition_point(|expected| *expected <= k + self.reach)
        };
        (0..self.count).map(of).collect()
    }

    /// Whether a path has all plateaus, and keeps clear of the edges by half the reach.
    fn holds(&self, path: &[Range<usize>]) -> bool {
        let is_clear = |k: usize, block: usize| 2 * self.expected[block].abs_diff(k) <= self.reach;
        let holds = |(k, range): (usize, &Range<usize>)| {
            !range.is_empty() && is_clear(k, range.start) && is_clear(k, range.end - 1)
        };
        path.iter().enumerate().all(holds)
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;
    use std::ops::Range;

    use super::best_path;
    use crate::reduction::locate::path::{LAYER, Trellis};

    /// Plateaus of a schedule whose levels return after `LEVELS`, each of some blocks.
    const PLATEAUS: usize = 150;
    const LEVELS: usize = 9;

    /// A record of steady stretches at these levels with transitions between them: its path, that of the whole search, and the densities
    /// that were computed for either.
    fn paths(levels: &[usize]) -> [(Vec<Range<usize>>, usize); 2] {
        let of_stretch = |(n, level): (usize, &usize)| [vec![Some(*level); 30 + n % 5], vec![None; 10]].concat();
        let seen: Vec<Option<usize>> = levels.iter().enumerate().flat_map(of_stretch).collect();
        let mut from = 0;
        let runs = seen.chunk_by(|a, b| a == b).map(|run| {
            from += run.len();
            (run[0].is_some(), from - run.len()..from)
        });
        let stretches: Vec<Range<usize>> = runs.filter(|(is_steady, _)| *is_steady).map(|(_, range)| range).collect();
        let (between, computed) = (vec![0.0; seen.len()], Cell::new(0));
        let on = |k: usize, from: usize, density: &mut [f64]| {
            computed.set(computed.get() + density.len());
            for (density, seen) in density.iter_mut().zip(&seen[from..]) {
                *density = if *seen == Some(k % LEVELS) { 20.0 } else { -5.0 };
            }
        };
        let banded = best_path(&stretches, PLATEAUS, &between, on);
        let by_band = computed.take();
        let whole = Trellis::new(&vec![0..seen.len(); PLATEAUS], seen.len()).best_path(&between, on);
        [(banded, by_band), (whole, computed.take())]
    }

    fn scheduled() -> Vec<usize> {
        (0..PLATEAUS).map(|k| k % LEVELS).collect()
    }

    #[test]
    fn the_best_path_is_found_where_it_is_expected() {
        let [(banded, by_band), (whole, by_whole)] = paths(&scheduled());
        assert!(banded == whole && banded.iter().all(|range| range.len() >= 30));
        assert!(2 * by_band < by_whole, "{by_band} of {by_whole} densities, layers of {LAYER} blocks");
    }

    /// Stretches of other levels before the schedule, within it and after it.
    #[test]
    fn stretches_that_nobody_scheduled_lead_to_the_same_path() {
        for (at, more) in [(0, 12), (0, 70), (50, 30), (PLATEAUS, 150)] {
            let mut levels = scheduled();
            levels.splice(at..at, vec![LEVELS; more]);
            let [(banded, _), (whole, _)] = paths(&levels);
            assert!(banded == whole && banded.iter().all(|range| range.len() >= 30), "{more} at {at}");
        }
    }

    #[test]
    fn plateaus_that_are_missing_are_passed_over_as_in_the_whole_search() {
        let mut levels = scheduled();
        levels.drain(40..48);
        let [(banded, _), (whole, _)] = paths(&levels);
        assert!(banded == whole && banded.iter().any(Range::is_empty));
    }
}
