//! The most probable path of a record through its schedule, by dynamic programming (Viterbi 1967).
//!
//! A path starts in a transition or a plateau. At each block it stays, enters the next state, or skips plateaus with
//! the odds that they are missing.
//!
//! The search of a long schedule takes time and memory that grow with the record and not with the schedule too.
//! Every plateau is a steady stretch of the record. Of `N` plateaus and `S` stretches, number `N s / S` is expected in the block
//! before which `s` stretches have ended, and a block is asked for the plateaus near that number alone. Stretches that nobody
//! scheduled, and plateaus that do not look steady, lead away from it: the band is widened until the path keeps clear of its edges.
//! A record that lacks a plateau is always searched as a whole.

use std::ops::Range;

/// Odds of a plateau that is in the schedule and not in the record.
const MISSING: f64 = 1e-6;

/// Blocks whose densities are computed together, so that they stay in the fastest memory.
pub(super) const LAYER: usize = 512;

/// Plateaus to both sides of the expected one, to begin with. A schedule of no more is searched as a whole.
const NARROWEST: usize = 16;

/// The plateaus that each block is asked for.
pub(super) struct Band {
    /// Number of the plateau expected at each block, not decreasing.
    expected: Vec<usize>,
    count: usize,
    /// Plateaus to both sides of it.
    pub reach: usize,
}

impl Band {
    /// The narrowest band of a record that has these steady stretches.
    pub fn new(stretches: &[Range<usize>], blocks: usize, count: usize) -> Self {
        let mut ended = 0;
        let expected = (0..blocks).map(|block| {
            ended += stretches[ended..].iter().take_while(|stretch| stretch.end <= block).count();
            ended * count / stretches.len().max(1)
        });
        Self { expected: expected.collect(), count, reach: NARROWEST }
    }

    /// The blocks that each plateau may be in.
    pub fn within(&self) -> Vec<Range<usize>> {
        let of = |k: usize| {
            let start = self.expected.partition_point(|expected| expected + self.reach < k);
            start..self.expected.partition_point(|expected| *expected <= k + self.reach)
        };
        (0..self.count).map(of).collect()
    }

    /// Whether a path has all plateaus and keeps clear of the edges by half the reach, or every block was asked for every plateau.
    pub fn holds(&self, path: &[Range<usize>]) -> bool {
        let is_clear = |k: usize, block: usize| 2 * self.expected[block].abs_diff(k) <= self.reach;
        let holds = |(k, range): (usize, &Range<usize>)| {
            !range.is_empty() && is_clear(k, range.start) && is_clear(k, range.end - 1)
        };
        self.reach >= self.count || path.iter().enumerate().all(holds)
    }
}

/// All paths of a record through a schedule, followed through [`LAYER`] blocks at a time.
pub(super) struct Trellis {
    /// Plateaus that each block may belong to.
    plateaus: Vec<Range<usize>>,
    count: usize,
    /// For each block and each of its states, the state before; of `reached` states so far.
    came_from: Vec<u32>,
    reached: usize,
    /// Logarithm of the probability of the best path to each state: 2k is the transition before plateau k, 2k + 1 the plateau k.
    score: Vec<f64>,
    /// Blocks of the present [`LAYER`], and their densities on each of its plateaus.
    layer: Range<usize>,
    room: Vec<[f64; LAYER]>,
}

impl Trellis {
    /// The trellis of plateaus that may each be `within` some blocks. The ranges rise, and leave no block without a plateau.
    pub fn new(within: &[Range<usize>], blocks: usize) -> Self {
        let (mut first, mut end) = (0, 0);
        let plateaus = (0..blocks).map(|i| {
            first += within[first..].iter().take_while(|range| range.end <= i).count();
            end += within[end..].iter().take_while(|range| range.start <= i).count();
            first..end
        });
        let plateaus: Vec<Range<usize>> = plateaus.collect();
        let (count, of_first) = (within.len(), states(&plateaus[0]));
        let came_from = vec![0; plateaus.iter().map(|plateaus| states(plateaus).len()).sum()];
        let at_first = |state: usize| {
            if of_first.contains(&state) { (state / 2) as f64 * MISSING.ln() } else { f64::NEG_INFINITY }
        };
        let score = (0..=2 * count).map(at_first).collect();
        Self { plateaus, count, came_from, reached: 0, score, layer: 0..0, room: Vec::new() }
    }

    /// Goes on to the next [`LAYER`], and returns its first block; nothing at the end of the record.
    pub fn next_layer(&mut self) -> Option<usize> {
        let from = self.layer.end;
        self.layer = from..self.plateaus.len().min(from + LAYER);
        (!self.layer.is_empty()).then_some(from)
    }

