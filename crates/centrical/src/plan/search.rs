//! The best schedule for a time, and the shortest for given goals: by branch and bound over mountings.

mod heuristics;
mod incumbent;
mod node;
mod problem;
mod set_up_bound;
mod shortest;
mod tree;

pub use self::incumbent::Plan;
pub use self::problem::Effort;
pub(super) use self::problem::Problem;
use self::shortest::Shortest;
use self::tree::Tree;
use super::candidates::Candidates;
use super::criterion::Criterion;
use super::error::PlanError;

/// The best schedule within `time` [s].
///
/// # Errors
/// [`PlanError`] when there is no plan.
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

/// The shortest schedule that meets every goal, to `resolution` of its time (0.01: 1 %), and a time in which no schedule does.
///
/// # Errors
/// [`PlanError::OutOfReach`] when no schedule does; otherwise as [`best_for_time`].
pub fn shortest_for_goals(
    candidates: &Candidates,
    criterion: &Criterion,
    resolution: f64,
    effort: Effort,
) -> Result<Plan, PlanError> {
    Ok(Shortest::new(&Problem::new(candidates, criterion)?, resolution, effort)?.run())
}
