//! The files that a result was made from, and how one knows them again.

use std::io::{BufRead, BufReader};
use std::path::Path;

use centrical::{OnProgress, advance};
use centrical_table::Source;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::error::Error;

/// Bytes that are read at a time.
const PIECE: usize = 1 << 16;

/// A file that went into the result.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Input {
    /// Path within the session's folder.
    pub path: String,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
}

impl Input {
    /// What it is expected to be.
    pub(crate) const EXPECTED: &str = "a file of the session";

    /// Whether it holds what was measured: all but experiment files do.
    pub(crate) fn is_measured(&self) -> bool {
        !self.path.to_ascii_lowercase().ends_with(".toml")
    }

    /// Path within the session's folder and hash of the bytes of a source, read in pieces. They do not count as `progress`.
    ///
    /// # Errors
    /// [`Error`] when it cannot be read, or the caller stops.
    pub fn of(folder: &Path, source: &Source, progress: OnProgress) -> Result<Self, Error> {
        let file = source.name();
        let failed = |error| Error::reading(file, error, Self::EXPECTED);
        let mut pieces = BufReader::with_capacity(PIECE, source.reader_at(0));
        let mut hash = Sha256::new();
        loop {
            let piece = pieces.fill_buf().map_err(failed)?;
            if piece.is_empty() {
                break;
            }
            hash.update(piece);
            let read = piece.len();
            pieces.consume(read);
            advance(progress, 0)?;
        }
        let sha256 = hexadecimal(&hash.finalize());
        let path = file.strip_prefix(folder).unwrap_or(file);
        Ok(Self { path: path.to_string_lossy().replace('\\', "/"), sha256 })
    }
}

/// Bytes as hexadecimal digits.
pub(crate) fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |text, byte| text + &format!("{byte:02x}"))
}
