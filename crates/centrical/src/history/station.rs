//! Whether a machine stayed as it was: one quantity over all sessions of a station, units coming and going.
//!
//! A unit may bring a value of its own, as the seat of its case does. Of units with several sessions its mean is therefore taken out, and
//! only changes between sessions of one unit count. Four tests: a slope in time (Student's t); a change at any time, by the largest
//! cumulative sum of the deviations (A. N. Kolmogorov's law, with which R. L. Brown, J. Durbin and J. M. Evans test regressions, J. R. Statist. Soc. B 37, 1975);
//! a single session that stands out (F. E. Grubbs, Technometrics 11, 1969); and sessions that resemble those before them
//! ([`super::succession`]). Scatter is their measure: they do not judge it.
//!
//! Units that come one after another take the course of the machine along with their means: what remains of the spread of times says
//! how much of a slope could show.

use super::succession::succession_probability;
use crate::statistics::t_tail;

/// A value in one session.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Time of the session [years].
    pub time: f64,
    /// Which unit was on the machine.
    pub unit: usize,
    /// Value.
    pub value: f64,
}

/// What the tests found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StationTest {
    /// Slope per year.
    pub slope: f64,
    /// Its standard uncertainty, by the scatter.
    pub standard_uncertainty: f64,
    /// Degrees of freedom of that.
    pub degrees_of_freedom: usize,
    /// Probability of so large a slope of a machine that does not change.
    pub slope_probability: f64,
    /// Time of the session after which the values changed most, if they changed at once.
    pub changed_after: f64,
    /// Mean after that less mean before.
    pub change: f64,
    /// Probability of so large a cumulative sum by chance.
    pub change_probability: f64,
    /// Time of the session farthest from the mean.
    pub farthest: f64,
    /// How far.
    pub distance: f64,
    /// Probability of a session as far off by chance.
    pub farthest_probability: f64,
    /// Probability of sessions that resemble those before them as much by chance.
    pub succession_probability: f64,
    /// Part of the squared spread of times that the means of units leave, 0 to 1.
    pub remaining_spread: f64,
}

impl StationTest {
    /// Probability that any test finds as much by chance (Bonferroni).
    pub fn probability(&self) -> f64 {
        let tests =
            [self.slope_probability, self.change_probability, self.farthest_probability, self.succession_probability];
        (tests.len() as f64 * tests.into_iter().fold(1.0, f64::min)).min(1.0)
    }

    /// Whether a machine that changes would show it: not where the units came one after another.
    pub fn has_power(&self) -> bool {
        self.remaining_spread >= LEAST_SPREAD
    }
}

/// Part of the squared spread of times without which a slope has more than twice its uncertainty.
const LEAST_SPREAD: f64 = 0.25;

impl StationTest {
    /// Fewer readings that count give no tests.
    pub const FEWEST_READINGS: usize = 8;

    /// The tests of `readings`; `None` below [`Self::FEWEST_READINGS`] of them, or where neither times nor values vary.
    pub fn of(readings: &[Reading]) -> Option<StationTest> {
        let Deviations { instants, times, values, groups, means } = Deviations::of(readings);
        let nu = times.len().checked_sub(means + 1).filter(|_| times.len() >= Self::FEWEST_READINGS)?;
        let spread: f64 = times.iter().map(|t| t * t).sum();
        let slope = times.iter().zip(&values).map(|(t, v)| t * v).sum::<f64>() / spread;
        let rest: f64 = times.iter().zip(&values).map(|(t, v)| (v - slope * t).powi(2)).sum();
        let standard_uncertainty = (rest / nu as f64 / spread).sqrt();
        if nu == 0 || standard_uncertainty <= 0.0 {
            return None;
        }
        let change = largest_change(&values, means)?;
        let (before, after) = values.split_at(change.after);
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let middle = mean(&instants);
        let all: f64 = instants.iter().map(|t| (t - middle).powi(2)).sum();
        let farthest = farthest(&values, means)?;
        Some(StationTest {
            slope,
            standard_uncertainty,
            degrees_of_freedom: nu,
            slope_probability: t_tail(slope / standard_uncertainty, nu as f64),
            changed_after: instants[change.after - 1],
            change: mean(after) - mean(before),
            change_probability: change.probability,
            farthest: instants[farthest.place],
            distance: values[farthest.place],
            farthest_probability: farthest.probability,
            succession_probability: succession_probability(&values, &groups)?,
            remaining_spread: spread / all,
        })
    }
}

