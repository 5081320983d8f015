//! The best schedule for a time, and the shortest for given goals.
//!
//! Branch and bound. A node has decided on some mountings (their set-ups are paid in full, or they are closed) and on bounds
//! of visits; its continuous design bounds all schedules below it. Mountings are decided first, the most used one first, the
//! lowest bound first. Where a problem is small, visits are decided too, until nothing is left to find; where it is large,
//! the branches end with the mountings, and the lowest bound of their ends says how far the schedule can be from the best.
//!
//! **The bound is one.** Let a schedule belong to a node: it uses the mountings that are set up and perhaps some that are not
//! decided, none that is closed. (1) Its visits are a point of the node's polytope: bounds and repeats are the schedule's own;
//! and what an undecided mounting pays there, `f x / U` for the time `x` in it, is at most its set-up `f`, since no schedule
//! spends more than `U` in it: every plateau as often and as long as may be, or all the time there is. The difference between
//! a position and a seat is paid so once for the position, by the time in all its undecided mountings together. So the
//! schedule's time holds what the polytope asks for. (2) The equivalence theorem bounds the criterion on the polytope from
//! below at whatever design its sensitivities are taken, converged or not (see [`relax`](super::relaxation)). (3) The two
//! children of a node hold all its schedules, a child inherits the bound of its parent, and [`Plan::bound`] is the lowest bound
//! of the ends of all branches: left open, cut off against the best schedule, or not divided any further.

use rayon::prelude::*;

use super::candidates::{Candidates, Schedule};
use super::criterion::Criterion;
use super::error::PlanError;
use super::exchange::{Exchange, Whole};
use super::information::Scene;
use super::relaxation::{Polytope, Precision, Relaxed, relax};

/// How much is tried. The outcome depends on it, never on the clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Effort {
    /// Nodes that decide on mountings.
    pub mounting_nodes: usize,
    /// Nodes that decide on visits.
    pub visit_nodes: usize,
    /// Exchanges tried in each schedule.
    pub trials: usize,
}

impl Effort {
    /// Some seconds' worth: fewer nodes over mountings where there are more plateaus to choose from.
    pub fn usual(plateaus: usize) -> Self {
        Self { mounting_nodes: (200_000 / plateaus.max(1)).clamp(20, 1000), visit_nodes: 0, trials: 120 }
    }

    /// Until no other set of mountings can hold a plan that is better by more than 0.1 % of the uncertainty.
    pub const CERTIFIED: Self = Self { mounting_nodes: 1 << 20, visit_nodes: 0, trials: 120 };

    /// Until nothing is left to find: for small problems.
    pub const EXHAUSTIVE: Self = Self { mounting_nodes: 1 << 20, visit_nodes: 1 << 20, trials: 200 };

    /// One schedule, with no exchange of mountings and no bound over sets of them.
    pub const QUICK: Self = Self { mounting_nodes: 1, visit_nodes: 0, trials: 60 };

    /// Mountings exchanged, and the bound of the first continuous design.
    pub const FAIR: Self = Self { mounting_nodes: 2, visit_nodes: 0, trials: 60 };
}

/// A plan, and how far it can be from the best one.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// What is to be done.
    pub schedule: Schedule,
    /// The criterion, in variance units: see [`Criterion`]; a geometric mean over scenarios.
    pub criterion: f64,
    /// No schedule of these candidates in this time has a lower criterion.
    pub bound: f64,
    /// The continuous design on the plan's mountings, with the bound of the equivalence theorem.
    pub continuous: Relaxed,
    /// Nodes of the branch and bound.
    pub nodes: usize,
}

impl Plan {
    /// Part of the criterion by which the schedule may be above the best one.
    pub fn gap(&self) -> f64 {
        self.criterion / self.bound - 1.0
    }

    /// Part of the criterion that whole visits cost against the continuous design on the same mountings.
    pub fn rounding(&self) -> f64 {
        self.criterion / self.continuous.value.exp() - 1.0
    }
}

