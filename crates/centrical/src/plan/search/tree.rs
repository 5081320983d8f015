//! Branch and bound. A node has decided on some mountings (their set-ups are paid in full, or they are closed) and on bounds
//! of visits; its continuous design bounds all schedules below it. Mountings are decided first, the most used one first, the
//! lowest bound first, and then visits ([`super::visits`]), as far as the effort goes. Where a problem is small, that is until
//! nothing is left to find; where it is large, the lowest bound of the ends says how far the schedule can be from the best.
//!
//! **The bound is one.** Let a schedule belong to a node: it uses the mountings that are set up and perhaps some that are not
//! decided, none that is closed. (1) Its visits are a point of the node's polytope: bounds and repeats are the schedule's own;
//! and what an undecided mounting pays there, `f x / U` for the time `x` in it, is at most its set-up `f`, since no schedule
//! spends more than `U` in it: every plateau as often and as long as may be, or all the time there is. The difference between
//! a position and a seat is paid so once for the position, by the time in all its undecided mountings together. So the
//! schedule's time holds what the polytope asks for. Or the polytope asks for the least that the set-ups of a schedule of this
//! node cost that is better than the best so far ([`Needs`]), and nothing in proportion: where time hardly suffices for the
//! set-ups this is much more. (2) The equivalence theorem bounds the criterion on the polytope from
//! below at whatever design its sensitivities are taken, converged or not (see [`relax`](super::relaxation)). (3) The two
//! children of a node hold all its schedules, a child inherits the bound of its parent, and [`Plan::bound`] is the lowest bound
//! of the ends of all branches: left open, cut off against the best schedule, or not divided any further.

use rayon::prelude::*;

use super::needs::Needs;
use super::problem::Problem;
use super::{Effort, Plan};
use crate::plan::exchange::Whole;
use crate::plan::relaxation::{Polytope, Precision, Relaxed, relax};

/// What is decided.
#[derive(Debug, Clone)]
pub(super) struct Node {
    /// By mounting: set up, closed, or not decided.
    pub mountings: Vec<Option<bool>>,
    pub low: Vec<f64>,
    pub high: Vec<f64>,
    /// Least set-up time of its schedules that are better than what is known [s].
    pub set_up: f64,
    pub relaxed: Relaxed,
}

/// The search for the best schedule within a time.
pub(super) struct Tree<'a> {
    pub problem: &'a Problem<'a>,
    pub time: f64,
    pub effort: Effort,
    pub open: Vec<Node>,
    pub best: Option<Whole>,
    /// Sets of mountings for which a schedule has been sought.
    pub tried: Vec<Vec<bool>>,
    /// Value that is to be reached and no more, if any.
    pub wanted: Option<f64>,
    /// Lowest bound of the nodes that are not divided any further.
    pub bound: f64,
    pub nodes: usize,
    /// What is known of sets of mountings.
    pub needs: Needs,
}

/// A node that no bound can cut off is known this well before it is divided (3 % of an uncertainty).
const LOOSE: f64 = 0.06;

/// Known to this part of the criterion, nodes are not divided: where a plan that is nearly as good will do (0.25 % of an
/// uncertainty); and where goals are to be met, that a plan of less time may just miss.
const NEARLY: f64 = 5e-3;
const NEARLY_MET: f64 = 2e-3;

impl<'a> Tree<'a> {
    pub fn new(problem: &'a Problem<'a>, time: f64, effort: Effort) -> Self {
        Self {
            problem,
            time,
            effort,
            open: Vec::new(),
            best: None,
            tried: Vec::new(),
            wanted: None,
            bound: f64::INFINITY,
            nodes: 0,
            needs: Needs::default(),
        }
    }

    pub fn run(mut self) -> Plan {
        let root = self.root();
        self.nodes = 1;
        self.seek(&root, false);
        if !self.is_reached() {
            self.seek_on_all(&root);
        }
        self.exchange_mountings();
        if let Some(mut root) = self.with_needs(root) {
            let start = root.relaxed.visits.clone();
            self.relax(&mut root, Some(&start));
            self.open.push(root);
        }
        while !self.is_reached() {
            // Two at once keep two processors busy; the number is fixed, so that the plan does not depend on theirs.
            let nodes: Vec<Node> = [self.next(), self.next()].into_iter().flatten().collect();
            if nodes.is_empty() {
                break;
            }
            self.divide(nodes);
        }
        self.polish();
        self.into_plan()
    }

    fn root(&self) -> Node {
        let mut node = self.node(vec![None; self.problem.mountings()]);
        self.relax_to(self.tolerance(), &mut node, None);
        node
    }

    /// A node with these mountings decided and no visit, without a continuous design yet.
    pub fn node(&self, mountings: Vec<Option<bool>>) -> Node {
        let atoms = self.problem.atoms();
        #[expect(clippy::cast_precision_loss, reason = "a handful of visits")]
        let high = self.problem.candidates.repeats as f64;
        Node {
            mountings,
            low: vec![0.0; atoms],
            high: vec![high; atoms],
            set_up: 0.0,
            relaxed: Relaxed { visits: Vec::new(), value: f64::INFINITY, bound: f64::NEG_INFINITY, models: 0 },
        }
    }

