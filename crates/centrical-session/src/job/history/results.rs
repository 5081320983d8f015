//! The files of results in folders.

use std::fs;
use std::path::{Path, PathBuf};

use crate::error::Error;

/// Name of a result in a folder.
const RESULT: &str = "result.json";

/// Adds the file, or every result in a folder and below, by name.
///
/// # Errors
/// [`Error`] when a folder cannot be read.
pub fn collect_results(path: &Path, files: &mut Vec<PathBuf>) -> Result<(), Error> {
    if !path.is_dir() {
        files.push(path.to_owned());
        return Ok(());
    }
    walk(path, files)
}

fn walk(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), Error> {
    let failed = |error| Error::reading(folder, error, "a folder of results");
    let mut entries = Vec::new();
    for entry in fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        // A link to a folder may lead back here.
        entries.push((entry.path(), entry.file_type().map_err(failed)?.is_dir()));
    }
    entries.sort();
    for (path, is_folder) in entries {
        if is_folder {
            walk(&path, files)?;
        } else if path.file_name().is_some_and(|name| name == RESULT) {
            files.push(path);
        }
    }
    Ok(())
}