/// The best schedule within `time` [s].
///
/// # Errors
/// [`PlanError`] when nothing can be planned.
pub fn best_for_time(
    candidates: &Candidates,
    criterion: &Criterion,
    time: f64,
    effort: Effort,
) -> Result<Plan, PlanError> {
    let problem = Problem::new(candidates, criterion)?;
    problem.check_time(time)?;
    Ok(Tree::new(&problem, time, effort).run())
}

/// The shortest schedule that keeps every goal, to `resolution` of its time (0.01: 1 %).
///
/// # Errors
/// [`PlanError::OutOfReach`] when no schedule does; otherwise as [`best_for_time`].
pub fn shortest_for_goals(
    candidates: &Candidates,
    criterion: &Criterion,
    resolution: f64,
    effort: Effort,
) -> Result<Plan, PlanError> {
    let problem = Problem::new(candidates, criterion)?;
    let everything = problem.everything();
    if everything.value > 0.0 {
        return Err(PlanError::OutOfReach { factor: (0.5 * everything.value).exp() });
    }
    let plan = |time: f64, effort: Effort| Tree::new(&problem, time, effort).run();
    // No schedule is shorter than the continuous design that reaches the goals.
    let (mut below, mut above) = (problem.least_time(), everything.time);
    while above / below > 1.0 + 0.25 * resolution {
        let middle = (below * above).sqrt();
        let reaches = Tree::new(&problem, middle, effort).relaxed_reaches();
        if reaches { above = middle } else { below = middle }
    }
    let shortest = below;
    let (mut step, mut best) = (resolution, None);
    let mut time = shortest;
    while best.is_none() {
        time = (shortest * (1.0 + step)).min(everything.time);
        let found = plan(time, Effort::FAIR);
        if found.criterion <= 1.0 {
            best = Some(found);
        } else if time >= everything.time {
            return Ok(Plan { schedule: candidates.schedule(everything.visits(candidates)), ..found });
        }
        step *= 2.0;
    }
    let mut low = shortest * (1.0 + 0.25 * step);
    while time / low > 1.0 + resolution {
        let middle = (low * time).sqrt();
        let found = plan(middle, Effort::FAIR);
        if found.criterion <= 1.0 { (time, best) = (middle, Some(found)) } else { low = middle }
    }
    let thorough = plan(time, effort);
    Ok(best.filter(|quick| quick.criterion < thorough.criterion || thorough.criterion > 1.0).unwrap_or(thorough))
}

/// Candidates and criterion made ready.
pub(super) struct Problem<'a> {
    pub candidates: &'a Candidates,
    pub scenes: Vec<Scene>,
}

impl<'a> Problem<'a> {
    pub fn new(candidates: &'a Candidates, criterion: &Criterion) -> Result<Self, PlanError> {
        candidates.check()?;
        let total: f64 = candidates.scenarios.iter().map(|s| s.weight).sum();
        let scene = |scenario| Scene::new(scenario, candidates, criterion, total);
        Ok(Self { candidates, scenes: candidates.scenarios.iter().map(scene).collect::<Result<_, _>>()? })
    }

    fn mountings(&self) -> usize {
        self.candidates.experiment().mountings.len()
    }

    fn mounting_of(&self, atom: usize) -> usize {
        self.candidates.experiment().set_points[atom / self.candidates.durations.len()].mounting
    }

    fn price(&self, atom: usize) -> f64 {
        let options = self.candidates.durations.len();
        self.candidates.overhead(atom / options) + self.candidates.durations[atom % options]
    }

    fn atoms(&self) -> usize {
        self.candidates.len() * self.candidates.durations.len()
    }

    /// Time of the cheapest mounting with its shortest plateau [s].
    fn least_time(&self) -> f64 {
        let of_atom = |x: usize| {
            let mut used = vec![false; self.mountings()];
            used[self.mounting_of(x)] = true;
            self.candidates.set_up_time(&used) + self.price(x)
        };
        (0..self.atoms()).map(of_atom).fold(f64::INFINITY, f64::min)
    }

    fn check_time(&self, time: f64) -> Result<(), PlanError> {
        let least = self.least_time();
        if time.is_finite() && time >= least { Ok(()) } else { Err(PlanError::TooShort { found: time, least }) }
    }

