//! Which error model the data of a session speak for.

use centrical::uncertainty::{Selection, rivals_of, select};

use super::calibrate::Problem;
use crate::error::Error;
use crate::experiment::Session;

/// Fits rival models to a session. `progress` is called with the number of bytes read, from any thread; most bytes are
/// read twice.
///
/// # Errors
/// [`Error`] naming the file, the place, what was found and what was expected.
pub fn select_model(session: &Session, progress: &(dyn Fn(u64) + Sync)) -> Result<Selection, Error> {
    let Problem { model, reduced } = Problem::of(session, progress)?;
    select(&rivals_of(&model), &reduced.observations())
        .map_err(|source| Error::Fit { file: session.file.clone(), source })
}
