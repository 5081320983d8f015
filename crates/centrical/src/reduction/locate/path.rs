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
    plateaus: usize,
    /// For each block and each state, the state before.
    came_from: Vec<u32>,
}

impl Trellis {
    /// The trellis of a number of plateaus and blocks.
    pub fn new(plateaus: usize, blocks: usize) -> Self {
        Self { plateaus, came_from: vec![0; states(plateaus) * blocks] }
    }

    /// Blocks of each plateau on the best path; an empty range for a plateau passed over.
    ///
    /// `between[i]` is the logarithm of the probability density of block `i` in any transition; `on` computes those on a
    /// plateau, for a layer of blocks from the given one on.
    pub fn best_path(&mut self, between: &[f64], on: impl Fn(usize, usize, &mut [f64])) -> Vec<Range<usize>> {
        let (odds, states) = (MISSING.ln(), states(self.plateaus));
        // State 2k is the transition before plateau k, state 2k + 1 the plateau k.
        let mut score: Vec<f64> = (0..states).map(|state| (state / 2) as f64 * odds).collect();
        let mut room = vec![[0.0; LAYER]; self.plateaus];
        let layers = between.chunks(LAYER).zip(self.came_from.chunks_mut(LAYER * states));
        for (number, (between, came_from)) in layers.enumerate() {
            for (k, room) in room.iter_mut().enumerate() {
                on(k, number * LAYER, &mut room[..between.len()]);
            }
            for (i, (between, from)) in between.iter().zip(came_from.chunks_exact_mut(states)).enumerate() {
                if number + i > 0 {
                    advance(&mut score, from, odds);
                }
                let (of_plateaus, last) = score.as_chunks_mut::<2>();
                for ([transition, plateau], on) in of_plateaus.iter_mut().zip(&room) {
                    *transition += between;
                    *plateau += on[i];
                }
                last[0] += between;
            }
        }
        // The record may end anywhere: the remaining plateaus are passed over.
        let total = |state: &usize| score[*state] + ((states - 1 - state) / 2) as f64 * odds;
        let last = (0..states).max_by(|a, b| total(a).total_cmp(&total(b))).unwrap_or(0);
        trace(self.came_from.chunks_exact(states), last, self.plateaus)
    }
}

fn states(plateaus: usize) -> usize {
    2 * plateaus + 1
}

/// One block on: the best predecessor of every state, without branches, since noise would make them unpredictable.
fn advance(score: &mut [f64], from: &mut [u32], odds: f64) {
    // The best transition so far, plateaus between it and here passed over; and the plateau just before, as it was.
    let (mut transition, mut transition_score) = (0, f64::NEG_INFINITY);
    let mut plateau_before = f64::NEG_INFINITY;
    let arrive = |from: &mut u32, score: &mut f64, itself: u32, (other, other_score): (u32, f64)| {
        let is_better = other_score > *score;
        *from = if is_better { other } else { itself };
        *score = if is_better { other_score } else { *score };
    };
    for ((state, score), from) in (0..).step_by(2).zip(score.chunks_mut(2)).zip(from.chunks_mut(2)) {
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

fn trace<'a>(
    came_from: impl DoubleEndedIterator<Item = &'a [u32]> + ExactSizeIterator,
    last: usize,
    plateaus: usize,
) -> Vec<Range<usize>> {
    let mut found = vec![0..0; plateaus];
    let mut state = last;
    for (i, from) in came_from.enumerate().rev() {
        if state % 2 == 1 {
            let range = &mut found[state / 2];
            range.start = i;
            range.end = range.end.max(i + 1);
        }
        state = from[state] as usize;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::{LAYER, Trellis};

    /// Densities of a record that shows plateau `seen[i]` at block `i`, or a transition.
    fn path(seen: &[Option<usize>], plateaus: usize) -> Vec<std::ops::Range<usize>> {
        let on = |k: usize, from: usize, density: &mut [f64]| {
            for (density, seen) in density.iter_mut().zip(&seen[from..]) {
                *density = if *seen == Some(k) { 20.0 } else { -5.0 };
            }
        };
        Trellis::new(plateaus, seen.len()).best_path(&vec![0.0; seen.len()], on)
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