    /// How near to the best schedule a bound is as good as the same.
    pub fn same(&self) -> f64 {
        match self.wanted {
            Some(_) => NEARLY_MET,
            None => NEARLY,
        }
    }

    /// How well a continuous design is known at the end of a branch.
    pub fn tolerance(&self) -> f64 {
        0.5 * self.same()
    }

    /// No branch is followed whose bound is not below this.
    pub fn threshold(&self) -> f64 {
        (self.incumbent() - self.same()).min(self.wanted.unwrap_or(f64::INFINITY))
    }

    pub fn is_reached(&self) -> bool {
        self.wanted.is_some_and(|wanted| self.incumbent() <= wanted)
    }

    pub fn incumbent(&self) -> f64 {
        self.best.as_ref().map_or(f64::INFINITY, |best| best.value)
    }

    /// The open node of the lowest bound, if it may hold something better.
    fn next(&mut self) -> Option<Node> {
        let best = (0..self.open.len())
            .min_by(|&a, &b| self.open[a].relaxed.bound.total_cmp(&self.open[b].relaxed.bound).then(b.cmp(&a)))?;
        let node = self.open.swap_remove(best);
        let may_be_better = node.relaxed.bound < self.threshold();
        if !may_be_better {
            self.bound = self.bound.min(node.relaxed.bound);
        }
        may_be_better.then_some(node)
    }

    /// Relaxes the children of some nodes and keeps those that may hold something better.
    fn divide(&mut self, nodes: Vec<Node>) {
        let children: Vec<Node> = nodes.into_iter().flat_map(|node| self.children(node)).collect();
        let children: Vec<Node> = children.into_iter().filter_map(|child| self.with_needs(child)).collect();
        let relaxed = |mut child: Node| {
            let start = child.relaxed.visits.clone();
            self.relax(&mut child, Some(&start)).then_some(child)
        };
        let children: Vec<_> = children.into_par_iter().map(relaxed).collect();
        for child in children {
            self.nodes += 1;
            if let Some(child) = child {
                if child.relaxed.bound < self.threshold() {
                    self.open.push(child);
                } else {
                    self.bound = self.bound.min(child.relaxed.bound);
                }
            }
        }
    }

    /// The node with what its set-ups cost at least; none if it holds no schedule that is better than what is known.
    fn with_needs(&mut self, mut node: Node) -> Option<Node> {
        let value = self.incumbent().min(self.wanted.unwrap_or(f64::INFINITY));
        let set_up: Vec<bool> = node.mountings.iter().map(|m| *m == Some(true)).collect();
        let open: Vec<bool> = node.mountings.iter().map(|m| *m != Some(false)).collect();
        let least = self.needs.least_set_up(self.problem, &set_up, &open, value);
        let Some(least) = least.filter(|least| *least < self.time) else {
            self.nodes += 1;
            self.bound = self.bound.min(value);
            return None;
        };
        node.set_up = least;
        Some(node)
    }

    /// Two nodes that decide on a mounting more, or none at the end of a branch.
    fn children(&mut self, mut node: Node) -> Vec<Node> {
        let is_end = |of_mountings: Option<usize>| of_mountings.is_none() || self.is_out_of_nodes();
        let is_loose = node.mountings.contains(&None) && node.relaxed.bound < self.bound;
        if is_loose && is_end(self.undecided(&node)) {
            let start = node.relaxed.visits.clone();
            self.relax_to(self.tolerance(), &mut node, Some(&start));
        }
        let node = &node;
        let decided = match self.undecided(node) {
            Some(m) if !self.is_out_of_nodes() => {
                let with = |set_up| {
                    let mut child = node.clone();
                    child.mountings[m] = Some(set_up);
                    child
                };
                vec![with(true), with(false)]
            }
            None => {
                self.seek(node, true);
                vec![]
            }
            Some(_) => vec![],
        };
        if decided.is_empty() {
            self.bound = self.bound.min(node.relaxed.bound);
        }
        decided
    }

    fn is_out_of_nodes(&self) -> bool {
        self.nodes >= self.effort.mounting_nodes
    }

    /// The undecided mounting that the continuous design uses most.
    fn undecided(&self, node: &Node) -> Option<usize> {
        let used = self.times(node);
        let candidates = (0..used.len()).filter(|&m| node.mountings[m].is_none() && used[m] > 1e-6 * self.time);
        candidates.max_by(|&a, &b| used[a].total_cmp(&used[b]).then(b.cmp(&a)))
    }

    /// Time of the continuous design in each mounting [s].
    pub fn times(&self, node: &Node) -> Vec<f64> {
        let mut times = vec![0.0; self.problem.mountings()];
        for (x, w) in node.relaxed.visits.iter().enumerate() {
            times[self.problem.mounting_of(x)] += w * self.problem.price(x);
        }
        times
    }