    pub fn exchange<'b>(&'b self, time: f64, open: &'b [bool], trials: usize) -> Exchange<'b> {
        Exchange { candidates: self.candidates, scenes: &self.scenes, time, open, trials }
    }

    /// Every plateau as often and as long as may be.
    pub fn everything(&self) -> Whole {
        let options = self.candidates.durations.len();
        let repeats = u32::try_from(self.candidates.repeats).unwrap_or(u32::MAX);
        let counts = (0..self.atoms()).map(|x| if x % options == options - 1 { repeats } else { 0 }).collect();
        let open = vec![true; self.mountings()];
        self.exchange(f64::INFINITY, &open, 0).whole(counts)
    }
}

/// What is decided.
#[derive(Debug, Clone)]
struct Node {
    /// By mounting: set up, closed, or not decided.
    mountings: Vec<Option<bool>>,
    low: Vec<f64>,
    high: Vec<f64>,
    relaxed: Relaxed,
}

/// The search for the best schedule within a time.
struct Tree<'a> {
    problem: &'a Problem<'a>,
    time: f64,
    effort: Effort,
    open: Vec<Node>,
    best: Option<Whole>,
    /// Sets of mountings for which a schedule has been sought.
    tried: Vec<Vec<bool>>,
    /// Lowest bound of the nodes that are not divided any further.
    bound: f64,
    nodes: usize,
}

/// A node that no bound can cut off is known this well before it is divided (3 % of an uncertainty).
const LOOSE: f64 = 0.06;

/// Whole visits that cost more than this part of the criterion are exchanged at once.
const ROUGH: f64 = 0.01;

/// Known to this part of the criterion, nodes are not divided: where the best of all is sought, and where a plan that is
/// nearly as good will do (0.1 % of an uncertainty).
const SAME: f64 = 1e-7;
const NEARLY: f64 = 2e-3;

impl<'a> Tree<'a> {
    fn new(problem: &'a Problem<'a>, time: f64, effort: Effort) -> Self {
        Self { problem, time, effort, open: Vec::new(), best: None, tried: Vec::new(), bound: f64::INFINITY, nodes: 0 }
    }

    fn run(mut self) -> Plan {
        let root = self.root();
        self.nodes = 1;
        self.seek(&root);
        self.seek_on_all(&root);
        self.exchange_mountings();
        self.open.push(root);
        while let Some(node) = self.next() {
            self.divide(node);
        }
        self.polish();
        self.into_plan()
    }

    fn root(&self) -> Node {
        let atoms = self.problem.atoms();
        #[expect(clippy::cast_precision_loss, reason = "a handful of visits")]
        let high = self.problem.candidates.repeats as f64;
        let node = Node {
            mountings: vec![None; self.problem.mountings()],
            low: vec![0.0; atoms],
            high: vec![high; atoms],
            relaxed: Relaxed { visits: Vec::new(), value: f64::INFINITY, bound: f64::NEG_INFINITY, models: 0 },
        };
        self.relaxed_to(self.tolerance(), node, None).unwrap_or_else(|node| node)
    }

    /// Whether the continuous design reaches goals of 1.
    fn relaxed_reaches(&self) -> bool {
        self.root().relaxed.value <= 0.0
    }

    /// How near to the best schedule a bound is as good as the same.
    fn same(&self) -> f64 {
        if self.effort.visit_nodes > 0 { SAME } else { NEARLY }
    }

    /// How well a continuous design is known at the end of a branch.
    fn tolerance(&self) -> f64 {
        0.5 * self.same()
    }

    fn incumbent(&self) -> f64 {
        self.best.as_ref().map_or(f64::INFINITY, |best| best.value)
    }

    /// The open node of the lowest bound, if it may hold something better.
    fn next(&mut self) -> Option<Node> {
        let best = (0..self.open.len())
            .min_by(|&a, &b| self.open[a].relaxed.bound.total_cmp(&self.open[b].relaxed.bound).then(b.cmp(&a)))?;
        let node = self.open.swap_remove(best);
        let may_be_better = node.relaxed.bound < self.incumbent() - self.same();
        if !may_be_better {
            self.bound = self.bound.min(node.relaxed.bound);
        }
        may_be_better.then_some(node)
    }

