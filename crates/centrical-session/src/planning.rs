//! A plan as a document: schema `centrical-plan/1`. The same input gives the same bytes.

mod frontier;
mod schedule_file;
mod search;

use centrical::plan::{Account, Criterion, Goal, Plan, PlanError, Prediction, Reason, Robustness, Schedule, predict};
use centrical::{MeasurementModel, SetPoint};
use serde::Serialize;

use crate::error::Error;
use crate::prediction::PredictionReport;
use crate::result::Program;
use crate::session::Planning;

/// Name of the schema's present version.
const SCHEMA: &str = "centrical-plan/1";

/// Levels `m` of [K5.5] on the frontier unless others are given.
pub const USUAL_LEVELS: [f64; 4] = [0.0, 1.0, 2.0, 3.0];

/// What of a plan is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanRequest {
    /// Times of the frontier over that of the plan; none for no frontier.
    pub frontier: Vec<f64>,
    /// Levels `m` of [K5.5] to compare with.
    pub levels: Vec<f64>,
    /// Probability that expanded uncertainties are to cover.
    pub coverage: f64,
}

/// A plan with all that is said of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlanReport {
    /// `centrical-plan/1`.
    pub schema: &'static str,
    /// What made it.
    pub program: Program,
    /// Title.
    pub title: String,
    /// "I", "A", "D" or "worst".
    pub criterion: &'static str,
    /// Value of the criterion as an uncertainty: square root of the variance it is [m/s^2 for I, else 1].
    pub value: f64,
    /// The value in each scenario, if there are several: the expected one first.
    pub by_scenario: Vec<f64>,
    /// "mean" or "worst": how they are one.
    pub against: &'static str,
    /// No schedule of the candidates in this time has a lower value.
    pub bound: f64,
    /// The continuous design on the mountings of the plan: its value, and the part by which the equivalence theorem leaves it
    /// above the optimum.
    pub continuous: f64,
    /// That part, of the uncertainty.
    pub continuous_gap: f64,
    /// Nodes of the branch and bound over sets of mountings.
    pub nodes: usize,
    /// Of a plan for goals: no schedule of the candidates that is shorter keeps them, with type B as in this plan [s].
    pub least_time: Option<f64>,
    /// Whether it is for a unit of typical errors, signs in turn: see [`Planning::plan`].
    pub for_typical: bool,
    /// Plateaus to choose from.
    pub candidates: usize,
    /// Time of the plan [s].
    pub time: f64,
    /// Time of measuring alone, of ramps and turns, of set-ups [s].
    pub time_by_use: [f64; 3],
    /// The mountings in their order.
    pub mountings: Vec<PlannedMounting>,
    /// What will be known.
    pub prediction: PredictionReport,
    /// Goals, for criterion "worst": name, wanted, predicted from noise and speeds, predicted with type B [SI].
    pub goals: Vec<GoalReport>,
    /// Time against uncertainty.
    pub frontier: Vec<FrontierRow>,
}

/// One mounting of a plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlannedMounting {
    /// Position.
    pub position: String,
    /// Radius [m].
    pub radius: f64,
    /// Why it is there.
    pub reason: ReasonReport,
    /// Its plateaus.
    pub plateaus: Vec<PlannedPlateau>,
}

/// One kind of visit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlannedPlateau {
    /// Speed [rad/s], 0 at rest.
    pub speed: f64,
    /// Carousel angle at rest [rad].
    pub angle: f64,
    /// Duration of a visit [s].
    pub duration: f64,
    /// Why one visit is there.
    pub reason: ReasonReport,
}

/// What is lost without a part of the plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReasonReport {
    /// By which part the criterion rises, as an uncertainty.
    pub rise: f64,
    /// Time that it takes [s].
    pub time: f64,
    /// The parameter of the instrument that suffers most.
    pub parameter: String,
    /// Its uncertainty without it over that with it.
    pub factor: f64,
}

/// A wanted uncertainty.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GoalReport {
    /// Parameter, or "reading".
    pub name: String,
    /// SI unit.
    pub unit: String,
    /// Group of the parameter.
    pub group: &'static str,
    /// Wanted standard uncertainty.
    pub wanted: f64,
    /// Predicted by noise, speeds and priors.
    pub type_a: Option<f64>,
    /// What the stated type B leaves, which no plan lowers by much.
    pub type_b: Option<f64>,
    /// Predicted with type B.
    pub combined: Option<f64>,
}

impl GoalReport {
    fn with_type_b(self) -> Self {
        let rest = |(all, a): (f64, f64)| (all * all - a * a).max(0.0).sqrt();
        Self { type_b: self.combined.zip(self.type_a).map(rest), ..self }
    }
}

/// One time of the frontier. Values are uncertainties as in [`PlanReport::value`].
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FrontierRow {
    /// Time [s].
    pub time: f64,
    /// The best plan found.
    pub best: f64,
    /// Bound.
    pub bound: f64,
    /// The uniform plan, if there is time for it.
    pub uniform: Option<f64>,
    /// [K5.5], if there is time for it.
    pub normalised: Option<f64>,
}

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
            schema: SCHEMA,
            program: Program { name: "centrical".to_owned(), version: env!("CARGO_PKG_VERSION").to_owned() },
            title: self.title.clone(),
            criterion: match self.criterion {
                Criterion::Determinant => "D",
                Criterion::Average => "A",
                Criterion::Reading(_) => "I",
                Criterion::Worst(_) => "worst",
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
            for_typical: candidates.scenarios[0].nominal == self.model().parameters().typical_in_turn(),
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
        predict(&model, &weights, scenario.speed_uncertainty, &self.type_b, &nominal)
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

    fn goals_of(&self, prediction: &Prediction) -> Vec<GoalReport> {
        let Criterion::Worst(goals) = &self.criterion else { return Vec::new() };
        let report = |goal: &Goal| match goal {
            Goal::Parameter { name, uncertainty } => {
                let parameters = prediction.model().parameters();
                let j = parameters.find(name);
                GoalReport {
                    name: name.clone(),
                    unit: j.map_or(String::new(), |j| parameters[j].unit.clone()),
                    group: j.map_or("", |j| parameters[j].group),
                    wanted: *uncertainty,
                    type_a: j.and_then(|j| prediction.type_a(j)),
                    type_b: None,
                    combined: j.and_then(|j| prediction.standard_uncertainty(j)),
                }
                .with_type_b()
            }
            Goal::Reading { range, uncertainty } => {
                let reading = prediction.reading(*range);
                GoalReport {
                    name: "reading".to_owned(),
                    unit: "m/s^2".to_owned(),
                    group: "bias",
                    wanted: *uncertainty,
                    type_a: reading.map(|[a, _]| a),
                    type_b: None,
                    combined: reading.map(|[_, all]| all),
                }
                .with_type_b()
            }
        };
        goals.iter().map(report).collect()
    }

    fn failed(&self, source: PlanError) -> Error {
        Error::Planning { file: self.file.clone(), source }
    }
}

impl PlanReport {
    /// The text of the document.
    pub fn to_json(&self) -> String {
        // Plain structs with text keys: serialisation has nothing to fail on.
        let mut text = serde_json::to_string_pretty(self).unwrap_or_default();
        text.push('\n');
        text
    }
}
