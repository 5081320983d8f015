//! Which errors of a session are those of another, too.

use std::collections::BTreeMap;

use centrical::Source;

use crate::job::history::of_data::PRIORS;
use crate::store::SharedInfluence;

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
