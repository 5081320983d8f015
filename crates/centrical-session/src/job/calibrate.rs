//! The whole job for one session: what the command, a fleet's worker and a notebook all call.

use centrical::uncertainty::BetweenRests;
use centrical::{Calibration, Data, MeasurementModel, OnProgress, advance};

use super::reduce::reduce;
use super::scale::refuse_scale;
use crate::document::{BetweenRestsSummary, CalibrationResult, Method, RecordFindings};
use crate::error::Error;
use crate::experiment::{PlateauName, Session};
use crate::reduced::Reduced;

/// What is fitted: the plateau means of a session and the model of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// The session, with the schedule and the uncertainties that its readings show.
    pub session: Session,
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
        Self::reduced(session.into_owned(), reduced)
    }

    /// The same with the uncertainties that its calibration states: of rests alone with what the residuals cannot exclude.
    ///
    /// # Errors
    /// As [`Problem::of`]; [`Error::Fit`].
    pub fn as_stated(session: &Session, progress: OnProgress) -> Result<Self, Error> {
        let (session, reduced) = reduce(session, progress)?;
        if session.experiment.has_arm() {
            return Self::reduced(session.into_owned(), reduced);
        }
        let (_, between) = by_noise(&session, &reduced, Method::Exact, true, progress)?;
        let (session, reduced) = match between {
            Some(between) => with(&between, &session, &reduced),
            None => (session.into_owned(), reduced),
        };
        Self::reduced(session, reduced)
    }

    fn reduced(session: Session, reduced: Reduced) -> Result<Self, Error> {
        Ok(Self { model: reduced.model(&session)?, session, reduced })
    }
}

/// Reads, reduces and fits a session. Plateaus that are `held_out` are reduced and shown with their residuals, but not fitted. `progress` is
/// called with the number of bytes read, from any thread; most bytes are read twice.
///
/// # Errors
/// [`Error`] naming the file, the place, what was found and what was expected; if the session has no such plateau.
pub fn calibrate(
    session: &Session,
    held_out: &[PlateauName],
    method: Method,
    progress: OnProgress,
) -> Result<CalibrationResult, Error> {
    let (session, mut reduced) = reduce(session, progress)?;
    reduced.held_out = held_out.iter().map(|name| name.set_point(&session)).collect::<Result<_, _>>()?;
    calibrate_reduced(&session, &reduced, method, progress)
}

/// The calibration of a session that was watched, without the plateaus `held_out` by request, and without those that `alarmed` while it ran:
/// with the plateaus before them they did not agree. All plateaus together may single out fewer, one of those before, for example. These are
/// held out then, and returned beside the result. `alpha` is the family-wise error of singling out.
///
/// # Errors
/// As [`calibrate`].
pub(crate) fn calibrate_watched(
    session: &Session,
    held_out: &[usize],
    alarmed: &[usize],
    alpha: f64,
    progress: OnProgress,
) -> Result<(CalibrationResult, Option<Vec<PlateauName>>), Error> {
    let (session, mut reduced) = reduce(session, progress)?;
    reduced.held_out = held_out.to_vec();
    let singled_out =
        if alarmed.is_empty() { None } else { fewer(&session, &reduced, alarmed.len(), alpha, progress)? };
    reduced.held_out.extend(singled_out.as_deref().unwrap_or(alarmed));
    let names = singled_out.map(|those| those.iter().map(|n| PlateauName::of(&session, *n)).collect());
    Ok((calibrate_reduced(&session, &reduced, Method::Recursive, progress)?, names))
}

/// The set points of outlying plateaus without which no other stands out, if they are fewer than `count`.
fn fewer(
    session: &Session,
    reduced: &Reduced,
    count: usize,
    alpha: f64,
    progress: OnProgress,
) -> Result<Option<Vec<usize>>, Error> {
    let model = reduced.model(session)?;
    let failed = |source| Error::fit(&session.file, source);
    let data = Data::new(&model, reduced.observations()).map_err(failed)?;
    let (data, left_out) = data.without_most_outlying(alpha, count - 1, &|()| progress(0)).map_err(failed)?;
    let validity = Calibration::exact(&data).and_then(|calibration| calibration.validity()).map_err(failed)?;
    let singled_out = left_out.into_iter().map(|(set_point, _)| set_point).collect();
    Ok(validity.outlier(alpha).is_none().then_some(singled_out))
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
    let (result, between) = by_noise(session, reduced, method, true, progress)?;
    let Some(between) = between else { return Ok(result) };
    let (session, reduced) = with(&between, session, reduced);
    let (result, _) = by_noise(&session, &reduced, method, false, progress)?;
    Ok(CalibrationResult { between_rests: Some(BetweenRestsSummary::from(between)), ..result })
}

/// A session and its plateaus with what is between rests.
fn with(between: &BetweenRests, session: &Session, reduced: &Reduced) -> (Session, Reduced) {
    let mut session = session.clone();
    session.type_b = between.stated_beside(session.type_b);
    (session, reduced.clone().scattered(between))
}

/// The calibration by the noise of the plateaus, and what is between rests alone if that is `asked`: of rests that are acceptable by
/// their own noise. With the scatter added to it, a poor fit would pass.
fn by_noise(
    session: &Session,
    reduced: &Reduced,
    method: Method,
    asked: bool,
    progress: OnProgress,
) -> Result<(CalibrationResult, Option<BetweenRests>), Error> {
    let model = reduced.model(session)?;
    let failed = |source| Error::fit(&session.file, source);
    let data = Data::new(&model, reduced.observations()).map_err(failed)?;
    let calibration = match method {
        Method::Exact => Calibration::exact_watched(&data, &|()| progress(0)),
        Method::Recursive => Calibration::recursive(&data),
        Method::Linear => Calibration::linear(&data),
        Method::RecursiveLinear => Calibration::recursive_linear(&data),
    };
    advance(progress, 0)?;
    let calibration = calibration.map_err(failed)?;
    let result = as_result(&calibration, session, reduced, progress)?;
    let is_judged = asked && result.validity.is_some() && result.objections().is_empty();
    let between = if is_judged { calibration.between_rests(&|()| progress(0)).map_err(failed)? } else { None };
    Ok((result, between))
}

/// A calibration of a session that is reduced, with what its records show beside their means.
///
/// # Errors
/// As [`calibrate_reduced`].
pub(super) fn as_result(
    calibration: &Calibration,
    session: &Session,
    reduced: &Reduced,
    progress: OnProgress,
) -> Result<CalibrationResult, Error> {
    refuse_scale(calibration, session)?;
    let result = CalibrationResult::from(calibration, session, reduced, progress);
    let result = result.map_err(|source| Error::fit(&session.file, source))?;
    let findings = RecordFindings::stated(session)?;
    advance(progress, 0)?;
    Ok(match findings {
        Some(findings) => findings.added_to(result),
        None => result,
    })
}
