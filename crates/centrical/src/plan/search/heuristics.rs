//! Schedules sought on the way: on the set-ups that a node's continuous design uses, on all, and on sets that differ from
//! those of the incumbent by one.

use rayon::prelude::*;

use super::incumbent::Incumbent;
use super::node::Node;
use super::problem::{Effort, Problem};
use crate::plan::exchange::IntegerSchedule;
use crate::plan::relaxation::{Polytope, Relaxed, relax};

/// A rounding that costs more than this part of the criterion is improved by exchange at once.
const ROUGH: f64 = 0.01;

/// Beyond this, whole visits are sought by fixing some after the other.
const VERY_ROUGH: f64 = 0.05;

/// One of this many parts of visits is made whole before the next continuous design: in haste, and one part at a time.
const AT_ONCE: [usize; 2] = [8, usize::MAX];

/// Visits count as whole within this.
const WHOLE: f64 = 1e-6;

/// Precision of a continuous design on the way to whole visits.
const DIVING: f64 = 0.02;

/// The search for schedules within a time.
pub(super) struct Heuristics<'a> {
    pub problem: &'a Problem<'a>,
    pub time: f64,
    pub effort: Effort,
    pub incumbent: Incumbent,
    /// Sets of set-ups for which a schedule has been sought.
    tried: Vec<Vec<bool>>,
}

impl<'a> Heuristics<'a> {
    pub fn new(problem: &'a Problem<'a>, time: f64, effort: Effort, wanted: Option<f64>) -> Self {
        Self { problem, time, effort, incumbent: Incumbent::new(wanted), tried: Vec::new() }
    }

    /// Seeks a schedule on a set of set-ups alone, from the continuous design of another time.
    pub fn seek_on(&mut self, set: Vec<bool>, start: &[f64]) {
        let restricted = self.restricted(&set, start);
        self.round(set, restricted, true);
    }

    /// Seeks a schedule on the set-ups that the node's continuous design uses.
    pub fn seek(&mut self, node: &Node, is_thorough: bool) {
        if let Some(set) = self.affordable(node).filter(|set| !self.tried.contains(set)) {
            let restricted = self.restricted(&set, &node.relaxed.visits);
            self.round(set, restricted, is_thorough);
        }
    }

    /// Seeks a schedule on all set-ups, if they leave time to measure.
    pub fn seek_on_all(&mut self, root: &Node) {
        let all = vec![true; self.problem.set_ups()];
        let fits = self.problem.candidates.set_up_time(&all) < self.time;
        if fits && self.effort.nodes > 1 && !self.tried.contains(&all) {
            let relaxed = self.restricted(&all, &root.relaxed.visits);
            self.round(all, relaxed, false);
        }
    }

    /// One set-up left out, or taken in besides, as long as that is better.
    pub fn exchange_set_ups(&mut self) {
        if self.effort.nodes <= 1 {
            return;
        }
        loop {
            let Some(best) = self.incumbent.best.clone() else { return };
            let used = best.set_ups(self.problem.candidates);
            let visits: Vec<f64> = best.visits.iter().map(|n| f64::from(*n)).collect();
            let other = |m: usize| {
                let mut set = used.clone();
                set[m] = !set[m];
                set
            };
            let sets: Vec<Vec<bool>> = (0..used.len()).map(other).filter(|set| !self.tried.contains(set)).collect();
            let relaxed: Vec<_> = sets.par_iter().map(|set| self.restricted(set, &visits)).collect();
            let lowest = |a: &usize, b: &usize| {
                let value = |n: usize| relaxed[n].as_ref().map_or(f64::INFINITY, |relaxed| relaxed.value);
                value(*a).total_cmp(&value(*b))
            };
            let most_promising = (0..sets.len()).min_by(lowest);
            for (n, (set, relaxed)) in sets.into_iter().zip(relaxed).enumerate() {
                self.round(set, relaxed, Some(n) == most_promising);
            }
            let is_over = self.incumbent.is_reached() || self.problem.watch.is_stopped();
            if is_over || self.incumbent.value() >= best.value {
                return;
            }
        }
    }

    /// The incumbent with visits exchanged, on its set-ups; without an incumbent the schedule of the cheapest start.
    pub fn polished(&self) -> IntegerSchedule {
        let (set, best) = match &self.incumbent.best {
            Some(best) => (best.set_ups(self.problem.candidates), Some(best.clone())),
            None => (vec![true; self.problem.set_ups()], None),
        };
        let exchange = self.problem.exchange(self.time, &set, self.effort.trials);
        let start = || exchange.fill(exchange.schedule(vec![0; self.problem.candidates.atoms().count()]));
        exchange.improve(best.unwrap_or_else(start))
    }

