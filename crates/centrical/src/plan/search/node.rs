//! Nodes of the branch and bound, and those that are still open.

use super::problem::Problem;
use crate::plan::relaxation::{Polytope, Precision, Relaxed, relax};

/// What is decided about the set-ups.
#[derive(Debug, Clone)]
pub(super) struct Node {
    /// By set-up: made, closed, or not decided.
    pub set_ups: Vec<Option<bool>>,
    /// Least set-up time of its schedules that are better than the incumbent [s].
    pub set_up: f64,
    pub relaxed: Relaxed,
}

/// The open nodes, and the bound of all that are closed.
pub(super) struct OpenNodes {
    pub nodes: Vec<Node>,
    /// Lowest bound of the nodes that are not divided any further.
    pub bound: f64,
    /// Nodes so far.
    pub count: usize,
}

impl Node {
    /// A node with these decisions, without a continuous design yet.
    pub fn new(set_ups: Vec<Option<bool>>) -> Self {
        let relaxed = Relaxed { visits: Vec::new(), value: f64::INFINITY, bound: f64::NEG_INFINITY, models: 0 };
        Self { set_ups, set_up: 0.0, relaxed }
    }

    /// The node of a set of set-ups alone, all of them made.
    pub fn on(set: &[bool]) -> Self {
        Self::new(set.iter().copied().map(Some).collect())
    }

    /// Which set-ups are made.
    pub fn paid(&self) -> Vec<bool> {
        self.set_ups.iter().map(|m| *m == Some(true)).collect()
    }

    /// Which set-ups are not closed.
    pub fn open(&self) -> Vec<bool> {
        self.set_ups.iter().map(|m| *m != Some(false)).collect()
    }

    /// The node with another set-up decided.
    pub fn with(&self, set_up: usize, is_made: bool) -> Self {
        let mut child = self.clone();
        child.set_ups[set_up] = Some(is_made);
        child
    }

    /// Gives the node its continuous design; whether any design fits into it.
    pub fn relax(&mut self, problem: &Problem, time: f64, precision: Precision, start: Option<&[f64]>) -> bool {
        let polytope = self.polytope(problem, time);
        let fits = polytope.is_feasible();
        if fits {
            // A bound of the parent is one of its children.
            let inherited = self.relaxed.bound;
            self.relaxed = relax(&problem.watch, &problem.scenarios, &polytope, start, precision);
            self.relaxed.bound = self.relaxed.bound.max(inherited);
        }
        fits
    }

    /// The same from the design there is.
    pub fn relax_again(&mut self, problem: &Problem, time: f64, precision: Precision) -> bool {
        let start = self.relaxed.visits.clone();
        self.relax(problem, time, precision, Some(&start))
    }

    /// Time of the continuous design in each set-up [s].
    pub fn times(&self, problem: &Problem) -> Vec<f64> {
        let mut times = vec![0.0; problem.set_ups()];
        for (x, w) in self.relaxed.visits.iter().enumerate() {
            times[problem.candidates.set_up_of_atom(x)] += w * problem.candidates.price(x);
        }
        times
    }

    /// The undecided set-up that the continuous design uses most.
    pub fn undecided(&self, problem: &Problem, time: f64) -> Option<usize> {
        let used = self.times(problem);
        let undecided = (0..used.len()).filter(|&m| self.set_ups[m].is_none() && used[m] > 1e-6 * time);
        undecided.max_by(|&a, &b| used[a].total_cmp(&used[b]).then(b.cmp(&a)))
    }

