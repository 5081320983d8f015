//! The calibrations of a store as a list, without failures of sessions that a series has done again since.

use std::path::Path;

use centrical::OnProgress;

use crate::document::HistoryList;
use crate::error::Error;
use crate::job::series::last_rows;
use crate::store::{Row, Selection, Status, Store};

/// The calibrations that a selection picks, by unit and day, and the sessions that failed last. `progress` is asked at each row group, with none done.
///
/// # Errors
/// [`Error`] if the folder is not a store, or a part is damaged; [`Error::Stopped`].
pub fn list_store(folder: &Path, selection: Selection, progress: OnProgress) -> Result<HistoryList, Error> {
    let rows = Store::open(folder)?.rows(selection, progress)?.collect::<Result<Vec<_>, _>>()?;
    Ok(HistoryList::new(&folder.display().to_string(), without_superseded(folder, rows)?))
}

/// The rows of the store in `folder` without failures whose session has a later row: a store never takes a row away.
///
/// # Errors
/// [`Error`] when the lines of a series in the folder cannot be read.
pub fn without_superseded(folder: &Path, mut rows: Vec<Row>) -> Result<Vec<Row>, Error> {
    if rows.iter().any(|row| row.status == Status::Failed) {
        let last = last_rows(folder)?;
        // A failure has its session for a title.
        let is_last = |row: &Row| last.get(&row.title).is_none_or(|key| *key == row.key);
        rows.retain(|row| row.status == Status::Done || is_last(row));
    }
    Ok(rows)
}
