//! Schedules sought on the way: on the mountings that a node's continuous design uses, on all, and on sets that differ from
//! those of the best by one.

use rayon::prelude::*;

use super::Plan;
use super::tree::{Node, Tree};
use crate::plan::exchange::Whole;
use crate::plan::relaxation::Relaxed;

/// Whole visits that cost more than this part of the criterion are exchanged at once.
const ROUGH: f64 = 0.01;

/// And beyond this they are sought by fixing some after the other.
const VERY_ROUGH: f64 = 0.05;

/// Of so many parts of visits one is made whole before the next continuous design.
const AT_ONCE: usize = 8;

/// Visits that are whole but for this part are whole.
const WHOLE: f64 = 1e-6;

/// How well a continuous design is known on the way to whole visits.
const DIVING: f64 = 0.02;

impl Tree<'_> {
    /// The best schedule on a set of mountings alone, sought from the continuous design of another time.
    pub fn run_on(mut self, set: Vec<bool>, start: &[f64]) -> Plan {
        let restricted = self.restricted(&set, start);
        self.round(set, restricted, true);
        self.polish();
        self.into_plan()
    }

    /// Seeks a schedule on the mountings that the node's continuous design uses.
    pub fn seek(&mut self, node: &Node, is_thorough: bool) {
        if let Some(set) = self.affordable(node).filter(|set| !self.tried.contains(set)) {
            let restricted = self.restricted(&set, &node.relaxed.visits);
            self.round(set, restricted, is_thorough);
        }
    }

    /// The continuous design on a set of mountings that are all set up.
    fn restricted(&self, set: &[bool], start: &[f64]) -> Option<Relaxed> {
        let mut node = self.node(decided(set));
        self.relax(&mut node, Some(start)).then_some(node.relaxed)
    }

    /// A schedule from a continuous design that may hold a better one than the best so far. Where whole visits cost much it
    /// takes thoroughness, for which a set may be tried again.
    fn round(&mut self, set: Vec<bool>, relaxed: Option<Relaxed>, is_thorough: bool) {
        let mut is_done = true;
        if let Some(relaxed) = relaxed.filter(|relaxed| relaxed.bound < self.threshold()) {
            let exchange = self.problem.exchange(self.time, &set, self.effort.trials);
            let mut whole = exchange.round(&relaxed.visits);
            if whole.value > relaxed.value + ROUGH {
                whole = exchange.improve(whole);
            }
            let is_rough = whole.value > relaxed.value + VERY_ROUGH;
            is_done = is_thorough || !is_rough;
            if is_thorough && is_rough {
                let dived = exchange.improve(exchange.fill(exchange.whole(self.dive(&set, &relaxed))));
                if dived.value < whole.value {
                    whole = dived;
                }
            }
            if whole.value < self.incumbent() - 1e-12 {
                self.best = Some(whole);
            }
        }
        if is_done {
            self.tried.push(set);
        }
    }

    /// Whole visits by fixing some after the other: those that the continuous design makes whole, and the largest parts, with a
    /// new continuous design of what is left each time. What is indispensable is so never rounded away.
    fn dive(&self, set: &[bool], relaxed: &Relaxed) -> Vec<u32> {
        let mut node = self.node(decided(set));
        let mut visits = relaxed.visits.clone();
        loop {
            self.keep_whole(&mut node, &visits);
            let part = |x: &usize| visits[*x] - node.low[*x];
            let mut parts: Vec<usize> =
                (0..visits.len()).filter(|x| part(x) > WHOLE && node.high[*x] > node.low[*x]).collect();
            parts.sort_by(|a, b| part(b).total_cmp(&part(a)).then(a.cmp(b)));
            parts.truncate(parts.len().div_ceil(AT_ONCE));
            if parts.is_empty() {
                break;
            }
            for x in parts {
                node.low[x] += 1.0;
                if !self.polytope(&node).is_feasible() {
                    node.low[x] -= 1.0;
                    node.high[x] = node.low[x];
                }
            }
            if !self.relax_to(DIVING, &mut node, Some(&visits)) {
                break;
            }
            if node.relaxed.bound >= self.threshold() {
                break;
            }
            visits.clone_from(&node.relaxed.visits);
            node.relaxed.bound = f64::NEG_INFINITY;
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        node.low.iter().map(|low| *low as u32).collect()
    }

    /// Keeps the visits that are whole in the continuous design, as far as they fit.
    fn keep_whole(&self, node: &mut Node, visits: &[f64]) {
        let polytope = self.polytope(node);
        let mut left = polytope.time - polytope.spent(&node.low);
        for x in 0..visits.len() {
            let more = (visits[x] + WHOLE).floor() - node.low[x];
            let price = more * polytope.price[x];
            if more > 0.0 && price <= left {
                node.low[x] += more;
                left -= price;
            }
        }
    }

    /// The best schedule with visits exchanged, on its mountings.
    pub fn polish(&mut self) {
        if let Some(best) = self.best.take() {
            let set = self.mountings_of(&best);
            self.best = Some(self.problem.exchange(self.time, &set, self.effort.trials).improve(best));
        }
    }

    /// Seeks a schedule on all mountings, if their set-ups leave time to measure.
    pub fn seek_on_all(&mut self, root: &Node) {
        let all = vec![true; self.problem.mountings()];
        let fits = self.problem.candidates.set_up_time(&all) < self.time;
        if fits && self.effort.mounting_nodes > 1 && !self.tried.contains(&all) {
            let relaxed = self.restricted(&all, &root.relaxed.visits);
            self.round(all, relaxed, false);
        }
    }

    /// One mounting left out, or taken in besides, as long as that is better.
    pub fn exchange_mountings(&mut self) {
        if self.effort.mounting_nodes <= 1 {
            return;
        }
        loop {
            let Some(best) = self.best.clone() else { return };
            let used = self.mountings_of(&best);
            let visits: Vec<f64> = best.counts.iter().map(|n| f64::from(*n)).collect();
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
            if self.incumbent() >= best.value || self.is_reached() {
                return;
            }
        }
    }

    pub fn mountings_of(&self, whole: &Whole) -> Vec<bool> {
        let mut used = vec![false; self.problem.mountings()];
        let visited = (0..whole.counts.len()).filter(|&x| whole.counts[x] > 0);
        visited.for_each(|x| used[self.problem.mounting_of(x)] = true);
        used
    }

    /// The mountings that the continuous design uses, the least used left out until their set-ups leave time to measure.
    fn affordable(&self, node: &Node) -> Option<Vec<bool>> {
        let times = self.times(node);
        let mut set: Vec<bool> = times
            .iter()
            .zip(&node.mountings)
            .map(|(time, decided)| decided.unwrap_or(*time > 2e-3 * self.time))
            .collect();
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

/// A set of mountings as decisions.
fn decided(set: &[bool]) -> Vec<Option<bool>> {
    set.iter().copied().map(Some).collect()
}
