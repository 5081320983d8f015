//! The best schedule for a time, and the shortest for given goals: by branch and bound over mountings ([`tree`]).

mod problem;
mod seek;
mod tree;

pub(super) use self::problem::Problem;
use self::tree::Tree;
use super::candidates::{Candidates, Schedule};
use super::criterion::Criterion;
use super::error::PlanError;
use super::relaxation::Relaxed;

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

    /// Until no other set of mountings can hold a plan that is better by more than 0.25 % of the uncertainty.
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
    /// The criterion, in variance units: see [`Criterion`]; of several scenarios their mean or worst, as asked.
    pub criterion: f64,
    /// The criterion in each scenario.
    pub by_scenario: Vec<f64>,
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
    // A plan that reaches them in a time, or none; where the search ran to its end there is none.
    let fast = Effort { mounting_nodes: effort.mounting_nodes.div_ceil(4), ..effort };
    let search = |time: f64| Tree { wanted: Some(0.0), ..Tree::new(&problem, time, fast) };
    let reached = |time: f64| Some(search(time).run()).filter(|plan| plan.criterion <= 1.0);
    // The shortest plan on the mountings of one that reaches them.
    let on_its_mountings = |mut plan: Plan| {
        let used = problem.mountings_of(&plan.schedule);
        let (mut low, mut time) = (candidates.set_up_time(&used), plan.schedule.time);
        while time / low > 1.0 + resolution {
            let middle = (low * time).sqrt();
            let shorter = search(middle).run_on(used.clone(), &plan.continuous.visits);
            if shorter.criterion <= 1.0 {
                (time, plan) = (middle, shorter);
            } else {
                low = middle;
            }
        }
        (time, plan)
    };
    // No schedule is shorter than the continuous design that reaches the goals.
    let (mut below, mut above) = (problem.least_time(), everything.time);
    while above / below > 1.0 + 0.25 * resolution {
        let middle = (below * above).sqrt();
        let reaches = Tree::new(&problem, middle, effort).relaxed_reaches();
        if reaches { above = middle } else { below = middle }
    }
    let mut step = resolution;
    let mut best = loop {
        let time = (below * (1.0 + step)).min(everything.time);
        if let Some(plan) = reached(time) {
            break plan;
        }
        if time >= everything.time {
            let plan = Tree::new(&problem, time, effort).run();
            return Ok(Plan { schedule: candidates.schedule(everything.visits(candidates)), ..plan });
        }
        step *= 2.0;
    };
    // The best plan for that time reaches more than the goals: its mountings reach them in less, and so on.
    loop {
        let (time, shorter) = on_its_mountings(best);
        let thorough = Tree::new(&problem, time, effort).run();
        let is_better = thorough.criterion < shorter.criterion;
        let (next_time, next) = if is_better { on_its_mountings(thorough.clone()) } else { (time, shorter.clone()) };
        if next_time * (1.0 + resolution) > time {
            // What else this time is good for, and a bound of its own.
            return Ok(if thorough.criterion <= 1.0 { thorough } else { shorter });
        }
        best = next;
    }
}
