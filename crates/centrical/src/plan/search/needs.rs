//! Which mountings no schedule can do without: what the set-ups cost at least.
//!
//! More information never raises a criterion, so a set of mountings on which everything there is, every plateau as often and as
//! long as may be, does not get below a value is of no use, nor is any of its subsets: a schedule below that value uses a
//! mounting outside of each such set. The cheapest mountings that do so are a hitting set, and the sets to be hit are found as
//! they are needed: the cheapest hitting set so far, if it is of no use, is enlarged as long as it remains so, and is the next
//! one (Moreno-Centeno and Karp 2013, "The implicit hitting set approach").

use std::collections::BTreeMap;

use super::problem::Problem;

/// What is known of sets of mountings.
#[derive(Debug, Clone, Default)]
pub(super) struct Needs {
    /// Largest sets of no use.
    useless: Vec<Vec<bool>>,
    /// Logarithm of the criterion with everything on a set.
    values: BTreeMap<Vec<bool>, f64>,
}

impl Needs {
    /// Least set-up time [s] of the mountings of a schedule whose criterion has a logarithm below `value`: all of `set_up` are
    /// among them and none that is not `open`. `None` if there is no such schedule. `value` may not rise from call to call.
    pub fn least_set_up(&mut self, problem: &Problem, set_up: &[bool], open: &[bool], value: f64) -> Option<f64> {
        loop {
            let mut cheapest = Cheapest { problem, open, useless: &self.useless, time: f64::INFINITY, set: None };
            cheapest.seek(set_up.to_vec(), vec![false; open.len()]);
            let (time, set) = (cheapest.time, cheapest.set?);
            if self.value(problem, &set) < value {
                return Some(time);
            }
            self.useless.push(enlarged(problem, set, value));
        }
    }

    fn value(&mut self, problem: &Problem, set: &[bool]) -> f64 {
        *self.values.entry(set.to_vec()).or_insert_with(|| problem.everything_on(set).value)
    }
}

/// A set of no use with all mountings that leave it so.
fn enlarged(problem: &Problem, mut set: Vec<bool>, value: f64) -> Vec<bool> {
    let mut everything = problem.everything_on(&set);
    for m in 0..set.len() {
        if !set[m] {
            let more = problem.with_everything_on(&everything, m);
            if more.value >= value {
                (set[m], everything) = (true, more);
            }
        }
    }
    set
}

/// The search for the cheapest set with a mounting outside of each useless one.
struct Cheapest<'a> {
    problem: &'a Problem<'a>,
    open: &'a [bool],
    useless: &'a [Vec<bool>],
    time: f64,
    set: Option<Vec<bool>>,
}

impl Cheapest<'_> {
    /// Goes through all sets that hold `set` and nothing of `closed`, dearer ones left out.
    fn seek(&mut self, set: Vec<bool>, mut closed: Vec<bool>) {
        let time = self.problem.candidates.set_up_time(&set);
        if time >= self.time {
            return;
        }
        let is_missed = |useless: &&Vec<bool>| set.iter().zip(*useless).all(|(used, useless)| !used || *useless);
        let Some(missed) = self.useless.iter().find(is_missed) else {
            (self.time, self.set) = (time, Some(set));
            return;
        };
        for m in (0..set.len()).filter(|&m| self.open[m] && !missed[m]) {
            if !std::mem::replace(&mut closed[m], true) {
                let mut with = set.clone();
                with[m] = true;
                self.seek(with, closed.clone());
            }
        }
    }
}
