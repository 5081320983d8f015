//! Which set-ups no schedule can do without, hence their least cost.
//!
//! More information never raises a criterion. A set of set-ups is useless for a value if it does not reach that even with
//! every candidate as often and as long as possible; so are its subsets, and a schedule below the value uses a set-up outside
//! of each such set. The cheapest set-ups that do so are a hitting set. The sets to be hit are found as they are needed: the
//! cheapest hitting set so far, if it is useless, is enlarged as long as it remains so, and is the next one (Moreno-Centeno and
//! Karp 2013, "The implicit hitting set approach").

use std::collections::BTreeMap;

use super::problem::Problem;

/// Sets that the searches for the cheapest look at, all together: their number grows exponentially with the number of set-ups.
const SETS: usize = 500_000;

/// Useless sets that are kept.
const USELESS: usize = 200;

/// The least cost of set-ups, with the sets of them that have been valued for it.
#[derive(Debug, Clone)]
pub(super) struct SetUpBound {
    /// Largest useless sets.
    useless: Vec<Vec<bool>>,
    /// Logarithm of the criterion with everything on a set.
    values: BTreeMap<Vec<bool>, f64>,
    /// Sets that may still be looked at.
    left: usize,
}

impl Default for SetUpBound {
    fn default() -> Self {
        Self { useless: Vec::new(), values: BTreeMap::new(), left: SETS }
    }
}

impl SetUpBound {
    /// Least set-up time [s] of a schedule whose criterion has a logarithm below `value`: all of `set_up` are
    /// among them and only `open` ones. `None` where no such schedule exists. `value` may not rise from call to call. Where the effort is
    /// spent, `set_up` alone is counted, which is less.
    pub fn least(&mut self, problem: &Problem, set_up: &[bool], open: &[bool], value: f64) -> Option<f64> {
        loop {
            let left = self.left;
            let mut cheapest = Cheapest { problem, open, useless: &self.useless, time: f64::INFINITY, set: None, left };
            cheapest.seek(set_up.to_vec(), vec![false; open.len()]);
            let Cheapest { time, set, left, .. } = cheapest;
            self.left = left;
            if left == 0 {
                return Some(problem.candidates.set_up_time(set_up));
            }
            let set = set?;
            // The cheapest set that no known useless one holds costs no more than the one that is sought.
            if self.value(problem, &set) < value || self.useless.len() == USELESS {
                return Some(time);
            }
            self.useless.push(enlarged(problem, set, value));
        }
    }

    fn value(&mut self, problem: &Problem, set: &[bool]) -> f64 {
        *self.values.entry(set.to_vec()).or_insert_with(|| problem.everything_on(set).value)
    }
}

/// A useless set with all set-ups that leave it so.
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

/// The search for the cheapest set with a set-up outside of each useless one.
struct Cheapest<'a> {
    problem: &'a Problem<'a>,
    open: &'a [bool],
    useless: &'a [Vec<bool>],
    time: f64,
    set: Option<Vec<bool>>,
    /// Sets that may still be looked at.
    left: usize,
}

impl Cheapest<'_> {
    /// Goes through all sets that hold `set` and nothing of `closed`, dearer ones left out.
    fn seek(&mut self, set: Vec<bool>, mut closed: Vec<bool>) {
        let time = self.problem.candidates.set_up_time(&set);
        if time >= self.time || self.left == 0 {
            return;
        }
        self.left -= 1;
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
