//! The best schedule for a time, and the shortest for given goals: by branch and bound over mountings ([`tree`]).

mod needs;
mod problem;
mod seek;
mod shortest;
mod tree;

pub(super) use self::problem::Problem;
use self::tree::Tree;
use super::candidates::{Candidates, Schedule};
use super::criterion::Criterion;
use super::error::PlanError;
use super::relaxation::Relaxed;

/// How much is tried. The outcome depends on it, never on the clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Nodes that decide on mountings.
    pub mounting_nodes: usize,
    /// Exchanges tried in each schedule.
    pub trials: usize,
}

impl Effort {
    /// Some seconds' worth: fewer nodes where there are more plateaus to choose from.
    pub fn usual(plateaus: usize) -> Self {
        Self { mounting_nodes: (300_000 / plateaus.max(1)).clamp(20, 1000), ..Self::CERTIFIED }
    }

    /// Until no node over mountings is open: what the bound then leaves is a matter of whole visits.
    pub const CERTIFIED: Self = Self { mounting_nodes: 1 << 20, trials: 120 };

    /// One schedule, with no exchange of mountings and no bound over sets of them.
    pub const QUICK: Self = Self { mounting_nodes: 1, trials: 60 };

    /// Mountings exchanged, and the bound of the first continuous design.
    pub const FAIR: Self = Self { mounting_nodes: 2, ..Self::QUICK };
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
    /// Of a plan for goals: no schedule of these candidates that is shorter than this keeps them [s].
    pub least_time: Option<f64>,
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

/// The shortest schedule that keeps every goal, to `resolution` of its time (0.01: 1 %), and a time in which none does.
///
/// # Errors
/// [`PlanError::OutOfReach`] when no schedule does; otherwise as [`best_for_time`].
pub fn shortest_for_goals(
    candidates: &Candidates,
    criterion: &Criterion,
    resolution: f64,
    effort: Effort,
) -> Result<Plan, PlanError> {
    Ok(shortest::Shortest::new(&Problem::new(candidates, criterion)?, resolution, effort)?.run())
}
