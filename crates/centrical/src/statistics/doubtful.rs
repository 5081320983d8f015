//! Readings in doubt, and the rules that decide.
//!
//! - **Stuck**: readings that repeat for longer than noise allows, of a stuck or saturated sensor, or a logger that holds a value.
//! - **A tail**: part of the noise and of its mean, beside spikes, which are not. Vibration that a sensor squares has readings far off on one
//!   side alone. Limits that are symmetric cut that tail, and the mean of the other readings is off by more than its uncertainty. A tail falls
//!   off about as an exponential does: of `n` readings on one side of the fit, `m` beyond half the limit, no more than `m^2/n` are expected
//!   beyond the limit (the survival of a log-concave law is log-concave). Spikes are more than that. Beside few spikes the limit grows little,
//!   since it follows from `n` and `m`: they stay out.
//! - **A tone**: samples that a fit rejects at equal distances.
//! - **Piled up**: readings at the end of their range.

use std::ops::Range;

use statrs::function::beta::beta_reg;

use super::robust::whole;

/// Probability below which a count is not chance.
const CHANCE: f64 = 1e-6;

/// The samples in a run of equal readings longer than chance makes, on any axis; `None` without such a run.
pub(crate) fn stuck_on_any_axis(f_z: [&[f64]; 3], longest: &[f64; 3]) -> Option<Vec<bool>> {
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
pub(crate) fn longest_run(n: usize, repeat_rate: f64) -> f64 {
    if repeat_rate < 1.0 { 1.0 + (CHANCE / n as f64).ln() / repeat_rate.ln() } else { f64::INFINITY }
}

/// Whether a run longer than that has a reading in a range. A run of `m` equal pairs of neighbours covers an `m`-th
/// place: few pairs have to be compared.
pub(crate) fn may_be_longer(f: &[f64], range: &Range<usize>, longest: f64) -> bool {
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

/// The most frequent value of the readings, and its count.
pub(crate) fn standing(f: &[f64]) -> (f64, usize) {
    let mut values: Vec<f64> = f.iter().copied().filter(|value| value.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    values.chunk_by(f64::eq).map(|same| (same[0], same.len())).max_by_key(|same| same.1).unwrap_or((f64::NAN, 0))
}

/// Whether nearly all of some samples are at one distance from the one before: that is a tone, and no spikes.
pub(crate) fn is_tone(samples: &[usize]) -> bool {
    let mut steps: Vec<usize> = samples.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_unstable();
    let commonest = steps.chunk_by(usize::eq).max_by_key(|same| same.len());
    commonest.is_some_and(|same| same[0] > 1 && 5 * same.len() >= 4 * steps.len())
}

/// Readings on one side of a fit.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Side {
    /// Number of all of them.
    pub all: f64,
    /// Number of those beyond half the limit.
    pub beyond_half: f64,
    /// Number of those beyond the limit.
    pub beyond: f64,
}

impl Side {
    /// Counts a reading that far from the fit, in limits.
    pub fn count(&mut self, distance: f64) {
        self.all += 1.0;
        self.beyond_half += f64::from(u8::from(distance > 0.5));
        self.beyond += f64::from(u8::from(distance > 1.0));
    }
}

/// Of the readings of a tail beyond half the limit, no more than this part lies beyond the limit. Of a squared normal value it is a third.
const FARTHEST: f64 = 0.5;

/// A squared normal value falls off somewhat slower than an exponential, and the numbers of a short plateau scatter.
const SLOWER: f64 = 3.0;

/// The limit that keeps a tail, over the limit; `None` where the readings beyond the limit are not a tail. One alone is not: noise of the normal law has
/// one in some plateaus, which moves no mean. Fewer than one in twenty exponential tails has a reading beyond the new limit.
pub(crate) fn widened(side: Side) -> Option<f64> {
    let Side { all, beyond_half, beyond } = side;
    let is_tail = beyond <= FARTHEST * beyond_half && beyond <= SLOWER * beyond_half * beyond_half / all;
    // The scale of the exponential, in limits.
    let scale = 0.5 / (beyond_half / beyond).ln();
    (beyond > 1.0 && is_tail).then(|| 1.0 + scale * (20.0 * beyond).ln())
}

/// The value at which readings pile up, and their number; `None` if they do not.
///
/// The numbers of readings at the outermost values of a noisy reading fall off. By log-concavity, which the normal law keeps when it is
/// rounded, their ratio falls from each value to the next: where the outermost has `n_0` on average and all others `n`, the next has
/// `n_0 n / (n_0 + n)` at least. Of these two, as few at the next as there are come by chance with a binomial probability; below one
/// in a million the outermost is a pile. Noise below a digit allows no decision: the crest of a slow wave piles up as well.
pub(crate) fn piled_up(mut readings: Vec<f64>) -> Option<(f64, usize)> {
    readings.sort_by(f64::total_cmp);
    let counts: Vec<(f64, usize)> = readings.chunk_by(f64::eq).map(|same| (same[0], same.len())).collect();
    let at_end = |outer: (f64, usize), next: (f64, usize)| {
        let others = (readings.len() - outer.1) as f64;
        let ratio = others / (others + outer.1 as f64);
        (at_most(next.1, outer.1 + next.1, ratio / (1.0 + ratio)) < CHANCE).then_some(outer)
    };
    let bottom = counts.first_chunk().and_then(|[outer, next, _]| at_end(*outer, *next));
    let top = counts.last_chunk().and_then(|[_, next, outer]| at_end(*outer, *next));
    top.into_iter().chain(bottom).max_by_key(|end| end.1)
}

/// Whether this number of readings at the end of their range calls for a closer look: nearly always it is one or two.
pub(crate) fn may_be_piled_up(most: usize) -> bool {
    poisson_tail(most, 1.0) < CHANCE
}

/// Probability of no more than `k` of `n`, each with the probability `p`.
fn at_most(k: usize, n: usize, p: f64) -> f64 {
    beta_reg((n - k) as f64, k as f64 + 1.0, 1.0 - p)
}

/// Probability of `count` or more under Poisson's law of that mean, from above (Chernoff): `(e m / k)^k exp(-m)`.
fn poisson_tail(count: usize, mean: f64) -> f64 {
    let k = count as f64;
    if k <= mean { 1.0 } else { (k - mean + k * (mean / k).ln()).exp() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::{MAD, Random, cut, median};

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

    /// The limit of readings that keeps their tails, over that by which they are good about their mean.
    fn wider(readings: &[f64]) -> f64 {
        let (mut mean, mut limit) = (median(&mut readings.to_vec()), 0.0);
        for _ in 0..10 {
            let mut sizes: Vec<f64> = readings.iter().map(|reading| (reading - mean).abs()).collect();
            limit = cut(readings.len()) * MAD * median(&mut sizes);
            let good: Vec<f64> = readings.iter().copied().filter(|reading| (reading - mean).abs() <= limit).collect();
            mean = good.iter().sum::<f64>() / good.len() as f64;
        }
        let mut sides = [Side::default(); 2];
        for f in readings {
            sides[usize::from(*f > mean)].count((f - mean).abs() / limit);
        }
        sides.into_iter().filter_map(widened).fold(1.0, f64::max)
    }

    #[test]
    fn a_tail_is_kept_and_spikes_are_not() {
        for (seed, n) in [(1, 1000), (2, 10_000), (3, 100_000)] {
            let mut random = Random::stream(seed, 0);
            let normal: Vec<f64> = (0..n).map(|_| random.normal()).collect();
            let squares: Vec<f64> = normal.iter().map(|value| 1.0 - value * value).collect();
            let exponential: Vec<f64> = normal.iter().map(|_| random.normal().hypot(random.normal()).powi(2)).collect();
            for tail in [&squares, &exponential] {
                // Eight robust deviations keep all but a few of either.
                let kept = wider(tail) * cut(n);
                assert!(kept > 8.0, "{kept} of {n}");
            }
            for (share, size) in [(0.05, 10.0), (0.01, 100.0), (0.2, 50.0), (0.4, 20.0), (1e-4, 100.0)] {
                let spiky = normal.iter().enumerate().map(|(i, value)| {
                    let is_spike = ((i + 1) as f64 * share).fract() < share;
                    value + if is_spike { size * (1.0 + random.normal().abs()) } else { 0.0 }
                });
                let kept = wider(&spiky.collect::<Vec<f64>>()) * cut(n);
                assert!(kept < 10.0, "{share} of {size}: {kept}");
            }
        }
    }

    /// A short plateau in counts, with the wave of gravity: none looks piled up.
    #[test]
    fn coarse_readings_of_short_plateaus_do_not_pile_up() {
        let mut random = Random::stream(2, 0);
        for noise in [1.0, 1.4, 2.0, 3.0] {
            for wave in [0.0, 1.0, 5.0, 50.0] {
                for _ in 0..3000 {
                    let reading = |i: i32| (wave * (0.37 * f64::from(i)).sin() + noise * random.normal()).round();
                    assert_eq!(piled_up((0..136).map(reading).collect()), None, "{noise} {wave}");
                }
            }
        }
    }

    #[test]
    fn clipped_readings_pile_up_and_noise_does_not() {
        let mut random = Random::stream(1, 0);
        let readings: Vec<f64> = (0..100_000).map(|_| random.normal()).collect();
        for digit in [0.0, 1e-3, 0.1, 0.5, 1.0] {
            let rounded = |f: f64| if digit > 0.0 { (f / digit).round() * digit } else { f };
            for part in readings.chunks(2000) {
                let plain: Vec<f64> = part.iter().map(|f| rounded(*f)).collect();
                assert_eq!(piled_up(plain), None, "digit {digit}");
                if digit < 0.2 {
                    let clipped: Vec<f64> = part.iter().map(|f| rounded(f.min(1.5))).collect();
                    let (value, count) = piled_up(clipped).expect("a fifteenth of them is clipped");
                    assert!((value - 1.5).abs() < 0.05 + digit && count > 80, "{value} {count}");
                }
            }
        }
    }
}
