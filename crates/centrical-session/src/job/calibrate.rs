//! The whole job for one session: what the command, a fleet's worker and a notebook all call.

use centrical::{Calibration, Data, FitError, MeasurementModel, OnProgress, advance};

use super::reduce::reduce;
use crate::document::{BetweenRestsSummary, CalibrationResult, Method};
use crate::error::Error;
use crate::experiment::{PlateauName, Session};
use crate::reduced::Reduced;

/// What is fitted: the plateau means of a session and the model of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// The model.
    pub model: MeasurementModel,
    /// The means and the files they come from.
    pub reduced: Reduced,
}

impl Problem {
    /// Reads and reduces a session. `progress` is called with the number of bytes read, from any thread; most bytes
    /// are read twice.
    ///
    /// # Errors
    /// [`Error`] naming the file, the place, what was found and what was expected.
    pub fn of(session: &Session, progress: OnProgress) -> Result<Self, Error> {
        let (session, reduced) = reduce(session, progress)?;
        let model = reduced.model(&session)?;
        Ok(Self { model, reduced })
    }
}

/// Reads, reduces and fits a session. `progress` is called with the number of bytes read, from any thread; most bytes
/// are read twice.
///
/// # Errors
/// [`Error`] naming the file, the place, what was found and what was expected.
pub fn calibrate(session: &Session, method: Method, progress: OnProgress) -> Result<CalibrationResult, Error> {
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
    progress: OnProgress,
) -> Result<CalibrationResult, Error> {
    let (session, mut reduced) = reduce(session, progress)?;
    reduced.held_out = held_out.iter().map(|name| name.set_point(&session)).collect::<Result<_, _>>()?;
    calibrate_reduced(&session, &reduced, method, progress)
}

/// Fits a session that is reduced already, from files or from memory. Of rests alone, where they are acceptable by their own noise,
/// the uncertainties include what the residuals cannot exclude beside it. `progress` is called with 0 after every step.
///
/// # Errors
/// [`Error::Fit`] naming the session, what was found and what was expected; [`Error::Stopped`].
pub fn calibrate_reduced(
    session: &Session,
    reduced: &Reduced,
    method: Method,
    progress: OnProgress,
) -> Result<CalibrationResult, Error> {
    let between = |calibration: &Calibration, result: &CalibrationResult| {
        let is_judged = result.validity.is_some() && result.objections().is_empty();
        if is_judged { calibration.between_rests(&|()| progress(0)) } else { Ok(None) }
    };
    let (result, between) = by_noise(session, reduced, method, progress, between)?;
    let Some(between) = between else { return Ok(result) };
    // The rests were judged by their own noise: with the scatter added to it, a poor fit would pass.
    let mut session = session.clone();
    session.type_b = between.stated_beside(session.type_b);
    let (result, ()) = by_noise(&session, &reduced.clone().scattered(&between), method, progress, |_, _| Ok(()))?;
    Ok(CalibrationResult { between_rests: Some(BetweenRestsSummary::from(between)), ..result })
}

/// The calibration by the noise of the plateaus, and what is asked of it beside.
fn by_noise<T>(
    session: &Session,
    reduced: &Reduced,
    method: Method,
    progress: OnProgress,
    beside: impl FnOnce(&Calibration, &CalibrationResult) -> Result<T, FitError>,
) -> Result<(CalibrationResult, T), Error> {
    let model = reduced.model(session)?;
    let failed = |source| Error::fit(&session.file, source);
    let data = Data::new(&model, reduced.observations()).map_err(failed)?;
    let calibration = match method {
        Method::Exact => Calibration::exact_watched(&data, &|()| progress(0)),
        Method::Recursive => Calibration::recursive(&data),
        Method::Linear => Calibration::linear(&data),
    };
    advance(progress, 0)?;
    let calibration = calibration.map_err(failed)?;
    let result = CalibrationResult::from(&calibration, session, reduced, progress).map_err(failed)?;
    advance(progress, 0)?;
    let beside = beside(&calibration, &result).map_err(failed)?;
    Ok((result, beside))
}
