//! Which error model the data of a session speak for.

use centrical::OnProgress;
use centrical::uncertainty::ModelSelection;

use super::calibrate::Problem;
use crate::error::Error;
use crate::experiment::Session;

/// Fits the model of a session with each rival of the catalogue, and with pairs of the best. `progress` is called with
/// the number of bytes read, from any thread; most bytes are read twice.
///
/// # Errors
/// [`Error`] naming the file, the place, what was found and what was expected.
pub fn select_model(session: &Session, progress: OnProgress) -> Result<ModelSelection, Error> {
    let Problem { model, reduced, .. } = Problem::of(session, progress)?;
    ModelSelection::beside(&model, &reduced.observations(), &|_| progress(0))
        .map_err(|source| Error::fit(&session.file, source))
}
