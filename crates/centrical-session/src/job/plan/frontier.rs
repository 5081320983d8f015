//! Time against uncertainty, with plans that are made without a search beside the best.

use centrical::plan::{Candidates, Effort, FrontierPoint, Schedule, Task};
use centrical::{Experiment, OnProgress, SetPoint};

use super::request::PlanRequest;
use crate::document::FrontierRow;
use crate::error::Error;
use crate::experiment::Planning;

/// Speeds of a uniform plan at most, in each mounting.
const UNIFORM_SPEEDS: usize = 8;

/// The frontier about `time`, with the uniform plan and [K5.5] beside it.
pub(super) fn frontier_rows(
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
    let points = candidates.frontier(criterion, &times, Effort::usual(candidates), progress);
    let experiment = candidates.experiment();
    let has_arm = experiment.has_arm();
    let uniform = with_set_points(candidates, &uniform_set_points(experiment));
    let normalised = with_set_points(candidates, &normalised_set_points(experiment, &request.levels));
    let root = |found: Option<(_, f64)>| found.map(|(_, value): (Schedule, f64)| value.sqrt());
    let row = |point: FrontierPoint| {
        Ok(FrontierRow {
            time: point.time,
            best: point.plan.criterion.sqrt(),
            bound: point.plan.bound.sqrt(),
            uniform: root(uniform.uniform(criterion, point.time)?),
            // Its speeds are its own, and so is its duration.
            normalised: if has_arm { root(normalised.filled(criterion, point.time)?) } else { None },
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
