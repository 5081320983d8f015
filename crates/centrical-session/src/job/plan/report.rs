//! The request for a plan, and its report, beside plans that are made without a search.

use std::path::PathBuf;

use centrical::plan::{
    Candidates, Criterion, Goal, Plan, PlanError, Prediction, Rationale, Robustness, Schedule, Task, Visit,
};
use centrical::{Experiment, Group, OnProgress, SetPoint};

use crate::document::{
    ChosenRest, ChosenRests, CriterionName, FrontierRow, GoalReport, PLAN_SCHEMA, PlanReport, PlannedMounting,
    PlannedPlateau, PredictionReport, Program, ReasonReport,
};
use crate::error::Error;
use crate::experiment::{Planning, RestSource};

/// Levels `m` of [K5.5] on the frontier unless others are given.
pub const USUAL_LEVELS: [f64; 4] = [0.0, 1.0, 2.0, 3.0];

/// Times of the frontier over that of the plan unless others are given.
pub const USUAL_TIMES: [f64; 8] = [0.5, 0.6, 0.7, 0.85, 1.0, 1.25, 1.5, 2.0];

/// The parts of a plan that are asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanRequest {
    /// Time available [s], in place of the one in the plan file.
    pub time: Option<f64>,
    /// Whether to search until every set of mountings is decided on.
    pub certify: bool,
    /// Times of the frontier over that of the plan; empty for no frontier.
    pub frontier: Vec<f64>,
    /// Levels `m` of [K5.5] to compare with.
    pub levels: Vec<f64>,
    /// Probability that expanded uncertainties are to cover.
    pub coverage: f64,
    /// Files that will be written: none of them may be one that is read.
    pub outputs: Vec<PathBuf>,
}

impl PlanRequest {
    /// A level `m` of [K5.5].
    ///
    /// # Errors
    /// What was found and expected.
    pub fn level(level: f64) -> Result<f64, String> {
        let is_level = (0.0..=1e6).contains(&level);
        is_level.then_some(level).ok_or_else(|| format!("found {level}, expected a multiple of Omega*^2, zero or more"))
    }
}