    /// The bounds of a node, with set-ups paid where they are decided and in proportion where they are not; or with the least
    /// that the set-ups can cost, where that is more at the design there is.
    pub fn polytope(&self, problem: &Problem, time: f64) -> Polytope {
        let candidates = problem.candidates;
        let (left, factors) = self.in_proportion(problem, time);
        let times = self.times(problem);
        let proportional: f64 = times.iter().zip(&factors).map(|(time, factor)| time * (factor - 1.0)).sum();
        let is_least = self.set_up > time - left + proportional;
        let factor = |x: usize| if is_least { 1.0 } else { factors[candidates.set_up_of_atom(x)] };
        let atoms = candidates.atoms();
        let most: Vec<f64> = (0..candidates.len()).map(|c| candidates.most_visits(c) as f64).collect();
        let high = |x: usize| {
            if self.set_ups[candidates.set_up_of_atom(x)] == Some(false) { 0.0 } else { most[atoms.at(x).candidate] }
        };
        Polytope {
            price: (0..atoms.count()).map(|x| candidates.price(x) * factor(x)).collect(),
            time: if is_least { time - self.set_up } else { left },
            low: vec![0.0; atoms.count()],
            high: (0..atoms.count()).map(high).collect(),
            atoms,
            most,
        }
    }

    /// Time left by the set-ups that are decided [s], and the factor by which visits in each set-up cost more where it is
    /// paid in proportion to the time in it.
    fn in_proportion(&self, problem: &Problem, time: f64) -> (f64, Vec<f64>) {
        let candidates = problem.candidates;
        let experiment = candidates.experiment();
        let paid = self.paid();
        let time = time - candidates.set_up_time(&paid);
        // Most time that can be spent in a set-up, and in a position.
        let longest = |c: usize| candidates.atoms().of(c).map(|x| candidates.price(x)).fold(0.0, f64::max);
        let mut in_set_up = vec![0.0; problem.set_ups()];
        for c in 0..candidates.len() {
            in_set_up[candidates.set_up_of(c)] += longest(c) * candidates.most_visits(c) as f64;
        }
        let position = |set_up: usize| candidates.mounting_of(set_up).map(|mounting| mounting.position);
        let mut in_position = vec![0.0; experiment.positions.len()];
        for (set_up, most) in in_set_up.iter().enumerate() {
            if let Some(k) = position(set_up) {
                in_position[k] += most;
            }
        }
        let costs = &candidates.costs;
        let surcharge = |m: usize| {
            if paid[m] {
                return 0.0;
            }
            let Some(k) = position(m) else { return costs.table / in_set_up[m].min(time) };
            let has_paid = (0..paid.len()).any(|other| paid[other] && position(other) == Some(k));
            let of_position = if has_paid { 0.0 } else { (costs.position - costs.seat) / in_position[k].min(time) };
            (costs.seat + costs.run_up) / in_set_up[m].min(time) + of_position
        };
        (time, (0..problem.set_ups()).map(|m| 1.0 + surcharge(m).max(0.0)).collect())
    }
}

impl OpenNodes {
    pub fn new() -> Self {
        Self { nodes: Vec::new(), bound: f64::INFINITY, count: 0 }
    }

    /// Leaves a node open if its bound is below the threshold.
    pub fn keep(&mut self, node: Node, threshold: f64) {
        if node.relaxed.bound < threshold { self.nodes.push(node) } else { self.close(node.relaxed.bound) }
    }

    /// Counts the bound of a node that is not divided any further.
    pub fn close(&mut self, bound: f64) {
        self.bound = self.bound.min(bound);
    }

    /// The node of the lowest bound, if that is below the threshold.
    pub fn next(&mut self, threshold: f64) -> Option<Node> {
        let bound = |n: usize| self.nodes[n].relaxed.bound;
        let best = (0..self.nodes.len()).min_by(|&a, &b| bound(a).total_cmp(&bound(b)).then(b.cmp(&a)))?;
        let node = self.nodes.swap_remove(best);
        if node.relaxed.bound < threshold {
            return Some(node);
        }
        self.close(node.relaxed.bound);
        None
    }

    /// No schedule has a lower logarithm of the criterion.
    pub fn lowest(&self) -> f64 {
        self.nodes.iter().map(|node| node.relaxed.bound).fold(self.bound, f64::min)
    }
}
