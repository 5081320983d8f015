//! Time against uncertainty: the best plans, and a uniform plan for the same time.

use super::candidates::{Candidates, Schedule, Visit};
use super::criterion::Criterion;
use super::error::PlanError;
use super::search::{Effort, Plan, Problem};
use crate::progress::{OnProgress, unwatched};

impl Candidates {
    /// The best plan for each of some `times` [s], which stands before it; times that are too short for anything are left out.
    ///
    /// # Errors
    /// As [`Self::best_for_time`], but for the time.
    pub fn frontier(
        &self,
        criterion: &Criterion,
        times: &[f64],
        progress: OnProgress<()>,
    ) -> Result<Vec<(f64, Plan)>, PlanError> {
        let mut points = Vec::with_capacity(times.len());
        for &time in times {
            match self.best_for_time(criterion, time, Effort::usual(self), progress) {
                Ok(plan) => points.push((time, plan)),
                Err(PlanError::TooShort { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(points)
    }

    /// The uniform plan: every candidate once, all for the longest of the durations for which `time` [s] suffices. It is one of
    /// the plans that a search considers, so no bound is above it. Returns the schedule and its criterion (variance units);
    /// `None` if the time suffices for no duration.
    ///
    /// # Errors
    /// As [`Self::best_for_time`], but for the time.
    pub fn uniform(&self, criterion: &Criterion, time: f64) -> Result<Option<(Schedule, f64)>, PlanError> {
        let longest = self.durations.iter().rev().find(|duration| self.time_of(&self.each_once(**duration)) <= time);
        longest.map(|duration| self.valued(criterion, *duration)).transpose()
    }

    /// Every candidate once, all for the duration that fills `time` [s], which need not be one of the durations.
    ///
    /// # Errors
    /// As [`Self::best_for_time`], but for the time.
    pub fn filled(&self, criterion: &Criterion, time: f64) -> Result<Option<(Schedule, f64)>, PlanError> {
        let duration = (time - self.time_of(&self.each_once(0.0))) / self.len() as f64;
        (duration > 0.0).then(|| self.valued(criterion, duration)).transpose()
    }

    fn each_once(&self, duration: f64) -> Vec<Visit> {
        (0..self.len()).map(|candidate| Visit { candidate, duration }).collect()
    }

    fn valued(&self, criterion: &Criterion, duration: f64) -> Result<(Schedule, f64), PlanError> {
        let only = Self { durations: vec![duration], repeats: 1, ..self.clone() };
        let value = Problem::new(&only, criterion, &unwatched)?.everything().value;
        Ok((only.schedule(self.each_once(duration)), value.exp()))
    }
}