    /// Two nodes that decide one thing more, or the end of this branch.
    fn divide(&mut self, node: Node) {
        let is_end = |of_mountings: Option<usize>| of_mountings.is_none() || self.nodes >= self.effort.mounting_nodes;
        let node = &if is_end(self.undecided(&node)) && node.relaxed.bound < self.bound {
            let start = node.relaxed.visits.clone();
            self.relaxed_to(self.tolerance(), node, Some(&start)).unwrap_or_else(|node| node)
        } else {
            node
        };
        let of_mountings = self.undecided(node);
        let decided = match of_mountings {
            Some(m) if self.nodes < self.effort.mounting_nodes => {
                let with = |set_up| {
                    let mut child = node.clone();
                    child.mountings[m] = Some(set_up);
                    child
                };
                vec![with(true), with(false)]
            }
            None => {
                self.seek(node);
                self.take_whole(node);
                let is_left =
                    self.nodes < self.effort.visit_nodes && node.relaxed.bound < self.incumbent() - self.same();
                match self.split_visit(node).filter(|_| is_left) {
                    Some((x, below, above)) => {
                        let (mut fewer, mut more) = (node.clone(), node.clone());
                        fewer.high[x] = below;
                        more.low[x] = above;
                        vec![more, fewer]
                    }
                    None => vec![],
                }
            }
            Some(_) => vec![],
        };
        if decided.is_empty() {
            self.bound = self.bound.min(node.relaxed.bound);
        }
        let start = &node.relaxed.visits;
        let children: Vec<_> = decided.into_par_iter().map(|child| self.relaxed(child, Some(start))).collect();
        for child in children {
            self.nodes += 1;
            if let Ok(child) = child {
                if child.relaxed.bound < self.incumbent() - self.same() {
                    self.open.push(child);
                } else {
                    self.bound = self.bound.min(child.relaxed.bound);
                }
            }
        }
    }

    /// The undecided mounting that the continuous design uses most.
    fn undecided(&self, node: &Node) -> Option<usize> {
        let used = self.times(node);
        let candidates = (0..used.len()).filter(|&m| node.mountings[m].is_none() && used[m] > 1e-6 * self.time);
        candidates.max_by(|&a, &b| used[a].total_cmp(&used[b]).then(b.cmp(&a)))
    }

    /// Time of the continuous design in each mounting [s].
    fn times(&self, node: &Node) -> Vec<f64> {
        let mut times = vec![0.0; self.problem.mountings()];
        for (x, w) in node.relaxed.visits.iter().enumerate() {
            times[self.problem.mounting_of(x)] += w * self.problem.price(x);
        }
        times
    }

    /// The atom whose visits are farthest from whole, or any that is not decided; and whole visits below and above.
    fn split_visit(&self, node: &Node) -> Option<(usize, f64, f64)> {
        let apart = |x: &usize| (node.relaxed.visits[*x] - node.relaxed.visits[*x].round()).abs();
        let free = || (0..node.low.len()).filter(|&x| node.high[x] > node.low[x] && self.is_open(node, x));
        let x = free().max_by(|a, b| apart(a).total_cmp(&apart(b)).then(b.cmp(a)))?;
        let w = node.relaxed.visits[x].clamp(node.low[x], node.high[x]);
        let below = if w >= node.high[x] { node.high[x] - 1.0 } else { w.floor() };
        Some((x, below, below + 1.0))
    }

    fn is_open(&self, node: &Node, atom: usize) -> bool {
        node.mountings[self.problem.mounting_of(atom)] != Some(false)
    }

    /// The node with its continuous design; the node itself if nothing fits into it.
    fn relaxed(&self, node: Node, start: Option<&[f64]>) -> Result<Node, Node> {
        let is_decided = node.mountings.iter().all(Option::is_some);
        self.relaxed_to(if is_decided { self.tolerance() } else { LOOSE }, node, start)
    }