    pub fn is_open(&self, node: &Node, atom: usize) -> bool {
        node.mountings[self.problem.mounting_of(atom)] != Some(false)
    }

    /// Gives a node its continuous design; whether anything fits into it.
    pub fn relax(&self, node: &mut Node, start: Option<&[f64]>) -> bool {
        let is_decided = node.mountings.iter().all(Option::is_some);
        self.relax_to(if is_decided { self.tolerance() } else { LOOSE }, node, start)
    }

    pub fn relax_to(&self, loose: f64, node: &mut Node, start: Option<&[f64]>) -> bool {
        let polytope = self.polytope(node);
        let fits = polytope.is_feasible();
        if fits {
            let precision = Precision { tolerance: self.tolerance(), loose, enough: self.threshold() };
            // What bounds all below the parent bounds all below its child.
            let inherited = node.relaxed.bound;
            node.relaxed = relax(&self.problem.scenes, &polytope, start, precision);
            node.relaxed.bound = node.relaxed.bound.max(inherited);
        }
        fits
    }

    /// The bounds of a node, with set-ups paid where they are decided and in proportion where they are not; or with the least
    /// that the set-ups can cost, where that is more at the design there is.
    pub fn polytope(&self, node: &Node) -> Polytope {
        let (left, factors) = self.in_proportion(node);
        let proportional: f64 = self.times(node).iter().zip(&factors).map(|(time, factor)| time * (factor - 1.0)).sum();
        let is_least = node.set_up > self.time - left + proportional;
        let factor = |x: usize| if is_least { 1.0 } else { factors[self.problem.mounting_of(x)] };
        let high = |x: usize| if self.is_open(node, x) { node.high[x] } else { node.low[x] };
        let atoms = self.problem.atoms();
        Polytope {
            price: (0..atoms).map(|x| self.problem.price(x) * factor(x)).collect(),
            time: if is_least { self.time - node.set_up } else { left },
            low: node.low.clone(),
            high: (0..atoms).map(high).collect(),
            options: self.problem.candidates.durations.len(),
            repeats: self.problem.candidates.repeats as f64,
        }
    }

    /// Time left by the set-ups that are decided [s], and the factor by which visits of each mounting cost more where its
    /// set-up is paid in proportion to the time in it.
    fn in_proportion(&self, node: &Node) -> (f64, Vec<f64>) {
        let problem = self.problem;
        let candidates = problem.candidates;
        let experiment = candidates.experiment();
        let paid: Vec<bool> = node.mountings.iter().map(|m| *m == Some(true)).collect();
        let time = self.time - candidates.set_up_time(&paid);
        let options = candidates.durations.len();
        // Most time that can be spent in a mounting, and in a position.
        let longest = |c: usize| (c * options..(c + 1) * options).map(|x| problem.price(x)).fold(0.0, f64::max);
        let mut in_mounting = vec![0.0; problem.mountings()];
        for (c, set_point) in experiment.set_points.iter().enumerate() {
            in_mounting[set_point.mounting] += longest(c) * candidates.repeats as f64;
        }
        let mut in_position = vec![0.0; experiment.positions.len()];
        for (mounting, most) in experiment.mountings.iter().zip(&in_mounting) {
            in_position[mounting.position] += most;
        }
        let costs = &candidates.costs;
        let surcharge = |m: usize| {
            if node.mountings[m] == Some(true) {
                return 0.0;
            }
            let k = experiment.mountings[m].position;
            let has_paid = experiment.mountings.iter().zip(&paid).any(|(other, paid)| *paid && other.position == k);
            let of_position = if has_paid { 0.0 } else { (costs.position - costs.seat) / in_position[k].min(time) };
            (costs.seat + costs.run_up) / in_mounting[m].min(time) + of_position
        };
        (time, (0..problem.mountings()).map(|m| 1.0 + surcharge(m).max(0.0)).collect())
    }

    pub fn into_plan(self) -> Plan {
        let open = vec![true; self.problem.mountings()];
        let candidates = self.problem.candidates;
        let best = self.best.clone().unwrap_or_else(|| {
            // Nothing but the cheapest start fits.
            let exchange = self.problem.exchange(self.time, &open, self.effort.trials);
            exchange.improve(exchange.fill(exchange.whole(vec![0; self.problem.atoms()])))
        });
        let bound = self.open.iter().map(|node| node.relaxed.bound).fold(self.bound, f64::min).min(best.value);
        let start: Vec<f64> = best.counts.iter().map(|n| f64::from(*n)).collect();
        let node = self.node(self.mountings_of(&best).into_iter().map(Some).collect());
        let polytope = self.polytope(&node);
        let continuous = relax(&self.problem.scenes, &polytope, Some(&start), Precision::of(5e-4));
        Plan {
            schedule: candidates.schedule(best.visits(candidates)),
            criterion: best.value.exp(),
            by_scenario: best.by_scenario().into_iter().map(f64::exp).collect(),
            bound: bound.exp(),
            continuous,
            nodes: self.nodes,
            least_time: None,
        }
    }
}
