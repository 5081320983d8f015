//! The tail of the noise, which is part of its mean, beside spikes, which are not.
//!
//! Vibration that a sensor squares has readings far off on one side alone. Limits that are symmetric cut that tail, and the mean of the other
//! readings is off by more than its uncertainty. A tail falls off about as an exponential does: of `n` readings on one side of the
//! fit, `m` beyond half the limit, no more than `m^2/n` are expected beyond the limit (the survival of a log-concave law is
//! log-concave). Spikes are more than that. Beside few spikes the limit grows little, since it follows from `n` and `m`: they stay out.

/// Readings on one side of a fit.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Side {
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
pub(super) fn widened(side: Side) -> Option<f64> {
    let Side { all, beyond_half, beyond } = side;
    let is_tail = beyond <= FARTHEST * beyond_half && beyond <= SLOWER * beyond_half * beyond_half / all;
    // The scale of the exponential, in limits.
    let scale = 0.5 / (beyond_half / beyond).ln();
    (beyond > 1.0 && is_tail).then(|| 1.0 + scale * (20.0 * beyond).ln())
}

#[cfg(test)]
mod tests {
    use super::{Side, widened};
    use crate::statistics::{MAD, Random, cut, median};

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
}
