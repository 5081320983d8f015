//! What there is to say of a plan.

use centrical::plan::{Account, Criterion, Goal, Plan, PlanError, Prediction, Reason, Robustness, Schedule, predict};
use centrical::{Group, MeasurementModel, SetPoint};

use super::request::PlanRequest;
use crate::document::{
    CriterionName, GoalReport, PLAN_SCHEMA, PlanReport, PlannedMounting, PlannedPlateau, PredictionReport, Program,
    ReasonReport,
};
use crate::error::Error;
use crate::experiment::Planning;

impl Planning {
    /// What there is to say of a plan.
    ///
    /// # Errors
    /// [`Error`] when it cannot be predicted.
    pub fn report(&self, plan: &Plan, request: &PlanRequest) -> Result<PlanReport, Error> {
        let candidates = &self.candidates;
        let schedule = &plan.schedule;
        let account = Account::of(candidates, &self.criterion, schedule).map_err(|source| self.failed(source))?;
        let measuring: f64 = schedule.visits.iter().map(|v| v.duration).sum();
        let visits: f64 = schedule.visits.iter().map(|v| candidates.visit_time(v)).sum();
        let prediction = self.predict(schedule)?;
        Ok(PlanReport {
            schema: PLAN_SCHEMA,
            program: Program { name: "centrical".to_owned(), version: env!("CARGO_PKG_VERSION").to_owned() },
            title: self.title.clone(),
            criterion: match self.criterion {
                Criterion::Determinant => CriterionName::D,
                Criterion::Average => CriterionName::A,
                Criterion::Reading(_) => CriterionName::I,
                Criterion::Worst(_) => CriterionName::Worst,
            },
            value: plan.criterion.sqrt(),
            by_scenario: if plan.by_scenario.len() > 1 {
                plan.by_scenario.iter().map(|value| value.sqrt()).collect()
            } else {
                Vec::new()
            },
            against: match candidates.robustness {
                Robustness::Mean => "mean",
                Robustness::Worst => "worst",
            },
            bound: plan.bound.sqrt(),
            continuous: (0.5 * plan.continuous.value).exp(),
            continuous_gap: (1.0 + plan.continuous.gap()).sqrt() - 1.0,
            nodes: plan.nodes,
            least_time: plan.least_time,
            for_typical: candidates.scenarios[0].nominal == self.model().parameters().typical_alternating(),
            candidates: candidates.len(),
            time: schedule.time,
            time_by_use: [measuring, visits - measuring, schedule.time - visits],
            mountings: self.mountings(plan, &account),
            goals: self.goals_of(&prediction),
            prediction: PredictionReport::of(&prediction, self.range, request.coverage),
            frontier: self.frontier(schedule.time, request)?,
        })
    }

    /// What a schedule will know in the first scenario.
    ///
    /// # Errors
    /// [`Error::Fit`] when its numbers are beyond all measure.
    pub fn predict(&self, schedule: &Schedule) -> Result<Prediction, Error> {
        let (experiment, weights) = self.candidates.experiment_of(schedule);
        let scenario = &self.candidates.scenarios[0];
        let model = scenario.model.in_experiment(experiment);
        let expected =
            |p: &centrical::Parameter| scenario.model.parameters().find(&p.name).map_or(0.0, |j| scenario.nominal[j]);
        let nominal: Vec<f64> = model.parameters().iter().map(expected).collect();
        predict(&model, &weights, &self.type_b, &nominal)
            .map_err(|source| Error::Fit { file: self.file.clone(), source })
    }

    fn mountings(&self, plan: &Plan, account: &Account) -> Vec<PlannedMounting> {
        let experiment = self.candidates.experiment();
        let mut mountings = Vec::new();
        for (m, reason) in account.mountings.iter().enumerate() {
            let Some(reason) = reason else { continue };
            let there = |n: &usize| experiment.set_points[plan.schedule.visits[*n].plateau].mounting == m;
            let plateau = |n: usize| {
                let visit = &plan.schedule.visits[n];
                let SetPoint { omega, angle, .. } = experiment.set_points[visit.plateau];
                PlannedPlateau {
                    speed: omega.abs(),
                    angle,
                    duration: visit.duration,
                    reason: self.reason(&account.visits[n]),
                }
            };
            mountings.push(PlannedMounting {
                position: experiment.positions[experiment.mountings[m].position].id.clone(),
                radius: experiment.mountings[m].arm_y.x,
                reason: self.reason(reason),
                plateaus: (0..plan.schedule.visits.len()).filter(there).map(plateau).collect(),
            });
        }
        mountings
    }

    fn reason(&self, reason: &Reason) -> ReasonReport {
        ReasonReport {
            rise: (1.0 + reason.rise).sqrt() - 1.0,
            time: reason.time,
            parameter: self.model().parameters()[reason.parameter].name.clone(),
            factor: reason.factor,
        }
    }

    fn model(&self) -> &MeasurementModel {
        &self.candidates.scenarios[0].model
    }

    pub(crate) fn goals_of(&self, prediction: &Prediction) -> Vec<GoalReport> {
        let Criterion::Worst(goals) = &self.criterion else { return Vec::new() };
        let report = |goal: &Goal| {
            let report = match goal {
                Goal::Parameter { name, uncertainty } => {
                    let parameters = prediction.model().parameters();
                    // The goals were made from the names of these parameters.
                    let j = parameters.find(name)?;
                    GoalReport {
                        name: name.clone(),
                        unit: parameters[j].unit.clone(),
                        group: parameters[j].group,
                        wanted: *uncertainty,
                        type_a: prediction.type_a(j),
                        type_b: None,
                        combined: prediction.standard_uncertainty(j),
                    }
                }
                Goal::Reading { range, uncertainty } => {
                    let reading = prediction.reading(*range);
                    GoalReport {
                        name: "reading".to_owned(),
                        unit: "m/s^2".to_owned(),
                        group: Group::Bias,
                        wanted: *uncertainty,
                        type_a: reading.map(|[a, _]| a),
                        type_b: None,
                        combined: reading.map(|[_, all]| all),
                    }
                }
            };
            Some(report.with_type_b())
        };
        goals.iter().filter_map(report).collect()
    }

    pub(crate) fn failed(&self, source: PlanError) -> Error {
        Error::Planning { file: self.file.clone(), source }
    }
}
