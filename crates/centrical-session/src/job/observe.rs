//! What an experiment is studied with: a plan, or a session and the noise of its records.

use std::path::Path;

use centrical::{OnProgress, Weight};

use super::plan::read_plan;
use super::reduce::reduce;
use crate::document::Subject;
use crate::error::Error;
use crate::experiment::Session;

/// Reads a plan, or a session and the noise of its records. `progress` is called with the number
/// of bytes read, from any thread; most bytes are read twice.
///
/// # Errors
/// [`Error`] naming the file, the place, what was found and what was expected.
pub fn subject(path: &Path, progress: OnProgress) -> Result<Subject, Error> {
    match read_plan(path)? {
        Some(plan) => Ok(plan.into()),
        None => subject_of(&Session::read(path)?, progress),
    }
}

/// A session and the noise of its records. `progress` is called as in [`subject`].
///
/// # Errors
/// As [`subject`].
pub fn subject_of(session: &Session, progress: OnProgress) -> Result<Subject, Error> {
    let (session, reduced) = reduce(session, progress)?;
    let model = reduced.model(&session)?;
    Ok(Subject {
        file: session.file.clone(),
        title: session.title.clone(),
        weighted_by: Subject::DATA.to_owned(),
        nominal: vec![0.0; model.parameters().len()],
        model,
        weights: reduced.observations().iter().map(Weight::from).collect(),
    })
}
