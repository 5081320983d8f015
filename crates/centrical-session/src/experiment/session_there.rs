//! A session that stands already where another one is to be written.

use std::path::Path;

use super::rests::RestSource;
use super::session::{EXPERIMENT_FILE, Session};
use crate::error::{Error, Place};

/// Refuses a folder that holds a session.
///
/// # Errors
/// [`Error`] with its experiment file.
pub(crate) fn refuse_session(folder: &Path) -> Result<(), Error> {
    refuse(folder, "a folder without one", |_| false)
}

/// The same, but for means alone of the unit of `session`: such a session this program writes, and can write again.
///
/// # Errors
/// As [`refuse_session`].
pub(crate) fn refuse_another_session(folder: &Path, session: &Session) -> Result<(), Error> {
    let may_be_replaced = |there: &Session| is_of_means(there) && is_of_unit(there, session);
    refuse(folder, "a folder without one, or with one of plateau means alone and of the same unit", may_be_replaced)
}

fn refuse(folder: &Path, expected: &str, may_be_replaced: impl Fn(&Session) -> bool) -> Result<(), Error> {
    let file = folder.join(EXPERIMENT_FILE);
    if !file.exists() || Session::read_before_rests(&file).is_ok_and(|session| may_be_replaced(&session)) {
        return Ok(());
    }
    Err(Error::content(&file, Place::Whole, "a session", expected))
}

/// Whether all readings of a session are means, in tables.
fn is_of_means(session: &Session) -> bool {
    let is_table = |source: &RestSource| matches!(source, RestSource::Table(_));
    session.plateaus.is_some() != session.mountings.is_empty()
        && session.rest_tables.iter().all(|table| is_table(&table.source))
}

/// Whether a session is of the unit of `other`, or does not say which it is of.
fn is_of_unit<'s>(session: &'s Session, other: &'s Session) -> bool {
    let unit = |session: &'s Session| [session.unit_model.as_str(), session.unit_serial.as_str()];
    unit(session) == ["", ""] || unit(session) == unit(other)
}
