//! Readings that repeat for longer than noise allows: a stuck or saturated sensor, or a logger that holds a value.

use std::ops::Range;

use crate::statistics::whole;

/// The samples in a run of equal readings longer than chance makes, on any axis; `None` without such a run.
pub(super) fn stuck_on_any_axis(f_z: [&[f64]; 3], longest: &[f64; 3]) -> Option<Vec<bool>> {
    let mut stuck: Option<Vec<bool>> = None;
    for (f, longest) in f_z.into_iter().zip(longest) {
        let mut from = 0;
        for run in f.chunk_by(f64::eq) {
            let range = from..from + run.len();
            from = range.end;
            if run.len() as f64 > *longest {
                stuck.get_or_insert_with(|| vec![false; f.len()])[range].fill(true);
            }
        }
    }
    stuck
}

/// The longest run of equal readings that chance makes: `n` readings of that repeat rate have a longer one in fewer than
/// one case in a million. Readings that rounding may hold still have runs of any length.
pub(super) fn longest_run(n: usize, repeat_rate: f64) -> f64 {
    const CHANCE: f64 = 1e-6;
    if repeat_rate < 1.0 { 1.0 + (CHANCE / n as f64).ln() / repeat_rate.ln() } else { f64::INFINITY }
}

/// Whether a run longer than that has a reading in a range. A run of `m` equal pairs of neighbours covers an `m`-th
/// place: few pairs have to be compared.
pub(super) fn may_be_longer(f: &[f64], range: &Range<usize>, longest: f64) -> bool {
    if longest >= f.len() as f64 {
        return false;
    }
    let m = whole(longest).max(1);
    let is_equal = |i: usize| f[i] == f[i + 1];
    let run_about = |i: usize| {
        let before = (0..i).rev().take_while(|i| is_equal(*i)).count();
        let after = (i..f.len() - 1).take_while(|i| is_equal(*i)).count();
        before + after + 1
    };
    let first = (range.start + 1).next_multiple_of(m) - 1;
    let places = (first..range.end.min(f.len().saturating_sub(1))).step_by(m);
    places.into_iter().any(|i| is_equal(i) && run_about(i) as f64 > longest)
}

#[cfg(test)]
mod tests {
    use super::{longest_run, may_be_longer, stuck_on_any_axis};

    fn stuck(f: &[f64], rate: f64) -> Option<Vec<bool>> {
        let longest = longest_run(f.len(), rate);
        let stuck = stuck_on_any_axis([f, &[], &[]], &[longest; 3]);
        assert_eq!(may_be_longer(f, &(0..f.len()), longest), stuck.is_some());
        stuck
    }

    #[test]
    fn a_held_reading_is_stuck_and_chance_repeats_are_not() {
        let mut f: Vec<f64> = (0..1000).map(|i| f64::from(i * 7919 % 31)).collect();
        f[500..520].fill(3.0);
        f[700] = f[699];
        let found = stuck(&f, 1.0 / 1000.0).unwrap();
        assert!((0..1000).all(|i| found[i] == (500..520).contains(&i)));
    }

    #[test]
    fn what_rounding_may_hold_still_is_not_stuck() {
        assert!(stuck(&[3.0; 1000], 1.0).is_none());
    }

    #[test]
    fn coarse_digits_are_not_stuck() {
        let f: Vec<f64> = (0..1000).map(|i| f64::from(u8::from(i * i % 97 > 80))).collect();
        assert!(stuck(&f, 0.8).is_none());
    }
}
