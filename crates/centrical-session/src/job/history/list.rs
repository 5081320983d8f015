//! The calibrations of a store as a list.

use std::path::Path;

use centrical::OnProgress;

use super::superseded::without_superseded;
use crate::document::HistoryList;
use crate::error::Error;
use crate::store::{Selection, Store};

/// The calibrations that a selection picks, by unit and day, and the sessions that failed last. `progress` is asked at each row group, with none done.
///
/// # Errors
/// [`Error`] if the folder is not a store, or a part is damaged; [`Error::Stopped`].
pub fn list_store(folder: &Path, selection: Selection, progress: OnProgress) -> Result<HistoryList, Error> {
    let rows = Store::open(folder)?.rows(selection, progress)?.collect::<Result<Vec<_>, _>>()?;
    Ok(HistoryList::new(&folder.display().to_string(), without_superseded(folder, rows)?))
}