    fn relaxed_to(&self, loose: f64, mut node: Node, start: Option<&[f64]>) -> Result<Node, Node> {
        let polytope = self.polytope(&node);
        if !polytope.is_feasible() {
            return Err(node);
        }
        let precision = Precision { tolerance: self.tolerance(), loose, enough: self.incumbent() - self.same() };
        // What bounds all below the parent bounds all below its child.
        let inherited = node.relaxed.bound;
        node.relaxed = relax(&self.problem.scenes, &polytope, start, precision);
        node.relaxed.bound = node.relaxed.bound.max(inherited);
        Ok(node)
    }

    /// The bounds of a node, with set-ups paid where they are decided and in proportion where they are not.
    fn polytope(&self, node: &Node) -> Polytope {
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
        let factors: Vec<f64> = (0..problem.mountings()).map(|m| 1.0 + surcharge(m).max(0.0)).collect();
        let high = |x: usize| if self.is_open(node, x) { node.high[x] } else { node.low[x] };
        Polytope {
            price: (0..problem.atoms()).map(|x| problem.price(x) * factors[problem.mounting_of(x)]).collect(),
            time,
            low: node.low.clone(),
            high: (0..problem.atoms()).map(high).collect(),
            options,
            repeats: candidates.repeats as f64,
        }
    }

    /// Seeks a schedule on the mountings that the node's continuous design uses.
    fn seek(&mut self, node: &Node) {
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
        if let Some(relaxed) = relaxed.filter(|relaxed| relaxed.bound < self.incumbent() - self.same()) {
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
    fn polish(&mut self) {
        if let Some(best) = self.best.take() {
            let set = self.mountings_of(&best);
            self.best = Some(self.problem.exchange(self.time, &set, self.effort.trials).improve(best));
        }
    }

    /// Seeks a schedule on all mountings, if their set-ups leave time to measure.
    fn seek_on_all(&mut self, root: &Node) {
        let all = vec![true; self.problem.mountings()];
        let fits = self.problem.candidates.set_up_time(&all) < self.time;
        if fits && self.effort.mounting_nodes > 1 && !self.tried.contains(&all) {
            let relaxed = self.restricted(&all, &root.relaxed.visits);
            self.round(all, relaxed);
        }
    }

    /// One mounting left out, or taken in besides, as long as that is better.
    fn exchange_mountings(&mut self) {
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
            if self.incumbent() >= best.value {
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
    fn take_whole(&mut self, node: &Node) {
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

    fn into_plan(self) -> Plan {
        let open = vec![true; self.problem.mountings()];
        let candidates = self.problem.candidates;
        let best = self.best.clone().unwrap_or_else(|| {
            // Nothing but the cheapest start fits.
            let exchange = self.problem.exchange(self.time, &open, self.effort.trials);
            exchange.improve(exchange.fill(exchange.whole(vec![0; self.problem.atoms()])))
        });
        let bound = self.open.iter().map(|node| node.relaxed.bound).fold(self.bound, f64::min).min(best.value);
        let used: Vec<Option<bool>> = {
            let mut used = vec![false; self.problem.mountings()];
            (0..best.counts.len())
                .filter(|&x| best.counts[x] > 0)
                .for_each(|x| used[self.problem.mounting_of(x)] = true);
            used.into_iter().map(Some).collect()
        };
        let start: Vec<f64> = best.counts.iter().map(|n| f64::from(*n)).collect();
        let atoms = self.problem.atoms();
        let node = Node {
            mountings: used,
            low: vec![0.0; atoms],
            high: vec![candidates.repeats as f64; atoms],
            relaxed: Relaxed { visits: start.clone(), value: best.value, bound: f64::NEG_INFINITY, models: 0 },
        };
        let polytope = self.polytope(&node);
        let continuous = relax(&self.problem.scenes, &polytope, Some(&start), Precision::of(5e-4));
        Plan {
            schedule: candidates.schedule(best.visits(candidates)),
            criterion: best.value.exp(),
            bound: bound.exp(),
            continuous,
            nodes: self.nodes,
        }
    }
}
