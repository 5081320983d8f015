//! Patterns of paths: a shell may leave them as they are, by its nature or by quotes, and knows a limit on the length of a command.

use std::path::{Path, PathBuf};

use crate::error::{Error, Place};

/// The paths as given. One that is not there and has `*`, `?` or `[` stands for all that match it, in the order of their names.
///
/// # Errors
/// [`Error`] if nothing matches, or what matches cannot be listed.
pub fn matching_paths(given: &[PathBuf]) -> Result<Vec<PathBuf>, Error> {
    let mut paths = Vec::with_capacity(given.len());
    for path in given {
        match pattern(path) {
            Some(pattern) => paths.extend(matches(path, pattern)?),
            None => paths.push(path.clone()),
        }
    }
    Ok(paths)
}

fn pattern(path: &Path) -> Option<&str> {
    path.to_str().filter(|text| text.contains(['*', '?', '[']) && path.symlink_metadata().is_err())
}

fn matches(path: &Path, pattern: &str) -> Result<Vec<PathBuf>, Error> {
    let wrong = |found: String, expected: &str| Error::content(path, Place::Whole, found, expected);
    let found = glob::glob(pattern)
        .map_err(|error| wrong(format!("a pattern that ends in a mistake: {}", error.msg), "such as 2026-*/unit-?"))?;
    let mut paths = Vec::new();
    for entry in found {
        paths.push(entry.map_err(|error| wrong(error.to_string(), "folders that can be listed"))?);
    }
    if paths.is_empty() {
        return Err(wrong("no path of this pattern".to_owned(), "a pattern that paths match"));
    }
    Ok(paths)
}
