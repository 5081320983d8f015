//! Which calibrations are compared, and by which parameters.
//!
//! Calibrations do not all determine the same: rests alone show bias and scale, a longer error model has more coefficients. Of one unit each
//! parameter is compared by the calibrations that determine it. Of units beside each other those calibrations are compared that have the most
//! estimates in common, calibrations times parameters.

use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

use super::calibrated::Calibrated;
use super::no_history::NoHistory;
use crate::document::LeftOutSession;

/// Calibrations of units of one model, unit by unit, that determine the same parameters.
#[derive(Debug, Clone)]
pub struct ComparedUnits {
    /// Calibrations of each unit in the order of time, one or more.
    pub units: Vec<Vec<Calibrated>>,
    /// Calibrations that lack some of the parameters.
    pub left_out: Vec<LeftOutSession>,
}

impl ComparedUnits {
    /// Those of `units` that are compared.
    ///
    /// # Errors
    /// [`NoHistory`] for units of several models.
    pub fn of(mut units: Vec<Vec<Calibrated>>) -> Result<Self, NoHistory> {
        NoHistory::refuse_several_models(units.iter().flatten())?;
        let left_out = left_out(&units);
        if !left_out.is_empty() {
            let sources: BTreeSet<&str> = left_out.iter().map(|other| other.session.source.as_str()).collect();
            for unit in &mut units {
                unit.retain(|calibrated| !sources.contains(calibrated.source.as_str()));
            }
            units.retain(|unit| !unit.is_empty());
        }
        Ok(Self { units, left_out })
    }
}

/// The calibrations that lack some of the parameters in common.
fn left_out(units: &[Vec<Calibrated>]) -> Vec<LeftOutSession> {
    let mut lists = Lists::default();
    let all = || units.iter().flatten();
    let determined: Vec<NumberedNames> = all().map(|calibrated| lists.of(calibrated.determined())).collect();
    let names = most_in_common(&determined, None);
    let with_lacks = all().zip(&determined).map(|(calibrated, set)| (calibrated, lists.missing(&names, set)));
    let left_out = with_lacks.filter(|(_, lacks)| !lacks.is_empty());
    left_out.map(|(calibrated, lacks)| LeftOutSession { session: calibrated.past(), lacks }).collect()
}

/// The names that most estimates are of: names times the `sets` that have them all; only names `within` a set count, if there is one.
fn most_in_common(sets: &[NumberedNames], within: Option<&NumberedNames>) -> BTreeSet<usize> {
    let mut counts: HashMap<&BTreeSet<usize>, usize> = HashMap::new();
    for set in sets {
        *counts.entry(set.as_ref()).or_default() += 1;
    }
    let number = |names: &BTreeSet<usize>| -> usize {
        counts.iter().filter(|(set, _)| names.is_subset(set)).map(|(_, count)| count).sum()
    };
    let common = |set: &&BTreeSet<usize>| within.map_or_else(|| (*set).clone(), |within| *set & within.as_ref());
    let candidates: BTreeSet<BTreeSet<usize>> = counts.keys().map(common).collect();
    let best = candidates.into_iter().max_by_key(|names| {
        let number = number(names);
        (number * names.len(), number)
    });
    best.unwrap_or_default()
}

/// The calibrations of one unit that are compared, by the parameters that two or more of them determine. What a longer error model has, a
/// shorter one takes for zero, and its other coefficients are not the same quantities: of calibrations with other models those are compared that have
/// the most parameters in common, determined or not.
pub(super) struct ComparedSessions<'a> {
    /// Those that determine one or more of the parameters, in their order.
    pub calibrations: Vec<&'a Calibrated>,
    /// The parameters: those of the last calibration before the others.
    pub names: Vec<String>,
    /// Those of `calibrations` that lack some of the parameters.
    pub incomplete: Vec<LeftOutSession>,
    /// Those that lack all of them, or have another model.
    pub left_out: Vec<LeftOutSession>,
}

impl<'a> ComparedSessions<'a> {
    pub fn of(all: &'a [Calibrated]) -> Self {
        let mut lists = Lists::default();
        let listed: Vec<NumberedNames> = all.iter().map(|calibrated| lists.of(calibrated.listed())).collect();
        let in_common = most_in_common(&listed, listed.last());
        let (alike, others): (Vec<_>, Vec<_>) =
            all.iter().zip(&listed).partition(|(_, listed)| in_common.is_subset(listed));
        let of_another_model = |(calibrated, listed): (&Calibrated, &NumberedNames)| LeftOutSession {
            session: calibrated.past(),
            lacks: lists.missing(&in_common, listed),
        };
        let mut left_out: Vec<LeftOutSession> = others.into_iter().map(of_another_model).collect();
        let all: Vec<&Calibrated> = alike.into_iter().map(|(calibrated, _)| calibrated).collect();
        let mut counts: HashMap<&str, usize> = HashMap::new();
        all.iter().flat_map(|c| c.determined()).for_each(|name| *counts.entry(name).or_default() += 1);
        let mut names: Vec<String> = Vec::new();
        for name in all.iter().rev().flat_map(|c| c.determined()) {
            // Each name is met once here.
            if counts.remove(name).is_some_and(|count| count > 1) {
                names.push(name.to_owned());
            }
        }
        let (mut calibrations, mut incomplete) = (Vec::new(), Vec::new());
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

/// The names of parameters, by their numbers.
type NumberedNames = Arc<BTreeSet<usize>>;

/// The parameters of units that were met, numbered.
#[derive(Default)]
struct Lists {
    names: Vec<String>,
    numbers: HashMap<String, usize>,
    /// The sets that were met: there are a few among thousands of calibrations.
    sets: HashMap<BTreeSet<usize>, NumberedNames>,
}

impl Lists {
    fn of<'n>(&mut self, names: impl Iterator<Item = &'n str>) -> NumberedNames {
        let set: BTreeSet<usize> = names.map(|name| self.number(name)).collect();
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

    /// The names of `names` that are not in `set`.
    fn missing(&self, names: &BTreeSet<usize>, set: &BTreeSet<usize>) -> Vec<String> {
        names.difference(set).map(|number| self.names[*number].clone()).collect()
    }
}
