//! The one door by which small documents are read: settings, results, histories.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::error::{Error, Place};

/// Reads the text of a regular file of `most` bytes at most, which should be what `expected` says.
///
/// # Errors
/// [`Error`] if it is anything else: a folder, a pipe, a device; larger; no text in UTF-8.
pub fn read_document(file: &Path, most: u64, expected: &str) -> Result<String, Error> {
    let bytes = read_bytes(file, most, expected)?;
    String::from_utf8(bytes).map_err(|error| {
        let bad = error.utf8_error().valid_up_to();
        let line = 1 + memchr::memchr_iter(b'\n', &error.as_bytes()[..bad]).count() as u64;
        let found = format!("byte 0x{:02x}", error.as_bytes()[bad]);
        Error::content(file, Place::Line { line, column: None }, found, "text in UTF-8")
    })
}

/// Reads the bytes of a regular file of `most` bytes at most, which should be what `expected` says.
///
/// # Errors
/// [`Error`] if it is anything else: a folder, a pipe, a device; larger.
pub fn read_bytes(file: &Path, most: u64, expected: &str) -> Result<Vec<u8>, Error> {
    let failed = |e| Error::reading(file, e, expected);
    let mut bytes = Vec::new();
    open_regular(file, expected)?.take(most + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > most {
        return Err(Error::content(file, Place::Whole, format!("more than {most} bytes"), expected));
    }
    Ok(bytes)
}

/// Opens a regular file, which should be what `expected` says: a pipe or a device could keep the reader for ever.
///
/// # Errors
/// [`Error`] if it is not there, is anything else, or may not be read.
pub fn open_regular(file: &Path, expected: &str) -> Result<File, Error> {
    let kind = std::fs::metadata(file).map_err(|e| Error::reading(file, e, expected))?.file_type();
    if !kind.is_file() {
        let found = if kind.is_dir() { "a folder" } else { "something that is no regular file" };
        return Err(Error::content(file, Place::Whole, found, expected));
    }
    File::open(file).map_err(|e| Error::reading(file, e, expected))
}
