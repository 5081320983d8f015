//! What is to be planned, and the search over goals.
//!
//! Goals are combined uncertainties: the search knows of what the laboratory states as a fit does, as unknowns with priors.

use super::candidates::{Candidates, Schedule, Visit};
use super::criterion::{Criterion, Goal};
use super::error::PlanError;
use super::prediction::Prediction;
use super::search::{Effort, Plan};
use crate::model::{FitError, MeasurementModel, Parameter};
use crate::progress::OnProgress;

/// The shortest plan is sought to this part of its time.
const RESOLUTION: f64 = 0.01;

/// What is to be planned.
#[derive(Debug, Clone, PartialEq)]
pub struct Task {
    /// What can be chosen.
    pub candidates: Candidates,
    /// What is made small within `time`, or the goals to be reached in the shortest time.
    pub criterion: Criterion,
    /// Available time [s].
    pub time: Option<f64>,
}

impl Task {
    /// The best plan for the time, or the shortest for the goals; `certify`: searched until every set of mountings is decided
    /// on.
    ///
    /// A plan that leaves combinations of unknowns open may meet its goals for a unit without errors and miss them for any other
    /// (see [`predict`]). One that does is planned again for a unit of typical errors, which `self` expects from then on.
    ///
    /// # Errors
    /// [`PlanError`] when there is no plan, or the caller stops.
    pub fn plan(&mut self, certify: bool, progress: OnProgress<()>) -> Result<Plan, PlanError> {
        let effort = self.effort(certify);
        let expects_none = self.candidates.scenarios.iter().all(|s| s.nominal.iter().all(|value| *value == 0.0));
        if self.time.is_some() || !expects_none {
            return self.search(effort, progress);
        }
        // A hasty plan mostly shows whether a good one would meet the goals.
        let hasty = self.search(Effort::QUICK, progress)?;
        if self.meets_goals(&hasty)? {
            let plan = self.search(effort, progress)?;
            if self.meets_goals(&plan)? {
                return Ok(plan);
            }
        }
        for scenario in &mut self.candidates.scenarios {
            scenario.nominal = scenario.model.parameters().typical_alternating();
        }
        self.search(effort, progress)
    }

    /// The model of the first scenario.
    pub fn model(&self) -> &MeasurementModel {
        &self.candidates.scenarios[0].model
    }

    /// The goals, if the criterion is the worst of them.
    pub fn goals(&self) -> &[Goal] {
        if let Criterion::Worst(goals) = &self.criterion { goals } else { &[] }
    }

    /// The uncertainties after a schedule in the first scenario.
    ///
    /// # Errors
    /// [`FitError`] when its numbers are beyond all measure.
    pub fn predict(&self, schedule: &Schedule) -> Result<Prediction, FitError> {
        let (experiment, weights) = self.candidates.experiment_of(schedule);
        let scenario = &self.candidates.scenarios[0];
        let model = scenario.model.in_experiment(experiment);
        let expected = |p: &Parameter| scenario.model.parameters().find(&p.name).map_or(0.0, |j| scenario.nominal[j]);
        let nominal: Vec<f64> = model.parameters().iter().map(expected).collect();
        Prediction::of(&model, &weights, &nominal)
    }

    /// The goals as a prediction reaches them: standard uncertainty by noise, speeds and priors (type A), by the stated type B, which no plan
    /// lowers by much, and combined; `None` where it is not determined.
    pub fn reached(&self, prediction: &Prediction) -> Vec<[Option<f64>; 3]> {
        let reached = |goal: &Goal| {
            let [type_a, combined] = match goal {
                Goal::Parameter { name, .. } => {
                    let j = prediction.model().parameters().find(name);
                    [j.and_then(|j| prediction.type_a(j)), j.and_then(|j| prediction.standard_uncertainty(j))]
                }
                Goal::Reading { range, .. } => {
                    let reading = prediction.reading(*range);
                    [reading.map(|[a, _]| a), reading.map(|[_, all]| all)]
                }
            };
            let rest = |(all, a): (f64, f64)| (all * all - a * a).max(0.0).sqrt();
            [type_a, combined.zip(type_a).map(rest), combined]
        };
        self.goals().iter().map(reached).collect()
    }

    fn effort(&self, certify: bool) -> Effort {
        let usual = Effort::usual(&self.candidates);
        match self.time {
            _ if certify => Effort::CERTIFIED,
            Some(_) => usual,
            // The shortest plan is sought by a search for each of some times.
            None => Effort { nodes: 2 + usual.nodes / 6, ..usual },
        }
    }

    /// Whether every goal is met as predicted, type B included.
    fn meets_goals(&self, plan: &Plan) -> Result<bool, PlanError> {
        let reached = self.reached(&self.predict(&plan.schedule)?);
        let is_met =
            |(goal, [_, _, combined]): (&Goal, [Option<f64>; 3])| combined.is_some_and(|u| u <= goal.uncertainty());
        Ok(self.goals().iter().zip(reached).all(is_met))
    }

    fn search(&self, effort: Effort, progress: OnProgress<()>) -> Result<Plan, PlanError> {
        if self.time.is_none() && !self.model().influences().is_empty() {
            self.check_type_b()?;
        }
        self.best(&self.criterion, effort, progress)
    }

    /// A goal below what type B leaves of it with every candidate as often and as long as possible cannot be reached.
    fn check_type_b(&self) -> Result<(), PlanError> {
        let reached = self.reached(&self.predict(&self.everything())?);
        for (goal, [_, type_b, _]) in self.goals().iter().zip(reached) {
            let factor = type_b.unwrap_or(0.0) / goal.uncertainty();
            if factor >= 1.0 {
                return Err(PlanError::BelowTypeB { name: goal.name().to_owned(), factor });
            }
        }
        Ok(())
    }

    fn best(&self, criterion: &Criterion, effort: Effort, progress: OnProgress<()>) -> Result<Plan, PlanError> {
        match self.time {
            Some(time) => self.candidates.best_for_time(criterion, time, effort, progress),
            None => self.candidates.shortest_for_goals(criterion, RESOLUTION, effort, progress),
        }
    }

    /// Every candidate as often and as long as possible.
    fn everything(&self) -> Schedule {
        let candidates = &self.candidates;
        let longest = candidates.durations.last().copied().unwrap_or(0.0);
        let visit = |candidate: usize| {
            std::iter::repeat_n(Visit { candidate, duration: longest }, candidates.most_visits(candidate))
        };
        candidates.schedule((0..candidates.len()).flat_map(visit).collect())
    }
}
