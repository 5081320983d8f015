//! The errors of one session in the parameters of its unit, in a kB: a hundred thousand calibrations of a store fit in memory.

use std::collections::BTreeMap;

use centrical::Source;
use nalgebra::DMatrix;

use crate::job::history::of_data::PRIORS;
use crate::store::SharedInfluence;

/// Standard deviations and correlations of errors that belong to one session alone.
#[derive(Debug, Clone)]
pub struct OwnErrors {
    /// Standard deviations, SI; NaN where the data do not determine a parameter.
    pub deviations: Vec<f64>,
    /// The lower triangle by rows without the diagonal. Single precision is far beyond what a correlation is known to.
    correlations: Vec<f32>,
}

impl OwnErrors {
    /// Those of `n` parameters with these covariances of errors.
    pub fn of(n: usize, covariance: impl Fn(usize, usize) -> f64) -> Self {
        let deviations: Vec<f64> = (0..n).map(|i| covariance(i, i).sqrt()).collect();
        let correlation = |i: usize, j: usize| covariance(i, j) / (deviations[i] * deviations[j]);
        #[expect(clippy::cast_possible_truncation)]
        let correlations = (0..n).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| correlation(i, j) as f32);
        Self { correlations: correlations.collect(), deviations }
    }

    /// Covariances of the errors of the parameters with these `numbers`.
    pub fn covariances(&self, numbers: &[usize]) -> DMatrix<f64> {
        let mut covariances = DMatrix::zeros(numbers.len(), numbers.len());
        for (b, &j) in numbers.iter().enumerate() {
            for (a, &i) in numbers.iter().enumerate().skip(b) {
                let covariance = self.covariance(i, j);
                covariances[(a, b)] = covariance;
                covariances[(b, a)] = covariance;
            }
        }
        covariances
    }

    /// Covariance of the errors of parameters `i` and `j`.
    pub fn covariance(&self, i: usize, j: usize) -> f64 {
        let (low, high) = (i.min(j), i.max(j));
        let correlation = if low == high { 1.0 } else { f64::from(self.correlations[high * (high - 1) / 2 + low]) };
        correlation * self.deviations[i] * self.deviations[j]
    }
}

/// The independent errors that sessions share, numbered: those of one station, gravity, source and number within the source.
#[derive(Default)]
pub struct SharedErrors<'a>(BTreeMap<(&'a str, u64, &'a str, usize), usize>);

impl<'a> SharedErrors<'a> {
    /// How many there are.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// The number of each error of a session at `station`, of stated `gravity` [m/s^2]. Those of priors are common to all stations. Another gravity is another place where no
    /// station is named, and another statement of gravity where one is.
    pub fn of(&mut self, station: &'a str, gravity: f64, shared: &'a [SharedInfluence]) -> Vec<usize> {
        let place = |source: &'a str| match source {
            PRIORS => ("", 0),
            _ if station.is_empty() || source == Source::Gravity.name() => (station, gravity.to_bits()),
            _ => (station, 0),
        };
        let mut numbers: BTreeMap<&str, usize> = BTreeMap::new();
        let number = |SharedInfluence { source, .. }: &'a SharedInfluence| {
            let number = numbers.entry(source).or_default();
            *number += 1;
            let next = self.0.len();
            let (station, gravity) = place(source);
            *self.0.entry((station, gravity, source, *number)).or_insert(next)
        };
        shared.iter().map(number).collect()
    }
}
