//! The whole job for one session: what the command, a fleet's worker and a notebook all call.

use std::num::ParseIntError;
use std::str::FromStr;

use centrical::{MeasurementModel, fit};

use crate::error::{Error, Place};
use crate::reduce::Reduced;
use crate::result::CalibrationResult;
use crate::session::Session;

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
        let reduced = Reduced::of(session, progress)?;
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
    let fit = estimate(&model, &observations, session.speed_uncertainty).map_err(failed)?;
    let result = CalibrationResult::new(session, &model, &reduced, &fit);
    let mut result = result.with_trust(session, &model, &observations, &fit).map_err(failed)?;
    if method == Method::Recursive {
        "exact, recursive filter".clone_into(&mut result.fit.method);
    }
    Ok(result)
}

/// A plateau as people name it: `4:3`, the third plateau of the fourth mounting.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PlateauName {
    /// Number of the mounting, from 1.
    pub mounting: usize,
    /// Number of the plateau in the mounting's schedule, from 1.
    pub plateau: usize,
}

impl PlateauName {
    /// Name of the set point of that index.
    pub fn of(session: &Session, set_point: usize) -> Self {
        let set_points = &session.experiment.set_points;
        let mounting = set_points[set_point].mounting;
        let plateau = set_points[..=set_point].iter().filter(|other| other.mounting == mounting).count();
        Self { mounting: mounting + 1, plateau }
    }

    /// Index of its set point in the experiment.
    ///
    /// # Errors
    /// [`Error::Table`] if the session has no such plateau.
    pub fn set_point(self, session: &Session) -> Result<usize, Error> {
        let set_points = session.experiment.set_points.iter().enumerate();
        let mut there = set_points.filter(|(_, set_point)| set_point.mounting + 1 == self.mounting);
        let found = self.plateau.checked_sub(1).and_then(|skipped| there.nth(skipped));
        found.map(|(index, _)| index).ok_or_else(|| {
            let Self { mounting, plateau } = self;
            let found = format!("no plateau {mounting}:{plateau}");
            Error::content(&session.file, Place::Whole, found, "the numbers of a mounting and of one of its plateaus")
        })
    }
}

impl FromStr for PlateauName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = |_: ParseIntError| format!("found {text:?}, expected MOUNTING:PLATEAU such as 4:3");
        let (mounting, plateau) = text.split_once(':').unwrap_or((text, ""));
        Ok(Self { mounting: mounting.parse().map_err(wrong)?, plateau: plateau.parse().map_err(wrong)? })
    }
}
