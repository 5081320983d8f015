//! The most probable path of a record through its schedule, by dynamic programming (Viterbi 1967).
//!
//! A path begins in a transition or in a plateau; from block to block it stays, or goes from a plateau to the
//! transition after it, or from a transition to the next plateau, or passes plateaus over at the odds that they are
//! missing.

use std::ops::Range;

/// Odds of a plateau that is in the schedule and not in the record.
const MISSING: f64 = 1e-6;

/// Blocks whose densities are computed together, so that they stay in the fastest memory.
pub(super) const LAYER: usize = 512;

/// All paths of a record through a schedule.
pub(super) struct Trellis {
    /// Plateaus that each block may belong to.
    plateaus: Vec<Range<usize>>,
    count: usize,
    /// For each block and each of its states, the state before.
    came_from: Vec<u32>,
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
        let came_from = vec![0; plateaus.iter().map(|plateaus| states(plateaus).len()).sum()];
        Self { plateaus, count: within.len(), came_from }
    }

    /// Blocks of each plateau on the best path; an empty range for a plateau passed over.
    ///
    /// `between[i]` is the logarithm of the probability density of block `i` in any transition; `on` computes those on a
    /// plateau, for a layer of blocks from the given one on.
    pub fn best_path(&mut self, between: &[f64], on: impl Fn(usize, usize, &mut [f64])) -> Vec<Range<usize>> {
        let (odds, all) = (MISSING.ln(), 2 * self.count + 1);
        // State 2k is the transition before plateau k, state 2k + 1 the plateau k.
        let of_first = states(&self.plateaus[0]);
        let at_first =
            |state: usize| if of_first.contains(&state) { (state / 2) as f64 * odds } else { f64::NEG_INFINITY };
        let mut score: Vec<f64> = (0..all).map(at_first).collect();
        let (mut before, mut came_from) = (of_first.clone(), self.came_from.as_mut_slice());
        let mut room = Vec::new();
        for (number, (between, plateaus)) in between.chunks(LAYER).zip(self.plateaus.chunks(LAYER)).enumerate() {
            let of_layer = plateaus[0].start..plateaus[plateaus.len() - 1].end;
            room.resize(room.len().max(of_layer.len()), [0.0; LAYER]);
            for (k, room) in of_layer.clone().zip(&mut room) {
                on(k, number * LAYER, &mut room[..between.len()]);
            }
            for (i, (between, plateaus)) in between.iter().zip(plateaus).enumerate() {
                let here = states(plateaus);
                let from = came_from.split_off_mut(..here.len()).unwrap_or_default();
                if number + i > 0 {
                    advance(&mut score, here.clone(), from, odds);
                    score[before.start..here.start].fill(f64::NEG_INFINITY);
                }
                let (of_plateaus, last) = score[here.clone()].as_chunks_mut::<2>();
                for ([transition, plateau], on) in of_plateaus.iter_mut().zip(&room[plateaus.start - of_layer.start..])
                {
                    *transition += between;
                    *plateau += on[i];
                }
                last[0] += between;
                before = here;
            }
        }
        // The record may end anywhere: the remaining plateaus are passed over.
        let total = |state: &usize| score[*state] + ((all - 1 - state) / 2) as f64 * odds;
        let last = before.max_by(|a, b| total(a).total_cmp(&total(b))).unwrap_or(0);
        self.trace(last)
    }

    /// Blocks of each plateau on the path that ends in a state.
    fn trace(&self, last: usize) -> Vec<Range<usize>> {
        let mut found = vec![0..0; self.count];
        let (mut state, mut came_from) = (last, self.came_from.as_slice());
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
fn advance(score: &mut [f64], here: Range<usize>, from: &mut [u32], odds: f64) {
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
    use std::ops::Range;

    use super::{LAYER, Trellis};

    /// Densities of a record that shows plateau `seen[i]` at block `i`, or a transition.
    fn path(seen: &[Option<usize>], plateaus: usize) -> Vec<Range<usize>> {
        best_path(seen, &vec![0..seen.len(); plateaus])
    }

    /// The path of plateaus that may each be within some blocks.
    fn best_path(seen: &[Option<usize>], within: &[Range<usize>]) -> Vec<Range<usize>> {
        let on = |k: usize, from: usize, density: &mut [f64]| {
            for (density, seen) in density.iter_mut().zip(&seen[from..]) {
                *density = if *seen == Some(k) { 20.0 } else { -5.0 };
            }
        };
        Trellis::new(within, seen.len()).best_path(&vec![0.0; seen.len()], on)
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
}
