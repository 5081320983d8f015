//! Plans with what is expected of the unit: the earlier result that they name.

use std::path::Path;

use crate::document::CalibrationResult;
use crate::error::Error;
use crate::experiment::{ExpectedValues, Plan, Planning, earlier_result};

/// Reads a plan and the earlier result that it names; `None` for a session, as [`Plan::read`].
///
/// # Errors
/// As [`Plan::read`] and [`CalibrationResult::read`].
pub fn read_plan(path: &Path) -> Result<Option<Plan>, Error> {
    if path.is_dir() { Ok(None) } else { Plan::read(path, &expected(path)?) }
}

/// Reads what is to be planned and the earlier result that it names.
///
/// # Errors
/// As [`Planning::read`] and [`CalibrationResult::read`].
pub fn read_planning(path: &Path) -> Result<Planning, Error> {
    Planning::read(path, &expected(path)?)
}

fn expected(path: &Path) -> Result<ExpectedValues, Error> {
    let Some(file) = earlier_result(path)? else { return Ok(ExpectedValues::new()) };
    let parameters = CalibrationResult::read(&file)?.parameters.into_iter();
    Ok(parameters.filter_map(|p| p.value.map(|value| (p.name, value))).collect())
}
