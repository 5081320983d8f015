//! Time against uncertainty: the best plans, and a uniform plan for the same time.

use super::candidates::{Candidates, Schedule, Visit};
use super::criterion::Criterion;
use super::error::PlanError;
use super::search::{Effort, Plan, Problem, best_for_time};

/// The best plan for one time.
#[derive(Debug, Clone, PartialEq)]
pub struct FrontierPoint {
    /// Time given [s].
    pub time: f64,
    /// The plan.
    pub plan: Plan,
}

/// The best plans for some `times` [s], those that are too short for anything left out.
///
/// # Errors
/// As [`best_for_time`], but for the time.
pub fn frontier(
    candidates: &Candidates,
    criterion: &Criterion,
    times: &[f64],
    effort: Effort,
) -> Result<Vec<FrontierPoint>, PlanError> {
    let mut points = Vec::with_capacity(times.len());
    for &time in times {
        match best_for_time(candidates, criterion, time, effort) {
            Ok(plan) => points.push(FrontierPoint { time, plan }),
            Err(PlanError::TooShort { .. }) => {}
            Err(error) => return Err(error),
        }
    }
    Ok(points)
}

impl Candidates {
    /// The uniform plan: every candidate once, all for the same duration, in `time` [s]. Returns the schedule and its criterion
    /// (variance units); `None` if set-ups and ramps leave nothing to measure in.
    ///
    /// # Errors
    /// As [`best_for_time`], but for the time.
    pub fn uniform(&self, criterion: &Criterion, time: f64) -> Result<Option<(Schedule, f64)>, PlanError> {
        let visits = |duration: f64| (0..self.len()).map(|candidate| Visit { candidate, duration }).collect::<Vec<_>>();
        let duration = (time - self.time_of(&visits(0.0))) / self.len() as f64;
        if duration <= 0.0 {
            return Ok(None);
        }
        let uniform = Self { durations: vec![duration], repeats: 1, ..self.clone() };
        let value = Problem::new(&uniform, criterion)?.everything().value;
        Ok(Some((uniform.schedule(visits(duration)), value.exp())))
    }
}
