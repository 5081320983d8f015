//! Branches on visits. Neighbouring speeds are nearly the same, so that to decide on one of them decides nothing; but how often
//! a mounting is measured at rest, or in a part of its speeds, is a whole number too. A node is divided by the total of such a
//! set: at most so many visits, or one more. Every schedule of the node is in one of the two, and the equivalence theorem bounds
//! both, the totals being charged for at any price (see [`Polytope::most_charged`](crate::plan::relaxation::Polytope)).
//!
//! Which set is tried on some (strong branching) until it is known by experience (pseudo-costs; Achterberg, Koch and Martin
//! 2005, "Branching rules revisited"); sides that are cut off in a trial narrow the node.

use std::sync::Arc;

use rayon::prelude::*;

use super::problem::Problem;
use super::tree::{Node, Tree};
use crate::plan::relaxation::{Total, visits_in};

/// A set of visits that are alike.
#[derive(Debug, Clone)]
pub(super) struct Alike {
    mounting: usize,
    atoms: Arc<[usize]>,
    /// Whether it is all visits of the mounting.
    is_all: bool,
}

/// Totals that are tried before a node is divided by one of them.
const TRIED: usize = 6;

/// Totals that are whole but for this part are left until there are no others.
const NEARLY_WHOLE: f64 = 0.02;
const WHOLE: f64 = 1e-3;

/// A bound rises by no less, for comparison.
const LEAST_RISE: f64 = 1e-5;

/// Trials after which a set is known.
const ENOUGH: usize = 4;

/// Of so many nodes that are divided by visits one is made whole.
const SOUGHT_EVERY: usize = 8;

/// Of two sets whose totals differ by less the smaller one says nothing new.
const SAME_TOTAL: f64 = 5e-3;

impl Alike {
    /// By mounting: all visits, those at rest and those while spinning, halves of the speeds and halves of these, down to single
    /// plateaus and to one duration of each. Any two hold one another or have nothing in common.
    pub fn all(problem: &Problem) -> Vec<Self> {
        let set_points = &problem.candidates.experiment().set_points;
        let mut all = Vec::new();
        for mounting in 0..problem.mountings() {
            let mut plateaus: Vec<usize> =
                (0..set_points.len()).filter(|&c| set_points[c].mounting == mounting).collect();
            let speed = |c: usize| set_points[c].omega.abs();
            plateaus.sort_by(|&a, &b| speed(a).total_cmp(&speed(b)).then(a.cmp(&b)));
            let first = all.len();
            let at_rest = plateaus.partition_point(|&c| set_points[c].is_rest());
            halved(problem, mounting, &plateaus, at_rest, &mut all);
            if let Some(whole) = all.get_mut(first) {
                whole.is_all = true;
            }
        }
        all
    }
}

fn halved(problem: &Problem, mounting: usize, plateaus: &[usize], at: usize, all: &mut Vec<Alike>) {
    let options = problem.candidates.durations.len();
    let mut push = |atoms: &mut dyn Iterator<Item = usize>| {
        let mut atoms: Vec<usize> = atoms.collect();
        atoms.sort_unstable();
        all.push(Alike { mounting, atoms: atoms.into(), is_all: false });
    };
    let atoms_of = |c: usize| c * options..(c + 1) * options;
    match plateaus {
        [] => {}
        &[c] => {
            push(&mut atoms_of(c));
            if options > 1 {
                atoms_of(c).for_each(|x| push(&mut std::iter::once(x)));
            }
        }
        _ => {
            push(&mut plateaus.iter().flat_map(|&c| atoms_of(c)));
            // Nothing but rest, or none: by half.
            let at = if at == 0 || at >= plateaus.len() { plateaus.len() / 2 } else { at };
            let (below, above) = plateaus.split_at(at);
            halved(problem, mounting, below, 0, all);
            halved(problem, mounting, above, 0, all);
        }
    }
}

/// By how much a bound rises for a visit less, or more, of a set: the mean of what was seen.
#[derive(Debug, Clone, Copy, Default)]
struct Seen {
    rise: f64,
    times: usize,
}

/// What divisions by each set have shown, `[more, fewer]`.
#[derive(Debug, Clone, Default)]
pub(super) struct Experience(Vec<[Seen; 2]>);

impl Experience {
    pub fn of(alike: &[Alike]) -> Self {
        Self(vec![Default::default(); alike.len()])
    }

    fn is_enough(&self, set: usize) -> bool {
        self.0[set].iter().all(|seen| seen.times >= ENOUGH)
    }

    fn add(&mut self, set: usize, side: usize, rise: f64) {
        let seen = &mut self.0[set][side];
        seen.rise += (rise - seen.rise) / (seen.times + 1) as f64;
        seen.times += 1;
    }
}

/// A set whose visits are not whole in a continuous design.
struct InParts {
    set: usize,
    total: f64,
    /// Product of what the bounds of both sides are expected to rise by.
    expected: f64,
}

/// Score of a division, its sides, and these with their continuous designs.
type Tried = (f64, Vec<Node>, Vec<Option<Node>>);