    /// Each plateau that blocks of the [`LAYER`] may belong to, with room for the logarithms of their probability densities on
    /// it.
    pub fn plateaus(&mut self) -> impl Iterator<Item = (usize, &mut [f64])> {
        let of_layer = &self.plateaus[self.layer.clone()];
        let all = of_layer[0].start..of_layer[of_layer.len() - 1].end;
        self.room.resize(self.room.len().max(all.len()), [0.0; LAYER]);
        all.zip(self.room.iter_mut().map(|room| &mut room[..of_layer.len()]))
    }

    /// Takes the [`LAYER`], of whose blocks `between[i]` is the same logarithm in any transition.
    pub fn take(&mut self, between: &[f64]) {
        let Self { plateaus, came_from, reached, score, layer, room, .. } = self;
        let first = plateaus[layer.start].start;
        for (i, block) in layer.clone().enumerate() {
            let here = states(&plateaus[block]);
            let from = &mut came_from[*reached..][..here.len()];
            *reached += here.len();
            if block > 0 {
                advance(score, here.clone(), from);
                score[states(&plateaus[block - 1]).start..here.start].fill(f64::NEG_INFINITY);
            }
            let (of_plateaus, last) = score[here].as_chunks_mut::<2>();
            for ([transition, plateau], on) in of_plateaus.iter_mut().zip(&room[plateaus[block].start - first..]) {
                *transition += between[block];
                *plateau += on[i];
            }
            last[0] += between[block];
        }
    }

    /// After the last [`LAYER`]: blocks of each plateau on the best path; an empty range for a plateau passed over.
    pub fn best_path(&self) -> Vec<Range<usize>> {
        // The record may end anywhere: the remaining plateaus are passed over.
        let total = |state: &usize| self.score[*state] + ((2 * self.count - state) / 2) as f64 * MISSING.ln();
        let last = self.plateaus.last().and_then(|last| states(last).max_by(|a, b| total(a).total_cmp(&total(b))));
        let (mut state, mut came_from) = (last.unwrap_or(0), self.came_from.as_slice());
        let mut found = vec![0..0; self.count];
        for (i, plateaus) in self.plateaus.iter().enumerate().rev() {
            if state % 2 == 1 {
                let range = &mut found[state / 2];
                range.start = i;
                range.end = range.end.max(i + 1);
            }
            let states = states(plateaus);
            let (earlier, from) = came_from.split_at(came_from.len() - states.len());
            (state, came_from) = (from[state - states.start] as usize, earlier);
        }
        found
    }
}

/// States of a block that may belong to some plateaus: these, and the transitions before and after them.
fn states(plateaus: &Range<usize>) -> Range<usize> {
    2 * plateaus.start..2 * plateaus.end + 1
}

