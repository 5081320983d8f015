//! Rests in attitudes of their own, which join a watch when their files are there.

use std::path::PathBuf;

use centrical::{Observation, OnProgress};

use super::quiet::Quiet;
use crate::error::Error;
use crate::experiment::{RestTable, Session};
use crate::job::reduce::with_all_rests;

/// The session with the rests of every `[[tumble]]` whose files are there and have been left alone for the time called quiet. One whose
/// files are not is waited for, and so are those after it: rests are numbered in the order of the file.
///
/// # Errors
/// [`Error`] when a table or a record that has been left alone is wrong; [`Error::Stopped`].
pub(super) fn with_rests_there(session: &Session, quiet: &mut Quiet, progress: OnProgress) -> Result<Session, Error> {
    let mut tables = session.rest_tables.clone();
    let waited_for = there(tables.iter(), quiet).iter().position(|there| !there).unwrap_or(tables.len());
    let later = tables.split_off(waited_for);
    tables.iter_mut().try_for_each(|table| table.read(&session.folder))?;
    let there = session.clone().with_rest_tables(tables);
    let (filled, _) = with_all_rests(&there, progress)?;
    let tables = filled.rest_tables.iter().cloned().chain(later).collect();
    Ok(session.clone().with_rest_tables(tables))
}

/// The file of rests that is waited for, if one is.
pub(super) fn awaited(session: &Session) -> Option<&PathBuf> {
    let table = session.rest_tables.iter().find(|table| table.is_awaited())?;
    table.files().find(|file| !file.exists()).or_else(|| table.files().next())
}

/// Whether the rests that are waited for have come.
pub(super) fn have_come(session: &Session, quiet: &mut Quiet) -> bool {
    let awaited = session.rest_tables.iter().filter(|table| table.is_awaited());
    there(awaited, quiet).first() == Some(&true)
}

/// The rests of the session as data of a fit.
pub(super) fn observations(session: &Session) -> Vec<Observation> {
    let first = session.experiment.set_points.len() - session.rests().count();
    let rests = (first..).zip(session.rests());
    rests.map(|(set_point, rest)| rest.observation(set_point)).collect()
}

/// Whether all files of each table are there and have been left alone. Those of earlier days are taken at once: a watch that goes on has them.
/// Each look counts: all tables are looked at.
fn there<'t>(tables: impl Iterator<Item = &'t RestTable>, quiet: &mut Quiet) -> Vec<bool> {
    let is_there = |table: &RestTable| quiet.look(table.files()).is_some_and(|sight| sight.left_alone || sight.is_old);
    tables.map(is_there).collect()
}