    /// The continuous design on a set of set-ups that are all made.
    fn restricted(&self, set: &[bool], start: &[f64]) -> Option<Relaxed> {
        let mut node = Node::on(set);
        node.relax(self.problem, self.time, self.incumbent.precision(None), Some(start)).then_some(node.relaxed)
    }

    /// A schedule from a continuous design that may hold a better one than the incumbent. Where whole visits cost much it
    /// takes thoroughness, for which a set may be tried again.
    fn round(&mut self, set: Vec<bool>, relaxed: Option<Relaxed>, is_thorough: bool) {
        let mut is_done = true;
        if let Some(relaxed) = relaxed.filter(|relaxed| relaxed.bound < self.incumbent.threshold()) {
            let exchange = self.problem.exchange(self.time, &set, self.effort.trials);
            let mut schedule = exchange.round(&relaxed.visits);
            if schedule.value > relaxed.value + ROUGH {
                schedule = exchange.improve(schedule);
            }
            let is_rough = schedule.value > relaxed.value + VERY_ROUGH;
            is_done = is_thorough || !is_rough;
            if is_thorough && is_rough {
                let dived = |at_once| exchange.fill(exchange.parted(self.dive(&set, &relaxed, at_once)));
                let starts = AT_ONCE.map(dived).into_iter().chain([exchange.rounded_short(&relaxed.visits)]);
                for other in starts.map(|start| exchange.improve(start)) {
                    if other.value < schedule.value {
                        schedule = other;
                    }
                }
            }
            if schedule.value < self.incumbent.value() - 1e-12 {
                self.incumbent.best = Some(schedule);
            }
        }
        if is_done {
            self.tried.push(set);
        }
    }

    /// Whole visits by fixing some after the other: those that the continuous design makes whole, and the largest parts, with a
    /// new continuous design of the rest each time. An indispensable visit is so never rounded away.
    fn dive(&self, set: &[bool], relaxed: &Relaxed, at_once: usize) -> Vec<u32> {
        let mut polytope = Node::on(set).polytope(self.problem, self.time);
        let mut visits = relaxed.visits.clone();
        loop {
            keep_whole(&mut polytope, &visits);
            let part = |x: &usize| visits[*x] - polytope.low[*x];
            let mut parts: Vec<usize> =
                (0..visits.len()).filter(|x| part(x) > WHOLE && polytope.high[*x] > polytope.low[*x]).collect();
            parts.sort_by(|a, b| part(b).total_cmp(&part(a)).then(a.cmp(b)));
            parts.truncate(parts.len().div_ceil(at_once));
            if parts.is_empty() {
                break;
            }
            for x in parts {
                polytope.low[x] += 1.0;
                if !polytope.is_feasible() {
                    polytope.low[x] -= 1.0;
                    polytope.high[x] = polytope.low[x];
                }
            }
            if !polytope.is_feasible() {
                break;
            }
            let precision = self.incumbent.precision(Some(DIVING));
            let rest = relax(&self.problem.watch, &self.problem.scenarios, &polytope, Some(&visits), precision);
            if rest.bound >= self.incumbent.threshold() {
                break;
            }
            visits = rest.visits;
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        polytope.low.iter().map(|low| *low as u32).collect()
    }

    /// The set-ups that the continuous design uses, the least used left out until they leave time to measure.
    fn affordable(&self, node: &Node) -> Option<Vec<bool>> {
        let times = node.times(self.problem);
        let decisions = times.iter().zip(&node.set_ups);
        let mut set: Vec<bool> = decisions.map(|(time, decided)| decided.unwrap_or(*time > 2e-3 * self.time)).collect();
        loop {
            let set_up = self.problem.candidates.set_up_time(&set);
            if set_up < self.time && set.contains(&true) {
                return Some(set);
            }
            let least = (0..set.len()).filter(|&m| set[m]).min_by(|&a, &b| times[a].total_cmp(&times[b]))?;
            set[least] = false;
        }
    }
}

/// Keeps the visits that are whole in the continuous design, as far as they fit.
fn keep_whole(polytope: &mut Polytope, visits: &[f64]) {
    let mut left = polytope.time - polytope.spent(&polytope.low);
    for x in 0..visits.len() {
        let more = (visits[x] + WHOLE).floor() - polytope.low[x];
        let price = more * polytope.price[x];
        if more > 0.0 && price <= left {
            polytope.low[x] += more;
            left -= price;
        }
    }
}
