//! The best plan for the time, or the shortest for the goals, with its report.

mod report;
mod schedule_file;

use std::path::Path;

use centrical::OnProgress;

use self::report::report;
pub use self::report::{PlanRequest, USUAL_LEVELS, USUAL_TIMES};
use crate::document::{CalibrationResult, PlanReport};
use crate::error::Error;
use crate::experiment::{ExpectedValues, PlannedSession, Planning, refuse_inputs};

/// Plans as a plan file asks, and reports the plan. `progress` is called again and again; it changes nothing but whether the search
/// goes on.
///
/// # Errors
/// As [`read_planning`]; [`Error::Stopped`]; when an output is an input; [`Error::Planning`] when there is no plan, or it cannot be predicted.
pub fn plan(file: &Path, request: &PlanRequest, progress: OnProgress<()>) -> Result<PlanReport, Error> {
    let mut planning = read_planning(file, request.time)?;
    let inputs: Vec<&Path> = std::iter::once(file).chain(planning.earlier.as_deref()).collect();
    refuse_inputs(&request.outputs, &inputs)?;
    let plan = planning.task.plan(request.certify, progress).map_err(|source| planning.failed(source))?;
    report(&planning, &plan, request, progress)
}

/// Reads a plan and the earlier result that it names; `None` for a session, as [`PlannedSession::read`].
///
/// # Errors
/// As [`PlannedSession::read`] and [`CalibrationResult::read`].
pub fn read_plan(path: &Path) -> Result<Option<PlannedSession>, Error> {
    let mut plan = PlannedSession::read(path)?;
    if let Some(plan) = &mut plan
        && let Some(earlier) = &plan.earlier
    {
        plan.expect(&values(earlier)?);
    }
    Ok(plan)
}

/// Reads what is to be planned and the earlier result that it names; a `time` available [s] takes the place of the one in the file.
///
/// # Errors
/// As [`Planning::read`] and [`CalibrationResult::read`].
pub fn read_planning(path: &Path, time: Option<f64>) -> Result<Planning, Error> {
    let mut planning = Planning::read(path, time)?;
    if let Some(earlier) = &planning.earlier {
        planning.expect(&values(earlier)?);
    }
    Ok(planning)
}

/// The values of an earlier result that are determined.
fn values(result: &Path) -> Result<ExpectedValues, Error> {
    let parameters = CalibrationResult::read(result)?.parameters.into_iter();
    Ok(parameters.filter_map(|p| p.value.map(|value| (p.name, value))).collect())
}
