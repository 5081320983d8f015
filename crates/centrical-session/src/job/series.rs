//! Many sessions on the cores of one machine: a row each in a store, resumed by what the sessions hold.

mod ledger;
mod one;
mod table;
mod workers;

use std::collections::{BTreeSet, HashSet};
use std::fs;
use std::path::{Path, PathBuf};

use centrical::{OnProgress, Stopped};
use centrical_table::{Outputs, claim_folder};

use self::ledger::Ledger;
pub use self::ledger::last_rows;
pub use self::one::SeriesRequest;
use self::one::Writing;
use self::table::write_tables;
use self::workers::Workers;
use crate::document::SeriesSummary;
use crate::error::Error;
use crate::experiment::{EXPERIMENT_FILE, Session};
use crate::store::Store;

/// Calibrates sessions, one on each core, and writes the table of all. A session that fails becomes a row with its message. A session
/// whose files, program and method are those of an earlier run is not calibrated again. `progress` is called with 1 for every session that is
/// done, and with 0 in between.
///
/// # Errors
/// [`Error`] if the folder does not take a file, or a file to be written is one of a session, before anything is written; [`Error::Stopped`], after what was done is written.
pub fn calibrate_series(
    sessions: &[PathBuf],
    request: &SeriesRequest,
    progress: OnProgress<usize>,
) -> Result<SeriesSummary, Error> {
    let _claim = claim_folder(&request.out)?;
    let store = Store::create(&request.out)?;
    let outputs = Outputs::of(&[request.files().to_vec(), store.replaced()?].concat())?;
    let mut ledger = Ledger::read(&request.ledger(), request.method)?;
    let sessions = each_once(sessions);
    let mut due = Vec::new();
    for session in &sessions {
        if progress(0).is_break() {
            return Err(Stopped.into());
        }
        outputs.refuse(&[session])?;
        if ledger.knows(session) {
            outputs.refuse(&ledger.files(session))?;
            let _ = progress(1);
        } else {
            // A session that cannot be read becomes a row later.
            Session::read(session).map_or(Ok(()), |read| outputs.refuse(&read.files()))?;
            due.push(*session);
        }
    }
    let known = sessions.len() - due.len();
    Workers { request, store: &store, progress, writing: Writing::default() }.run(&due, &mut ledger)?;
    let summary = write_tables(request, &store, &ledger, &sessions)?;
    Ok(SeriesSummary { known, ..summary })
}

/// The sessions by their first names: one that is given under several spellings of its path, or by its experiment file, is one.
fn each_once(sessions: &[PathBuf]) -> BTreeSet<&Path> {
    let names: BTreeSet<&Path> = sessions.iter().map(PathBuf::as_path).collect();
    let mut met = HashSet::new();
    let folder = |name: &Path| {
        let real = fs::canonicalize(name).ok()?;
        let is_file = real.file_name().is_some_and(|name| name == EXPERIMENT_FILE) && real.is_file();
        if is_file { real.parent().map(Path::to_owned) } else { Some(real) }
    };
    names.into_iter().filter(|name| folder(name).is_none_or(|folder| met.insert(folder))).collect()
}
