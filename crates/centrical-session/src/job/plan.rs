//! The best plan for the time, or the shortest for the goals, with its report.

mod frontier;
mod read;
mod report;
mod request;
mod schedule_file;

use std::path::Path;

use centrical::OnProgress;
use centrical_table::refuse_inputs;

pub use self::read::{read_plan, read_planning};
use self::report::report;
pub use self::request::{PlanRequest, USUAL_LEVELS, USUAL_TIMES};
use crate::document::PlanReport;
use crate::error::Error;

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
