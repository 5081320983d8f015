//! Calibrations from results and folders of results.

use std::fs;
use std::path::{Path, PathBuf};

use super::calibrated::Calibrated;
use crate::document::CalibrationResult;
use crate::error::Error;

/// The calibrations in `paths`, in the order of time: results, and folders in which each `result.json` at any depth is one.
///
/// # Errors
/// [`Error`] when a result cannot be read, or its session has no day for a date.
pub fn read_calibrations(paths: &[PathBuf]) -> Result<Vec<Calibrated>, Error> {
    let mut files = Vec::new();
    for path in paths {
        if path.is_dir() { results_in(path, &mut files)? } else { files.push(path.clone()) }
    }
    let mut calibrations = Vec::with_capacity(files.len());
    for file in &files {
        calibrations.push(Calibrated::of(&file.display().to_string(), &CalibrationResult::read(file)?)?);
    }
    calibrations.sort_by(|a, b| {
        a.date.cmp(&b.date).then_with(|| a.unit().cmp(&b.unit())).then_with(|| a.source.cmp(&b.source))
    });
    Ok(calibrations)
}

fn results_in(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), Error> {
    let failed = |source| centrical_table::Error::reading(folder, source, "a folder of results");
    let mut entries: Vec<_> = fs::read_dir(folder).map_err(failed)?.collect::<Result<_, _>>().map_err(failed)?;
    entries.sort_by_key(fs::DirEntry::file_name);
    for entry in entries {
        // The type of the entry itself: a link to a folder could lead back.
        let kind = entry.file_type().map_err(failed)?;
        if kind.is_dir() {
            results_in(&entry.path(), files)?;
        } else if entry.file_name() == "result.json" {
            files.push(entry.path());
        }
    }
    Ok(())
}
