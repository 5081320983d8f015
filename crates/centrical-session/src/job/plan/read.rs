//! Plans with what is expected of the unit: the earlier result that they name.

use std::path::Path;

use crate::document::CalibrationResult;
use crate::error::Error;
use crate::experiment::{ExpectedValues, Plan, Planning};

/// Reads a plan and the earlier result that it names; `None` for a session, as [`Plan::read`].
///
/// # Errors
/// As [`Plan::read`] and [`CalibrationResult::read`].
pub fn read_plan(path: &Path) -> Result<Option<Plan>, Error> {
    let mut plan = Plan::read(path)?;
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
