//! Branch and bound. A node has decided on some set-ups, each that of a mounting, or of the table for all rests beside the arm: they
//! are paid in full, or closed. Its continuous design bounds all schedules below it. The most used set-up is decided first, the node of
//! the lowest bound divided first, as far as the effort goes. The lowest bound of the ends says how far the schedule can be from the
//! best. Visits are not branched on, so where the time hardly suffices for the set-ups, whole visits leave some percent open.
//!
//! **The bound is valid.** Let a schedule belong to a node: it uses the set-ups that are paid and perhaps some that are not
//! decided, none that is closed. (1) Its visits are a point of the node's polytope. The repeats are the schedule's own. The
//! charge of an undecided set-up, `f x / U` for the time `x` in it, is at most its cost `f`, since no schedule spends more than
//! `U` in it. `U` is every candidate as often and as long as possible, or all the available time. The difference between a
//! position and a seat is paid so once for the position, by the time in all its undecided mountings together. So the schedule
//! pays at least what the polytope asks for. Or the polytope asks for the least cost of the set-ups of a schedule of this node
//! that is better than the incumbent ([`SetUpBound`]), and for nothing in proportion: where time hardly suffices for the
//! set-ups this is much more. (2) The equivalence theorem bounds the criterion on the polytope from below at whatever design
//! its sensitivities are taken, converged or not ([`crate::plan::relaxation`]). (3) The two children of a node hold all its
//! schedules, and a child inherits the bound of its parent. [`Plan::bound`] is the lowest bound of the ends of all branches:
//! left open, cut off against the incumbent, or not divided any further.

use rayon::prelude::*;

use super::heuristics::Heuristics;
use super::incumbent::Plan;
use super::node::{Node, OpenNodes};
use super::problem::{Effort, Problem};
use super::set_up_bound::SetUpBound;
use crate::plan::relaxation::{Precision, relax};

/// A node that no bound can cut off is known this well before it is divided (3 % of an uncertainty).
const LOOSE: f64 = 0.06;

/// The search for the best schedule within a time.
pub(super) struct Tree<'a> {
    heuristics: Heuristics<'a>,
    open: OpenNodes,
    set_up_bound: SetUpBound,
}

impl<'a> Tree<'a> {
    /// The search for the best schedule.
    pub fn new(problem: &'a Problem<'a>, time: f64, effort: Effort) -> Self {
        Self::with(Heuristics::new(problem, time, effort, None), SetUpBound::default())
    }

    /// The search for any schedule that meets the goals.
    pub fn for_goals(problem: &'a Problem<'a>, time: f64, effort: Effort, set_up_bound: SetUpBound) -> Self {
        Self::with(Heuristics::new(problem, time, effort, Some(0.0)), set_up_bound)
    }

    fn with(heuristics: Heuristics<'a>, set_up_bound: SetUpBound) -> Self {
        Self { heuristics, open: OpenNodes::new(), set_up_bound }
    }

    pub fn run(mut self) -> Plan {
        let root = self.root();
        self.open.count = 1;
        self.heuristics.seek(&root, false);
        if !self.is_over() {
            self.heuristics.seek_on_all(&root);
        }
        self.heuristics.exchange_set_ups();
        if let Some(mut root) = self.with_least_set_up(root) {
            self.relax_again(&mut root);
            self.open.nodes.push(root);
        }
        while !self.is_over() {
            // Two at once keep two processors busy; the number is fixed, so that the plan does not depend on theirs.
            let nodes: Vec<Node> = [self.next(), self.next()].into_iter().flatten().collect();
            if nodes.is_empty() {
                break;
            }
            self.divide(nodes);
        }
        self.into_plan()
    }

    /// The best schedule on a set of set-ups alone, sought from the continuous design of another time.
    pub fn run_on(mut self, set: Vec<bool>, start: &[f64]) -> Plan {
        self.heuristics.seek_on(set, start);
        self.into_plan()
    }

    fn root(&self) -> Node {
        let Heuristics { problem, time, incumbent, .. } = &self.heuristics;
        let mut root = Node::new(vec![None; problem.set_ups()]);
        root.relax(problem, *time, incumbent.precision(None), None);
        root
    }

    /// Whether the incumbent suffices, or the search is stopped.
    fn is_over(&self) -> bool {
        self.heuristics.incumbent.is_reached() || self.heuristics.problem.watch.is_stopped()
    }

    fn next(&mut self) -> Option<Node> {
        self.open.next(self.heuristics.incumbent.threshold())
    }

    /// Relaxes the children of some nodes and keeps those that may hold a better schedule.
    fn divide(&mut self, nodes: Vec<Node>) {
        let children: Vec<Node> = nodes.into_iter().flat_map(|node| self.children(node)).collect();
        let children: Vec<Node> = children.into_iter().filter_map(|child| self.with_least_set_up(child)).collect();
        let relaxed = |mut child: Node| self.relax_again(&mut child).then_some(child);
        let children: Vec<_> = children.into_par_iter().map(relaxed).collect();
        self.open.count += children.len();
        let threshold = self.heuristics.incumbent.threshold();
        children.into_iter().flatten().for_each(|child| self.open.keep(child, threshold));
    }

    /// Gives a node a new continuous design from its present one; whether any design fits into it.
    fn relax_again(&self, node: &mut Node) -> bool {
        let Heuristics { problem, time, incumbent, .. } = &self.heuristics;
        let loose = node.set_ups.contains(&None).then_some(LOOSE);
        node.relax_again(problem, *time, incumbent.precision(loose))
    }

    /// The node with the least cost of its set-ups; `None` if it holds no schedule that is better than the incumbent.
    fn with_least_set_up(&mut self, mut node: Node) -> Option<Node> {
        let Heuristics { problem, time, incumbent, .. } = &self.heuristics;
        let value = incumbent.target();
        let least = self.set_up_bound.least(problem, &node.paid(), &node.open(), value);
        let Some(least) = least.filter(|least| least < time) else {
            self.open.count += 1;
            self.open.close(value);
            return None;
        };
        node.set_up = least;
        Some(node)
    }

    /// Two nodes that decide on a set-up more, or none at the end of a branch.
    fn children(&mut self, mut node: Node) -> Vec<Node> {
        let is_out_of_nodes = self.open.count >= self.heuristics.effort.nodes;
        let undecided = |tree: &Self, node: &Node| node.undecided(tree.heuristics.problem, tree.heuristics.time);
        let is_loose = node.set_ups.contains(&None) && node.relaxed.bound < self.open.bound;
        if is_loose && (is_out_of_nodes || undecided(self, &node).is_none()) {
            let Heuristics { problem, time, incumbent, .. } = &self.heuristics;
            node.relax_again(problem, *time, incumbent.precision(None));
        }
        match undecided(self, &node) {
            Some(m) if !is_out_of_nodes => return vec![node.with(m, true), node.with(m, false)],
            Some(_) => {}
            None => self.heuristics.seek(&node, true),
        }
        self.open.close(node.relaxed.bound);
        Vec::new()
    }

    fn into_plan(self) -> Plan {
        let Heuristics { problem, time, .. } = self.heuristics;
        let best = self.heuristics.polished();
        let start: Vec<f64> = best.visits.iter().map(|n| f64::from(*n)).collect();
        let polytope = Node::on(&best.set_ups(problem.candidates)).polytope(problem, time);
        let continuous = relax(&problem.watch, &problem.scenarios, &polytope, Some(&start), Precision::of(5e-4));
        let continuous = continuous.or_better(start, best.value);
        Plan::new(problem, &best, continuous, self.open.lowest(), self.open.count)
    }
}