impl InParts {
    /// Change of the visits to the next whole number, `[up, down]`.
    fn changes(&self) -> [f64; 2] {
        [self.total.ceil() - self.total, self.total - self.total.floor()]
    }
}

impl Tree<'_> {
    /// Divides a node by a total, if it may hold something better and there are nodes left: by the one that raises the bounds of
    /// both sides most, as tried or as often seen before. A side that is cut off needs no division: all that is found on the
    /// way to hold for the whole node is put into it.
    pub fn divide_by_visits(&mut self, node: &Node) -> bool {
        let is_near = node.relaxed.bound >= self.threshold().min(self.incumbent() - self.effort.visits_open);
        if self.visit_nodes >= self.effort.visit_nodes || is_near {
            return false;
        }
        if !self.effort.is_exact && self.visit_nodes.is_multiple_of(SOUGHT_EVERY) {
            self.round_visits(node);
        }
        let all = [NEARLY_WHOLE, WHOLE].into_iter().filter(|_| !self.effort.is_exact);
        let mut all = all.map(|whole| self.in_parts(node, whole)).filter(|parts| !parts.is_empty());
        let mut parts = all.next().unwrap_or_default();
        if parts.is_empty() {
            let Some(sides) = self.by_one_visit(node) else { return false };
            let sides = self.relaxed(vec![sides]).swap_remove(0);
            self.keep(sides);
            return true;
        }
        parts.truncate(TRIED);
        let (known, new): (Vec<InParts>, Vec<InParts>) =
            parts.into_iter().partition(|parts| self.experience.is_enough(parts.set));
        let mut tried = self.tried(node, new);
        let best_tried = tried.iter().map(|(score, _, _)| *score).fold(0.0, f64::max);
        // The best of those that are known, where no trial has shown a better one.
        let best_known = known.into_iter().take(1).filter(|known| known.expected > best_tried);
        tried.extend(self.tried(node, best_known.collect()));
        if let Some(narrowed) = self.narrowed(node, &tried) {
            let sides = self.relaxed(vec![vec![narrowed]]).swap_remove(0);
            self.keep(sides);
            return true;
        }
        let best = (0..tried.len()).max_by(|&a, &b| tried[a].0.total_cmp(&tried[b].0).then(b.cmp(&a)));
        let Some(best) = best else { return false };
        self.keep(tried.swap_remove(best).2);
        true
    }

    /// Divisions with their scores, as they were and as they are relaxed; a side that is cut off or empty is none.
    fn tried(&mut self, node: &Node, parts: Vec<InParts>) -> Vec<Tried> {
        let divisions: Vec<Vec<Node>> =
            parts.iter().map(|p| self.by_total(node, &self.alike[p.set], p.total.floor())).collect();
        let relaxed = self.relaxed(divisions.clone());
        let threshold = self.threshold();
        let cut_off = (threshold - node.relaxed.bound).max(LEAST_RISE);
        let mut tried = Vec::with_capacity(parts.len());
        for ((parts, sides), relaxed) in parts.into_iter().zip(divisions).zip(relaxed) {
            let mut score = 1.0;
            for (side, change) in parts.changes().into_iter().enumerate() {
                let there = relaxed.get(side).and_then(Option::as_ref);
                let rise = there.map_or(cut_off, |side| side.relaxed.bound.min(threshold) - node.relaxed.bound);
                self.experience.add(parts.set, side, rise / change);
                score *= rise.max(LEAST_RISE);
            }
            tried.push((score, sides, relaxed));
        }
        tried
    }

    /// Nodes with their continuous designs, none where nothing fits.
    fn relaxed(&self, divisions: Vec<Vec<Node>>) -> Vec<Vec<Option<Node>>> {
        let counts: Vec<usize> = divisions.iter().map(Vec::len).collect();
        let relaxed = |mut side: Node| {
            let start = side.relaxed.visits.clone();
            self.relax(&mut side, Some(&start)).then_some(side)
        };
        let sides: Vec<Node> = divisions.into_iter().flatten().collect();
        let mut relaxed = sides.into_par_iter().map(relaxed).collect::<Vec<_>>().into_iter();
        counts.into_iter().map(|count| relaxed.by_ref().take(count).collect()).collect()
    }

    /// The node with all that holds for whatever is better in it: the side that is left of each division that has another one
    /// cut off.
    fn narrowed(&mut self, node: &Node, tried: &[Tried]) -> Option<Node> {
        let mut narrowed: Option<Node> = None;
        for (_, division, relaxed) in tried {
            let is_cut_off =
                |side: &Option<Node>| side.as_ref().is_none_or(|side| side.relaxed.bound >= self.threshold());
            let left: Vec<usize> = (0..relaxed.len()).filter(|&side| !is_cut_off(&relaxed[side])).collect();
            let &[left] = left.as_slice() else { continue };
            let cut_off =
                relaxed.iter().flatten().map(|side| side.relaxed.bound).filter(|bound| *bound >= self.threshold());
            self.bound = cut_off.fold(self.bound, f64::min);
            let into = narrowed.get_or_insert_with(|| node.clone());
            into.narrow(&division[left]);
            into.relaxed.bound =
                into.relaxed.bound.max(relaxed[left].as_ref().map_or(f64::NEG_INFINITY, |side| side.relaxed.bound));
        }
        narrowed
    }

    /// Leaves the parts of a node open, or counts their bounds.
    fn keep(&mut self, sides: Vec<Option<Node>>) {
        for side in sides {
            self.nodes += 1;
            self.visit_nodes += 1;
            let Some(side) = side else { continue };
            if side.relaxed.bound < self.threshold() {
                self.open.push(side);
            } else {
                self.bound = self.bound.min(side.relaxed.bound);
            }
        }
    }

    /// A schedule near the continuous design of a node.
    fn round_visits(&mut self, node: &Node) {
        let open: Vec<bool> = node.mountings.iter().map(|m| *m == Some(true)).collect();
        let exchange = self.problem.exchange(self.time, &open, self.effort.trials);
        let whole = exchange.improve(exchange.round(&node.relaxed.visits));
        if whole.value < self.incumbent() {
            self.best = Some(whole);
        }
    }

    /// Sets whose visits are not whole, the most promising first.
    fn in_parts(&self, node: &Node, whole: f64) -> Vec<InParts> {
        let w = &node.relaxed.visits;
        let cut_off = (self.threshold() - node.relaxed.bound).max(LEAST_RISE);
        let mut all: Vec<InParts> = Vec::new();
        for (set, alike) in self.alike.iter().enumerate() {
            let total = visits_in(&alike.atoms, w);
            let is_same = |other: &InParts| {
                self.alike[other.set].mounting == alike.mounting && (other.total - total).abs() < SAME_TOTAL
            };
            if (total - total.round()).abs() <= whole
                || node.mountings[alike.mounting] == Some(false)
                || all.iter().any(is_same)
            {
                continue;
            }
            let mut parts = InParts { set, total, expected: 1.0 };
            let time: f64 = alike.atoms.iter().map(|&x| w[x] * self.problem.price(x)).sum();
            for (change, seen) in parts.changes().into_iter().zip(&self.experience.0[set]) {
                // Not seen yet: what the time in the set brings, by the square of the change.
                let guess = time / self.time * (change / total).powi(2);
                let rise = if seen.times > 0 { seen.rise * change } else { guess };
                parts.expected *= rise.clamp(LEAST_RISE, cut_off);
            }
            all.push(parts);
        }
        all.sort_by(|a, b| b.expected.total_cmp(&a.expected).then(a.set.cmp(&b.set)));
        all
    }

    /// At most `below` visits of a set, and more.
    fn by_total(&self, node: &Node, alike: &Alike, below: f64) -> Vec<Node> {
        let (mut more, mut fewer) = (node.clone(), node.clone());
        if let [x] = *alike.atoms {
            (fewer.high[x], more.low[x]) = (below, below + 1.0);
        } else {
            let most = alike.atoms.len() as f64 * self.problem.candidates.repeats as f64;
            let total = |low: f64, high: f64| Total { atoms: alike.atoms.clone(), low, high };
            more.add(&total(below + 1.0, most));
            if below > 0.0 {
                fewer.add(&total(0.0, below));
            } else {
                alike.atoms.iter().for_each(|&x| fewer.high[x] = fewer.low[x]);
            }
        }
        // A mounting that is set up is used.
        if alike.is_all && below == 0.0 && node.mountings[alike.mounting] == Some(true) {
            return vec![more];
        }
        vec![more, fewer]
    }

    /// By the visits of the atom that are farthest from whole, or of any that is not decided.
    fn by_one_visit(&self, node: &Node) -> Option<Vec<Node>> {
        let apart = |x: &usize| (node.relaxed.visits[*x] - node.relaxed.visits[*x].round()).abs();
        let free = || (0..node.low.len()).filter(|&x| node.high[x] > node.low[x] && self.is_open(node, x));
        let x = free().max_by(|a, b| apart(a).total_cmp(&apart(b)).then(b.cmp(a)))?;
        let w = node.relaxed.visits[x].clamp(node.low[x], node.high[x]);
        let below = if w >= node.high[x] { node.high[x] - 1.0 } else { w.floor() };
        let (mut fewer, mut more) = (node.clone(), node.clone());
        (fewer.high[x], more.low[x]) = (below, below + 1.0);
        Some(vec![more, fewer])
    }
}

impl Node {
    fn add(&mut self, total: &Total) {
        match self.totals.iter_mut().find(|other| Arc::ptr_eq(&other.atoms, &total.atoms)) {
            Some(other) => (other.low, other.high) = (other.low.max(total.low), other.high.min(total.high)),
            None => self.totals.push(total.clone()),
        }
    }

    /// Narrows the bounds of visits to those of another node too.
    fn narrow(&mut self, other: &Self) {
        self.low.iter_mut().zip(&other.low).for_each(|(low, other)| *low = low.max(*other));
        self.high.iter_mut().zip(&other.high).for_each(|(high, other)| *high = high.min(*other));
        other.totals.iter().for_each(|total| self.add(total));
    }
}