/// The readings that can show a change, in the order of time.
struct Deviations {
    /// Times of the sessions.
    instants: Vec<f64>,
    /// Times, less their means.
    times: Vec<f64>,
    /// Values, less their means.
    values: Vec<f64>,
    /// Whose mean was taken out of each.
    groups: Vec<usize>,
    /// Means that were taken out.
    means: usize,
}

impl Deviations {
    /// Where most readings are of units that came again, those units alone, less the means of each; else all, less one mean.
    fn of(readings: &[Reading]) -> Self {
        let mut counts = vec![0_usize; readings.iter().map(|r| r.unit + 1).max().unwrap_or(0)];
        for reading in readings {
            counts[reading.unit] += 1;
        }
        let again: usize = counts.iter().filter(|count| **count > 1).sum();
        let is_by_unit = 2 * again >= readings.len();
        let mut kept: Vec<&Reading> = readings.iter().filter(|r| !is_by_unit || counts[r.unit] > 1).collect();
        kept.sort_by(|a, b| a.time.total_cmp(&b.time).then(a.unit.cmp(&b.unit)).then(a.value.total_cmp(&b.value)));
        let group = |reading: &Reading| if is_by_unit { reading.unit } else { 0 };
        let mut sums = vec![(0.0, 0.0, 0.0); counts.len()];
        for reading in &kept {
            let sum = &mut sums[group(reading)];
            *sum = (sum.0 + 1.0, sum.1 + reading.time, sum.2 + reading.value);
        }
        Self {
            instants: kept.iter().map(|r| r.time).collect(),
            times: kept.iter().map(|r| r.time - sums[group(r)].1 / sums[group(r)].0).collect(),
            values: kept.iter().map(|r| r.value - sums[group(r)].2 / sums[group(r)].0).collect(),
            groups: kept.iter().map(|r| group(r)).collect(),
            means: sums.iter().filter(|sum| sum.0 > 0.0).count(),
        }
    }
}

/// The value farthest from the mean of its unit.
struct Farthest {
    place: usize,
    probability: f64,
}

/// Grubbs' test: without the value the others scatter by `s`; `d / (s sqrt(1 + 1/n))` follows Student's t, and is the largest of `n`.
fn farthest(values: &[f64], means: usize) -> Option<Farthest> {
    let n = values.len();
    let freedom = n.checked_sub(means + 1).filter(|freedom| *freedom > 0)? as f64;
    let squares: f64 = values.iter().map(|v| v * v).sum();
    let place = (0..n).max_by(|&a, &b| values[a].abs().total_cmp(&values[b].abs()))?;
    // Part of a deviation that its own mean leaves it.
    let left = 1.0 - means as f64 / n as f64;
    let own = values[place].powi(2) / left;
    let t = (own * freedom / (squares - own).max(f64::MIN_POSITIVE)).sqrt();
    Some(Farthest { place, probability: (n as f64 * t_tail(t, freedom)).min(1.0) })
}

struct Change {
    after: usize,
    probability: f64,
}

/// The largest cumulative sum of deviations from the mean, over `s sqrt(n)`.
fn largest_change(values: &[f64], means: usize) -> Option<Change> {
    let n = values.len();
    let mean = values.iter().sum::<f64>() / n as f64;
    let freedom = n.checked_sub(means).filter(|freedom| *freedom > 0)? as f64;
    let deviation = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / freedom).sqrt();
    let (mut sum, mut largest, mut after) = (0.0_f64, 0.0, 1);
    for (i, value) in values[..n - 1].iter().enumerate() {
        sum += value - mean;
        if sum.abs() > largest {
            (largest, after) = (sum.abs(), i + 1);
        }
    }
    Some(Change { after, probability: kolmogorov_tail(largest / (deviation * (n as f64).sqrt())) })
}

/// `2 sum_j (-1)^(j-1) exp(-2 j^2 x^2)`.
fn kolmogorov_tail(x: f64) -> f64 {
    if x < SMALL {
        return 1.0;
    }
    let term = |j: i32| f64::from(if j % 2 == 1 { 2 } else { -2 }) * (-2.0 * f64::from(j * j) * x * x).exp();
    (1..=TERMS).map(term).sum::<f64>().clamp(0.0, 1.0)
}

/// The law is below 1e-9 there, and the series slow.
const SMALL: f64 = 0.2;

/// `exp(-2 TERMS^2 SMALL^2)` is below the rounding.
const TERMS: i32 = 24;
