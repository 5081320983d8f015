//! Which calibrations are compared, and by which parameters.
//!
//! Calibrations do not all determine the same: rests alone show bias and scale, a longer error model has more coefficients. Those are
//! compared that have the most estimates in common, calibrations times parameters. The others are left out, and named.

use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

use super::calibrated::Calibrated;
use crate::document::LeftOutSession;

/// Calibrations of units, unit by unit, that determine the same parameters.
#[derive(Debug, Clone)]
pub struct ComparedUnits {
    /// Calibrations of each unit in the order of time, one or more.
    pub units: Vec<Vec<Calibrated>>,
    /// Calibrations that lack some of the parameters.
    pub left_out: Vec<LeftOutSession>,
}

impl ComparedUnits {
    /// Those of `units` that are compared.
    pub fn of(mut units: Vec<Vec<Calibrated>>) -> Self {
        let all: Vec<&Calibrated> = units.iter().flatten().collect();
        let Compared { left_out, .. } = Compared::of(&all, None);
        if !left_out.is_empty() {
            let sources: BTreeSet<&str> = left_out.iter().map(|other| other.session.source.as_str()).collect();
            for unit in &mut units {
                unit.retain(|calibrated| !sources.contains(calibrated.source.as_str()));
            }
            units.retain(|unit| !unit.is_empty());
        }
        Self { units, left_out }
    }
}

/// Calibrations that determine the same parameters.
pub(super) struct Compared<'a> {
    /// Those that are compared, in their order.
    pub calibrations: Vec<&'a Calibrated>,
    /// Those that lack some of the parameters.
    pub left_out: Vec<LeftOutSession>,
}

impl<'a> Compared<'a> {
    /// Of `all`; parameters that the calibration `last` does not determine do not count, and it is compared itself.
    pub fn of(all: &[&'a Calibrated], last: Option<&Calibrated>) -> Self {
        let mut lists = Lists::default();
        let determined: Vec<Arc<BTreeSet<usize>>> = all.iter().map(|calibrated| lists.determined(calibrated)).collect();
        let last = last.map(|last| lists.determined(last));
        let mut counts: HashMap<&BTreeSet<usize>, usize> = HashMap::new();
        for set in &determined {
            *counts.entry(set.as_ref()).or_default() += 1;
        }
        let within = |set: &BTreeSet<usize>| last.as_ref().map_or_else(|| set.clone(), |last| set & last.as_ref());
        let candidates: BTreeSet<BTreeSet<usize>> = counts.keys().map(|set| within(set)).collect();
        let number = |names: &BTreeSet<usize>| -> usize {
            counts.iter().filter(|(set, _)| names.is_subset(set)).map(|(_, count)| count).sum()
        };
        let best = candidates.into_iter().max_by_key(|names| {
            let number = number(names);
            (number * names.len(), number)
        });
        let names = best.unwrap_or_default();
        let (mut calibrations, mut left_out) = (Vec::new(), Vec::new());
        for (&calibrated, set) in all.iter().zip(&determined) {
            let lacks: Vec<String> = names.difference(set).map(|name| lists.names[*name].clone()).collect();
            if lacks.is_empty() {
                calibrations.push(calibrated);
            } else {
                left_out.push(LeftOutSession { session: calibrated.past(), lacks });
            }
        }
        Self { calibrations, left_out }
    }
}

/// The parameters of units that were met, numbered.
#[derive(Default)]
struct Lists {
    names: Vec<String>,
    numbers: HashMap<String, usize>,
    /// The sets that were met: there are a few among thousands of calibrations.
    sets: HashMap<BTreeSet<usize>, Arc<BTreeSet<usize>>>,
}

impl Lists {
    /// The parameters of its unit that a calibration determines.
    fn determined(&mut self, calibrated: &Calibrated) -> Arc<BTreeSet<usize>> {
        let set: BTreeSet<usize> = calibrated.determined().map(|name| self.number(name)).collect();
        Arc::clone(self.sets.entry(set.clone()).or_insert_with(|| Arc::new(set)))
    }

    fn number(&mut self, name: &str) -> usize {
        if let Some(number) = self.numbers.get(name) {
            return *number;
        }
        self.names.push(name.to_owned());
        self.numbers.insert(name.to_owned(), self.names.len() - 1);
        self.names.len() - 1
    }
}
