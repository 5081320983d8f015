//! The whole job for one session: what the command, a fleet's worker and a notebook all call.

use centrical::{MeasurementModel, fit};

use super::reduce::reduce;
use crate::document::CalibrationResult;
use crate::error::Error;
use crate::experiment::{PlateauName, Session};
use crate::reduced::Reduced;

/// How the unknowns are estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Method {
    /// Gauss-Newton on the exact model.
    #[default]
    Exact,
    /// The same estimates by the recursive filter, iterated.
    Recursive,
    /// The linear fit of [K5.3] alone, with its second-order error.
    Linear,
}

/// What is fitted: the plateau means of a session and the model of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// The model.
    pub model: MeasurementModel,
    /// The means and the files they come from.
    pub reduced: Reduced,
}

impl Problem {
    /// Reads and reduces a session. `progress` is told of bytes of records as they are read, from any
    /// thread, twice of nearly each.
    ///
    /// # Errors
    /// [`Error`] naming the file, the place, what was found and what was expected.
    pub fn of(session: &Session, progress: &(dyn Fn(u64) + Sync)) -> Result<Self, Error> {
        let reduced = reduce(session, progress)?;
        let model = session.model()?;
        Ok(Self { model, reduced })
    }
}

/// Reads, reduces and fits a session. `progress` is told of bytes of records as they are read, from any
/// thread, twice of nearly each.
///
/// # Errors
/// [`Error`] naming the file, the place, what was found and what was expected.
pub fn calibrate(
    session: &Session,
    method: Method,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<CalibrationResult, Error> {
    calibrate_without(session, &[], method, progress)
}

/// [`calibrate`] with some plateaus held out: reduced and shown with their residuals, but not fitted.
///
/// # Errors
/// As [`calibrate`]; and if the session has no such plateau.
pub fn calibrate_without(
    session: &Session,
    held_out: &[PlateauName],
    method: Method,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<CalibrationResult, Error> {
    let Problem { model, mut reduced } = Problem::of(session, progress)?;
    reduced.held_out = held_out.iter().map(|name| name.set_point(session)).collect::<Result<_, _>>()?;
    let estimate = match method {
        Method::Exact => fit::exact,
        Method::Recursive => fit::recursive::exact,
        Method::Linear => fit::linear,
    };
    let observations = reduced.observations();
    let failed = |source| Error::Fit { file: session.file.clone(), source };
    let fit = estimate(&model, &observations).map_err(failed)?;
    let result = CalibrationResult::new(session, &model, &reduced, &fit);
    let mut result = result.with_trust(session, &model, &observations, &fit).map_err(failed)?;
    if method == Method::Recursive {
        "exact, recursive filter".clone_into(&mut result.fit.method);
    }
    Ok(result)
}
