//! Plans with what is expected of the unit: the earlier result that they name.

use std::cell::RefCell;
use std::path::{Path, PathBuf};

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
    read_with_inputs(path, None).map(|(planning, _)| planning)
}

/// The same with the files that were read; a `time` available [s] takes the place of the one in the file.
pub(super) fn read_with_inputs(path: &Path, time: Option<f64>) -> Result<(Planning, Vec<PathBuf>), Error> {
    let inputs = RefCell::new(vec![path.to_owned()]);
    let earlier = |result: &Path| {
        inputs.borrow_mut().push(result.to_owned());
        values(result)
    };
    let planning = Planning::read(path, time, &earlier)?;
    Ok((planning, inputs.take()))
}

/// The values of an earlier result that are determined.
fn values(result: &Path) -> Result<ExpectedValues, Error> {
    let parameters = CalibrationResult::read(result)?.parameters.into_iter();
    Ok(parameters.filter_map(|p| p.value.map(|value| (p.name, value))).collect())
}
