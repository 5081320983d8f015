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
    Plan::read(path, &values)
}

/// Reads what is to be planned and the earlier result that it names.
///
/// # Errors
/// As [`Planning::read`] and [`CalibrationResult::read`].
pub fn read_planning(path: &Path) -> Result<Planning, Error> {
    Planning::read(path, &values)
}

/// The values of an earlier result that are determined.
fn values(result: &Path) -> Result<ExpectedValues, Error> {
    let parameters = CalibrationResult::read(result)?.parameters.into_iter();
    Ok(parameters.filter_map(|p| p.value.map(|value| (p.name, value))).collect())
}
