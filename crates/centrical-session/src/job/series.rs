//! Many sessions on the cores of one machine: a row each in a store, resumed by what the sessions hold.

mod ledger;
mod one;
mod request;
mod table;
mod workers;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use centrical::{OnProgress, Stopped};
use centrical_table::claim_folder;

use self::ledger::Ledger;
pub use self::request::SeriesRequest;
use self::table::write_tables;
use self::workers::Workers;
use crate::document::SeriesSummary;
use crate::error::Error;
use crate::store::Store;

/// Calibrates sessions, one on each core, and writes the table of all. A session that fails becomes a row with its message. A session
/// whose files, program and method are those of an earlier run is not calibrated again. `progress` is called with 1 for every session that is
/// done, and with 0 in between.
///
/// # Errors
/// [`Error`] if the folder does not take a file; [`Error::Stopped`], after what was done is written.
pub fn calibrate_series(
    sessions: &[PathBuf],
    request: &SeriesRequest,
    progress: OnProgress<usize>,
) -> Result<SeriesSummary, Error> {
    let _claim = claim_folder(&request.out)?;
    let store = Store::create(&request.out)?;
    let mut ledger = Ledger::open(&request.out.join("series.jsonl"), request.method)?;
    let sessions: BTreeSet<&Path> = sessions.iter().map(PathBuf::as_path).collect();
    let mut due = Vec::new();
    for session in &sessions {
        if progress(0).is_break() {
            return Err(Stopped.into());
        }
        if ledger.knows(session) {
            let _ = progress(1);
        } else {
            due.push(*session);
        }
    }
    let known = sessions.len() - due.len();
    Workers { request, store: &store, progress }.run(&due, &mut ledger)?;
    let summary = write_tables(&request.out, &store, &ledger, &sessions)?;
    Ok(SeriesSummary { known, ..summary })
}
