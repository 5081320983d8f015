//! Schedules sought on the way: on the mountings that a node's continuous design uses, on all, and on sets that differ from
//! those of the best by one.

use rayon::prelude::*;

use super::Plan;
use super::tree::{Node, Tree};
use crate::plan::exchange::Whole;
use crate::plan::relaxation::Relaxed;

/// Whole visits that cost more than this part of the criterion are exchanged at once.
const ROUGH: f64 = 0.01;

impl Tree<'_> {
    /// The best schedule on a set of mountings alone, sought from the continuous design of another time.
    pub fn run_on(mut self, set: Vec<bool>, start: &[f64]) -> Plan {
        let restricted = self.restricted(&set, start);
        self.round(set, restricted);
        self.polish();
        self.into_plan()
    }

    /// Seeks a schedule on the mountings that the node's continuous design uses.
    pub fn seek(&mut self, node: &Node) {
        if let Some(set) = self.affordable(node).filter(|set| !self.tried.contains(set)) {
            let restricted = self.restricted(&set, &node.relaxed.visits);
            self.round(set, restricted);
        }
    }

    /// The continuous design on a set of mountings that are all set up.
    fn restricted(&self, set: &[bool], start: &[f64]) -> Option<Relaxed> {
        let atoms = self.problem.atoms();
        let node = Node {
            mountings: set.iter().map(|used| Some(*used)).collect(),
            low: vec![0.0; atoms],
            high: vec![self.problem.candidates.repeats as f64; atoms],
            relaxed: Relaxed { visits: Vec::new(), value: f64::INFINITY, bound: f64::NEG_INFINITY, models: 0 },
        };
        self.relaxed(node, Some(start)).ok().map(|node| node.relaxed)
    }

    /// A schedule from a continuous design that may hold a better one than the best so far.
    fn round(&mut self, set: Vec<bool>, relaxed: Option<Relaxed>) {
        if let Some(relaxed) = relaxed.filter(|relaxed| relaxed.bound < self.threshold()) {
            let exchange = self.problem.exchange(self.time, &set, self.effort.trials);
            let mut whole = exchange.round(&relaxed.visits);
            if whole.value > relaxed.value + ROUGH {
                whole = exchange.improve(whole);
            }
            if whole.value < self.incumbent() - 1e-12 {
                self.best = Some(whole);
            }
        }
        self.tried.push(set);
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
            self.round(all, relaxed);
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
            for (set, relaxed) in sets.into_iter().zip(relaxed) {
                self.round(set, relaxed);
            }
            if self.incumbent() >= best.value || self.is_reached() {
                return;
            }
        }
    }

    fn mountings_of(&self, whole: &Whole) -> Vec<bool> {
        let mut used = vec![false; self.problem.mountings()];
        let visited = (0..whole.counts.len()).filter(|&x| whole.counts[x] > 0);
        visited.for_each(|x| used[self.problem.mounting_of(x)] = true);
        used
    }

    /// Takes the node's continuous design for the best schedule if its visits are whole and nothing better is known.
    pub fn take_whole(&mut self, node: &Node) {
        if node.relaxed.visits.iter().any(|w| (w - w.round()).abs() > 1e-6) {
            return;
        }
        let open: Vec<bool> = node.mountings.iter().map(|m| *m != Some(false)).collect();
        let exchange = self.problem.exchange(self.time, &open, self.effort.trials);
        let whole = exchange.round(&node.relaxed.visits);
        if whole.value < self.incumbent() {
            self.best = Some(whole);
        }
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
