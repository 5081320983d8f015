//! Which calibrations are compared, and by which parameters.
//!
//! Calibrations do not all determine the same: rests alone show bias and scale, a longer error model has more coefficients. Of one unit each
//! parameter is compared by the calibrations that determine it. Of units beside each other those calibrations are compared that have the most
//! estimates in common, calibrations times parameters.

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
        let left_out = left_out(&units);
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

/// The calibrations that lack some of the parameters in common.
fn left_out(units: &[Vec<Calibrated>]) -> Vec<LeftOutSession> {
    let mut lists = Lists::default();
    let all = || units.iter().flatten();
    let determined: Vec<Arc<BTreeSet<usize>>> = all().map(|calibrated| lists.determined(calibrated)).collect();
    let mut counts: HashMap<&BTreeSet<usize>, usize> = HashMap::new();
    for set in &determined {
        *counts.entry(set.as_ref()).or_default() += 1;
    }
    let number = |names: &BTreeSet<usize>| -> usize {
        counts.iter().filter(|(set, _)| names.is_subset(set)).map(|(_, count)| count).sum()
    };
    let candidates: BTreeSet<&BTreeSet<usize>> = counts.keys().copied().collect();
    let best = candidates.into_iter().max_by_key(|names| {
        let number = number(names);
        (number * names.len(), number)
    });
    let Some(names) = best else { return Vec::new() };
    let lacks = |set: &BTreeSet<usize>| -> Vec<String> {
        names.difference(set).map(|name| lists.names[*name].clone()).collect()
    };
    let of_all = all().zip(&determined).map(|(calibrated, set)| (calibrated, lacks(set)));
    let of_some = of_all.filter(|(_, lacks)| !lacks.is_empty());
    of_some.map(|(calibrated, lacks)| LeftOutSession { session: calibrated.past(), lacks }).collect()
}

/// The calibrations of one unit that are compared, by the parameters that two or more of them determine.
pub(super) struct ComparedSessions<'a> {
    /// Those that determine one or more of the parameters, in their order.
    pub calibrations: Vec<&'a Calibrated>,
    /// The parameters: those of the last calibration before the others.
    pub names: Vec<String>,
    /// Those of `calibrations` that lack some of the parameters.
    pub incomplete: Vec<LeftOutSession>,
    /// Those that lack all of them.
    pub left_out: Vec<LeftOutSession>,
}

impl<'a> ComparedSessions<'a> {
    pub fn of(all: &'a [Calibrated]) -> Self {
        let mut counts: HashMap<&str, usize> = HashMap::new();
        all.iter().flat_map(Calibrated::determined).for_each(|name| *counts.entry(name).or_default() += 1);
        let mut names: Vec<String> = Vec::new();
        for name in all.iter().rev().flat_map(Calibrated::determined) {
            // Each name is met once here.
            if counts.remove(name).is_some_and(|count| count > 1) {
                names.push(name.to_owned());
            }
        }
        let (mut calibrations, mut incomplete, mut left_out) = (Vec::new(), Vec::new(), Vec::new());
        for calibrated in all {
            let lacks: Vec<String> = names.iter().filter(|name| calibrated.place(name).is_none()).cloned().collect();
            let has_some = lacks.len() < names.len();
            if has_some {
                calibrations.push(calibrated);
            }
            if !lacks.is_empty() {
                let session = LeftOutSession { session: calibrated.past(), lacks };
                if has_some { &mut incomplete } else { &mut left_out }.push(session);
            }
        }
        Self { calibrations, names, incomplete, left_out }
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
