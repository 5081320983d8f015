//! The report of a plan.

use centrical::plan::{
    Criterion, Goal, Plan, PlanError, Prediction, Rationale, Reached, Reason, Robustness, Task, Visit,
};
use centrical::{Group, OnProgress, SetPoint};

use super::frontier::frontier_rows;
use super::request::PlanRequest;
use crate::document::{
    ChosenRest, ChosenRests, CriterionName, GoalReport, PLAN_SCHEMA, PlanReport, PlannedMounting, PlannedPlateau,
    PredictionReport, Program, ReasonReport,
};
use crate::error::Error;
use crate::experiment::{Planning, RestSource};

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
    let rationale = Rationale::of(candidates, &task.criterion, schedule, progress).map_err(failed)?;
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
        mountings: mountings(task, plan, &rationale),
        rests: rests(planning, plan, &rationale),
        goals: goals(task, &prediction),
        prediction: PredictionReport::of(&prediction, planning.range, request.coverage)
            .map_err(|source| failed(PlanError::from(source)))?,
        frontier: frontier_rows(planning, schedule.time, request, progress)?,
    })
}

fn mountings(task: &Task, plan: &Plan, rationale: &Rationale) -> Vec<PlannedMounting> {
    let experiment = task.candidates.experiment();
    let visits = &plan.schedule.visits;
    let mut mountings = Vec::new();
    let on_arm = experiment.mountings_on_arm().zip(&rationale.set_ups);
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
                reason: reason(task, &rationale.visits[n]),
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
fn rests(planning: &Planning, plan: &Plan, rationale: &Rationale) -> Option<ChosenRests> {
    let table = planning.rests.as_ref()?;
    let RestSource::Plan(planned) = &table.source else { return None };
    let first = planning.task.candidates.len() - table.count();
    let reasons = rationale.visits.iter().zip(&plan.schedule.visits);
    let rest = |(why, visit): (&Reason, &Visit)| {
        let up = planned.up_b[visit.candidate.checked_sub(first)?];
        Some(ChosenRest { up: up.into(), duration: visit.duration, reason: reason(&planning.task, why) })
    };
    Some(ChosenRests {
        reason: reason(&planning.task, rationale.set_ups.last()?.as_ref()?),
        attitude_uncertainty: table.attitudes.as_ref().map(|known| known.uncertainty),
        rests: reasons.filter_map(rest).collect(),
    })
}

fn reason(task: &Task, reason: &Reason) -> ReasonReport {
    ReasonReport {
        rise: (1.0 + reason.rise).sqrt() - 1.0,
        time: reason.time,
        parameter: task.model().parameters()[reason.parameter].name.clone(),
        factor: reason.factor,
    }
}

fn goals(task: &Task, prediction: &Prediction) -> Vec<GoalReport> {
    let parameters = prediction.model().parameters();
    let report = |(goal, reached): (&Goal, Reached)| {
        let (unit, group) = match goal {
            Goal::Parameter { name, .. } => {
                // The goals were made from the names of these parameters.
                let j = parameters.find(name)?;
                (parameters[j].unit.as_str(), parameters[j].group)
            }
            Goal::Reading { .. } => ("m/s^2", Group::Bias),
        };
        let Reached { type_a, type_b, combined } = reached;
        let (name, unit) = (goal.name().to_owned(), unit.to_owned());
        Some(GoalReport { name, unit, group, wanted: goal.uncertainty(), type_a, type_b, combined })
    };
    task.goals().iter().zip(task.reached(prediction)).filter_map(report).collect()
}
