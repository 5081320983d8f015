//! Results into a store.

use std::path::{Path, PathBuf};

use centrical::{OnProgress, advance, unwatched};
use rayon::prelude::*;

use super::read::collect_results;
use crate::document::CalibrationResult;
use crate::error::{Error, Place, quoted};
use crate::quantity::Date;
use crate::settings::read_result;
use crate::store::{Added, Row, Store};

/// Results that are read before they are added: a few hundred MB at most.
const BATCH: usize = 256;

/// Adds results to the store in `folder`, which is made if it is not there; a folder among them stands for every `result.json` in it and
/// below. A result that is there already changes nothing. `progress` is called with the number of results read.
///
/// # Errors
/// [`Error`] naming the file that is not a result or is one of the store, the place, what was found and what was expected. Results before
/// one that is not a result may be added.
pub fn add_results(
    folder: &Path,
    results: &[PathBuf],
    rows_only: bool,
    progress: OnProgress<usize>,
) -> Result<Added, Error> {
    let mut files = Vec::new();
    for path in results {
        let before = files.len();
        collect_results(path, &mut files)?;
        if files.len() == before {
            return Err(Error::content(path, Place::Whole, "no result.json in this folder or below", "at least one"));
        }
    }
    Store::refuse_inputs(folder, &files)?;
    let mut added = Added::default();
    for batch in files.chunks(BATCH) {
        // To parse a result takes longer than all else; errors are those of one thread, the first file first.
        let read: Vec<Result<_, Error>> = batch.par_iter().map(|file| read_row(file, rows_only)).collect();
        let rows: Vec<_> = read.into_iter().collect::<Result<_, _>>()?;
        // A store is made when there is something to add.
        let of_batch = Store::create(folder)?.add_with_results(rows, progress)?;
        added = Added { new: added.new + of_batch.new, known: added.known + of_batch.known };
        advance(progress, batch.len())?;
    }
    Ok(added)
}

/// The row of the result in `file`, with the bytes of the file unless `row_only`.
fn read_row(file: &Path, row_only: bool) -> Result<(Row, Option<Vec<u8>>), Error> {
    let text = read_result(file, "a result.json")?;
    let result = CalibrationResult::parse(file, &text)?;
    refuse_date(file, &result.session.date)?;
    let row = result.row(text.as_bytes());
    Ok((row, (!row_only).then(|| text.into_bytes())))
}

/// Refuses a date that is not a day, in a `file` whose result is to be added to a store. Without a date a result may be listed.
///
/// # Errors
/// [`Error`] naming the file, and the date that was found.
pub fn refuse_date(file: &Path, date: &str) -> Result<(), Error> {
    if date.is_empty() || date.parse::<Date>().is_ok() {
        return Ok(());
    }
    let place = Place::Key { table: "session".to_owned(), key: "date".to_owned() };
    Err(Error::content(file, place, quoted(date.as_bytes()), "a day such as 2026-10-05, which a history takes it by"))
}

/// Adds one result that is in memory, as its file has it, to the store in `folder`.
///
/// # Errors
/// As [`Store::add`].
pub fn add_result(folder: &Path, result: &CalibrationResult, rows_only: bool) -> Result<Added, Error> {
    refuse_date(Path::new("result"), &result.session.date)?;
    let text = result.to_json()?;
    let row = result.row(text.as_bytes());
    Store::create(folder)?.add_with_results(vec![(row, (!rows_only).then(|| text.into_bytes()))], &unwatched)
}