/// The report of a plan.
///
/// # Errors
/// [`Error::Planning`] when it cannot be predicted.
pub(super) fn report(
    planning: &Planning,
    plan: &Plan,
    request: &PlanRequest,
    progress: OnProgress<()>,
) -> Result<PlanReport, Error> {
    let failed = |source| planning.failed(source);
    let task = &planning.task;
    let candidates = &task.candidates;
    let schedule = &plan.schedule;
    let (by_visit, by_set_up) = Rationale::of(candidates, &task.criterion, schedule, progress).map_err(failed)?;
    let measuring: f64 = schedule.visits.iter().map(|v| v.duration).sum();
    let visits: f64 = schedule.visits.iter().map(|v| candidates.visit_time(v)).sum();
    let prediction = task.predict(schedule).map_err(|source| failed(PlanError::from(source)))?;
    Ok(PlanReport {
        schema: PLAN_SCHEMA,
        program: Program::this(),
        title: planning.title.clone(),
        criterion: match task.criterion {
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
        for_typical: candidates.scenarios[0].nominal == task.model().parameters().typical_alternating(),
        candidates: candidates.len(),
        time: schedule.time,
        time_by_use: [measuring, visits - measuring, schedule.time - visits],
        mountings: mountings(task, plan, &by_visit, &by_set_up),
        rests: rests(planning, plan, &by_visit, by_set_up.last().and_then(Option::as_ref)),
        goals: goals(task, &prediction),
        prediction: PredictionReport::of(&prediction, planning.range, request.coverage)
            .map_err(|source| failed(PlanError::from(source)))?,
        frontier: frontier_rows(planning, schedule.time, request, progress)?,
    })
}

fn mountings(
    task: &Task,
    plan: &Plan,
    by_visit: &[Rationale],
    by_set_up: &[Option<Rationale>],
) -> Vec<PlannedMounting> {
    let experiment = task.candidates.experiment();
    let visits = &plan.schedule.visits;
    let mut mountings = Vec::new();
    let on_arm = experiment.mountings_on_arm().zip(by_set_up);
    let time_until = |m: usize| {
        let is_before = |visit: &&Visit| experiment.set_points[visit.candidate].mounting < m;
        task.candidates.time_of(&visits.iter().filter(is_before).copied().collect::<Vec<_>>())
    };
    for (m, of_mounting) in on_arm.filter_map(|(m, reason)| Some((m, reason.as_ref()?))) {
        let there = |n: &usize| experiment.set_points[visits[*n].candidate].mounting == m;
        let plateau = |n: usize| {
            let SetPoint { omega, angle, .. } = experiment.set_points[visits[n].candidate];
            PlannedPlateau {
                speed: omega.abs(),
                angle,
                duration: visits[n].duration,
                reason: reason(task, &by_visit[n]),
            }
        };
        mountings.push(PlannedMounting {
            position: experiment.positions[experiment.mountings[m].position].id.clone(),
            radius: experiment.mountings[m].arm_y.x,
            time: time_until(m + 1) - time_until(m),
            reason: reason(task, of_mounting),
            plateaus: (0..visits.len()).filter(there).map(plateau).collect(),
        });
    }
    mountings
}

/// The rests beside the arm, which are the last candidates.
fn rests(
    planning: &Planning,
    plan: &Plan,
    by_visit: &[Rationale],
    together: Option<&Rationale>,
) -> Option<ChosenRests> {
    let table = planning.rests.as_ref()?;
    let RestSource::Plan(planned) = &table.source else { return None };
    let first = planning.task.candidates.len() - table.count();
    let reasons = by_visit.iter().zip(&plan.schedule.visits);
    let rest = |(why, visit): (&Rationale, &Visit)| {
        let up = planned.up_b[visit.candidate.checked_sub(first)?];
        Some(ChosenRest { up: up.into(), duration: visit.duration, reason: reason(&planning.task, why) })
    };
    Some(ChosenRests {
        reason: reason(&planning.task, together?),
        attitude_uncertainty: table.attitudes.as_ref().map(|known| known.uncertainty),
        rests: reasons.filter_map(rest).collect(),
    })
}

fn reason(task: &Task, reason: &Rationale) -> ReasonReport {
    ReasonReport {
        rise: (1.0 + reason.rise).sqrt() - 1.0,
        time: reason.time,
        parameter: task.model().parameters()[reason.parameter].name.clone(),
        factor: reason.factor,
    }
}

fn goals(task: &Task, prediction: &Prediction) -> Vec<GoalReport> {
    let parameters = prediction.model().parameters();
    let report = |(goal, [type_a, type_b, combined]): (&Goal, [Option<f64>; 3])| {
        let (unit, group) = match goal {
            Goal::Parameter { name, .. } => {
                // The goals were made from the names of these parameters.
                let j = parameters.find(name)?;
                (parameters[j].unit.as_str(), parameters[j].group)
            }
            Goal::Reading { .. } => ("m/s^2", Group::Bias),
        };
        let (name, unit) = (goal.name().to_owned(), unit.to_owned());
        Some(GoalReport { name, unit, group, wanted: goal.uncertainty(), type_a, type_b, combined })
    };
    task.goals().iter().zip(task.reached(prediction)).filter_map(report).collect()
}

/// Speeds of a uniform plan at most, in each mounting.
const UNIFORM_SPEEDS: usize = 8;

/// The frontier about `time`, with the uniform plan and [K5.5] beside it.
fn frontier_rows(
    planning: &Planning,
    time: f64,
    request: &PlanRequest,
    progress: OnProgress<()>,
) -> Result<Vec<FrontierRow>, Error> {
    if request.frontier.is_empty() {
        return Ok(Vec::new());
    }
    let Task { candidates, criterion, .. } = &planning.task;
    let times: Vec<f64> = request.frontier.iter().map(|factor| factor * time).collect();
    let points = candidates.frontier(criterion, &times, progress);
    let experiment = candidates.experiment();
    let has_arm = experiment.has_arm();
    let uniform = with_set_points(candidates, &uniform_set_points(experiment));
    let normalised = with_set_points(candidates, &normalised_set_points(experiment, &request.levels));
    let root = |found: Option<(_, f64)>| found.map(|(_, value): (Schedule, f64)| value.sqrt());
    let row = |(time, plan): (f64, Plan)| {
        Ok(FrontierRow {
            time,
            best: plan.criterion.sqrt(),
            bound: plan.bound.sqrt(),
            uniform: root(uniform.uniform(criterion, time)?),
            // Its speeds are its own, and so is its duration.
            normalised: if has_arm { root(normalised.filled(criterion, time)?) } else { None },
        })
    };
    let rows = points.and_then(|points| points.into_iter().map(row).collect());
    rows.map_err(|source| planning.failed(source))
}

/// The candidates with other plateaus in the same mountings.
fn with_set_points(candidates: &Candidates, set_points: &[SetPoint]) -> Candidates {
    let mut other = candidates.clone();
    for scenario in &mut other.scenarios {
        let experiment = Experiment { set_points: set_points.to_vec(), ..scenario.model.experiment().clone() };
        // The same positions and mountings have the same unknowns.
        scenario.model = scenario.model.in_experiment(experiment);
    }
    other
}

/// All rests, and of each mounting's speeds some at equal distances.
fn uniform_set_points(experiment: &Experiment) -> Vec<SetPoint> {
    let mut chosen = Vec::new();
    for m in 0..experiment.mountings.len() {
        let (rests, spins): (Vec<SetPoint>, Vec<SetPoint>) =
            experiment.set_points.iter().filter(|s| s.mounting == m).partition(|s| s.is_rest());
        chosen.extend(rests);
        let count = spins.len().min(UNIFORM_SPEEDS);
        chosen.extend((1..=count).map(|n| spins[n * spins.len() / count - 1]));
    }
    chosen
}

/// [K5.5] on the same mountings on the arm: `Omega^2 = 10 g m / R*`, `R*` the largest radius; rest at 0 and pi.
fn normalised_set_points(experiment: &Experiment, levels: &[f64]) -> Vec<SetPoint> {
    let largest = experiment.mountings.iter().map(|m| m.arm_y.x).fold(0.0, f64::max);
    let unit = (10.0 * experiment.site.gravity / largest).sqrt();
    let sign = if experiment.set_points.iter().any(|s| s.omega < 0.0) { -1.0 } else { 1.0 };
    let mut chosen = Vec::new();
    for mounting in experiment.mountings_on_arm() {
        for &m in levels {
            if m == 0.0 {
                chosen.extend([0.0, std::f64::consts::PI].map(|angle| SetPoint::at_rest(mounting, angle)));
            } else {
                chosen.push(SetPoint::spinning(mounting, sign * unit * m.sqrt()));
            }
        }
    }
    chosen
}
