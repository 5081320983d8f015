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
use crate::progress::OnProgress;

impl Candidates {
    /// The best schedule within `time` [s]. `progress` is called again and again and can only stop the search.
    ///
    /// # Errors
    /// [`PlanError`] when there is no plan, or the caller stops.
    pub fn best_for_time(
        &self,
        criterion: &Criterion,
        time: f64,
        effort: Effort,
        progress: OnProgress<()>,
    ) -> Result<Plan, PlanError> {
        let problem = Problem::new(self, criterion, progress)?;
        problem.check_time(time)?;
        Ok(problem.watch.found(Tree::new(&problem, time, effort).run())?)
    }

    /// The shortest schedule that meets every goal, to `resolution` of its time (0.01: 1 %), and a time in which no schedule does.
    ///
    /// # Errors
    /// [`PlanError::OutOfReach`] when no schedule does; otherwise as [`Candidates::best_for_time`].
    pub fn shortest_for_goals(
        &self,
        criterion: &Criterion,
        resolution: f64,
        effort: Effort,
        progress: OnProgress<()>,
    ) -> Result<Plan, PlanError> {
        let problem = Problem::new(self, criterion, progress)?;
        Ok(problem.watch.found(Shortest::new(&problem, resolution, effort)?.run())?)
    }
}
