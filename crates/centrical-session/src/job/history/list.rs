//! The calibrations of a store as a list.

use std::path::Path;

use centrical::{OnProgress, unwatched};

use crate::document::HistoryList;
use crate::error::Error;
use crate::store::{Selection, Store};

/// The calibrations that a selection picks, by unit and day.
///
/// # Errors
/// [`Error`] if the folder is no store, or a part is damaged.
pub fn list_store(folder: &Path, selection: Selection) -> Result<HistoryList, Error> {
    list_store_watched(folder, selection, &unwatched)
}

/// The same, asking `progress` at each row group, with none done.
///
/// # Errors
/// As [`list_store`]; [`Error::Stopped`].
pub fn list_store_watched(folder: &Path, selection: Selection, progress: OnProgress) -> Result<HistoryList, Error> {
    let rows = Store::open(folder)?.rows_watched(selection, progress)?.collect::<Result<Vec<_>, _>>()?;
    Ok(HistoryList::new(&folder.display().to_string(), rows))
}