/// One block on: the best predecessor of every state `here`, without branches, since noise would make them unpredictable.
fn advance(score: &mut [f64], here: Range<usize>, from: &mut [u32]) {
    let odds = MISSING.ln();
    let first = u32::try_from(here.start).unwrap_or(u32::MAX);
    // The best transition so far, plateaus between it and here passed over; and the plateau just before, as it was.
    let (mut transition, mut transition_score) = (first, f64::NEG_INFINITY);
    let mut plateau_before = here.start.checked_sub(1).map_or(f64::NEG_INFINITY, |before| score[before]);
    let arrive = |from: &mut u32, score: &mut f64, itself: u32, (other, other_score): (u32, f64)| {
        let is_better = other_score > *score;
        *from = if is_better { other } else { itself };
        *score = if is_better { other_score } else { *score };
    };
    let score = &mut score[here];
    for ((state, score), from) in (first..).step_by(2).zip(score.chunks_mut(2)).zip(from.chunks_mut(2)) {
        let own = score[0];
        transition_score += odds;
        transition = if own >= transition_score { state } else { transition };
        transition_score = if own >= transition_score { own } else { transition_score };
        arrive(&mut from[0], &mut score[0], state, (state.wrapping_sub(1), plateau_before));
        if let ([_, score], [_, from]) = (score, from) {
            plateau_before = *score;
            arrive(from, score, state + 1, (transition, transition_score));
        }
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;
    use std::ops::Range;

    use super::{Band, LAYER, Trellis};

    /// Densities of a record that shows plateau `seen[i]` at block `i`, or a transition.
    fn path(seen: &[Option<usize>], plateaus: usize) -> Vec<Range<usize>> {
        best_path(seen, &vec![0..seen.len(); plateaus])
    }

    /// The path of plateaus that may each be within some blocks.
    fn best_path(seen: &[Option<usize>], within: &[Range<usize>]) -> Vec<Range<usize>> {
        walk(within, seen.len(), |k, from, density| {
            for (density, seen) in density.iter_mut().zip(&seen[from..]) {
                *density = if *seen == Some(k) { 20.0 } else { -5.0 };
            }
        })
    }

    /// The same by any densities.
    fn walk(within: &[Range<usize>], blocks: usize, mut on: impl FnMut(usize, usize, &mut [f64])) -> Vec<Range<usize>> {
        let mut trellis = Trellis::new(within, blocks);
        while let Some(from) = trellis.next_layer() {
            trellis.plateaus().for_each(|(k, density)| on(k, from, density));
            trellis.take(&vec![0.0; blocks]);
        }
        trellis.best_path()
    }

    #[test]
    fn plateaus_in_order_are_found() {
        let seen = [Some(0), Some(0), None, Some(1), Some(1), Some(1), None, Some(2)];
        assert_eq!(path(&seen, 3), [0..2, 3..6, 7..8]);
    }

    #[test]
    fn a_path_is_found_layer_by_layer() {
        let long = |seen: Option<usize>| std::iter::repeat_n(seen, LAYER - 1);
        let seen: Vec<_> = [None, Some(0), None, Some(1), None, Some(2)].into_iter().flat_map(long).collect();
        let at = |k: usize| k * (LAYER - 1)..(k + 1) * (LAYER - 1);
        assert_eq!(path(&seen, 3), [at(1), at(3), at(5)]);
    }

    /// Between the neighbours of where they were found, plateaus are found again, and what is beyond them is not seen.
    #[test]
    fn plateaus_are_found_within_their_blocks() {
        let long = |seen: Option<usize>| std::iter::repeat_n(seen, LAYER - 1);
        let seen: Vec<_> = (0..9).flat_map(|k| [None, Some(k)]).chain([None]).flat_map(long).collect();
        let found = path(&seen, 9);
        let between = |k: usize| {
            let start = k.checked_sub(1).map_or(0, |k| found[k].start);
            start..found.get(k + 1).map_or(seen.len(), |next| next.end)
        };
        let within: Vec<Range<usize>> = (0..9).map(between).collect();
        assert_eq!(best_path(&seen, &within), found);
    }

    #[test]
    fn a_longer_visit_beyond_the_blocks_of_a_plateau_is_not_seen() {
        let mut seen = vec![None; 60];
        seen[2..4].fill(Some(0));
        seen[8..10].fill(Some(1));
        seen[20..40].fill(Some(0));
        assert_eq!(path(&seen, 2)[0], 20..40);
        assert_eq!(best_path(&seen, &[0..12, 2..60]), [2..4, 8..10]);
    }

    #[test]
    fn a_missing_plateau_is_passed_over() {
        let seen = [Some(0), Some(0), None, Some(2), Some(2)];
        assert_eq!(path(&seen, 3), [0..2, 0..0, 3..5]);
    }

    #[test]
    fn missing_plateaus_at_both_ends_are_passed_over() {
        assert_eq!(path(&[None, Some(1), Some(1), None], 3), [0..0, 1..3, 0..0]);
    }

    #[test]
    fn of_two_plateaus_out_of_order_the_longer_is_taken() {
        let seen = [Some(1), Some(1), Some(1), None, Some(0), Some(0)];
        assert_eq!(path(&seen, 2), [0..0, 0..3]);
    }

    #[test]
    fn a_disturbed_block_does_not_end_a_plateau() {
        assert_eq!(path(&[Some(0), None, Some(0), Some(0), None], 1).first(), Some(&(0..4)));
    }

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
        let computed = Cell::new(0);
        let search = |within: &[Range<usize>]| {
            walk(within, seen.len(), |k, from, density| {
                computed.set(computed.get() + density.len());
                for (density, seen) in density.iter_mut().zip(&seen[from..]) {
                    *density = if *seen == Some(k % LEVELS) { 20.0 } else { -5.0 };
                }
            })
        };
        let mut band = Band::new(&stretches, seen.len(), PLATEAUS);
        let mut banded = search(&band.within());
        while !band.holds(&banded) {
            band.reach *= 2;
            banded = search(&band.within());
        }
        let by_band = computed.take();
        [(banded, by_band), (search(&vec![0..seen.len(); PLATEAUS]), computed.take())]
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
