//! The files that a result was made from, and how one knows them again.

use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::Path;

use centrical_table::open_regular;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::error::Error;

/// A file that went into the result.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Input {
    /// Path within the session's folder.
    pub path: String,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
}

impl Input {
    /// Path within the session's folder and hash of the bytes of a file, read in pieces.
    ///
    /// # Errors
    /// [`Error`] when it cannot be read.
    pub fn of(folder: &Path, file: &Path) -> Result<Self, Error> {
        let input = open_regular(file, "a file of the session")?;
        let hash = sha256(input).map_err(|source| Error::reading(file, source, "a file of the session"))?;
        let sha256 = hash.iter().fold(String::new(), |text, byte| text + &format!("{byte:02x}"));
        let path = file.strip_prefix(folder).unwrap_or(file);
        Ok(Self { path: path.to_string_lossy().replace('\\', "/"), sha256 })
    }
}

/// SHA-256 of a file, read in pieces.
fn sha256(file: File) -> io::Result<[u8; 32]> {
    const PIECE: usize = 1 << 16;
    let mut input = BufReader::with_capacity(PIECE, file);
    let mut hash = Sha256::new();
    loop {
        let piece = input.fill_buf()?;
        if piece.is_empty() {
            return Ok(hash.finalize().into());
        }
        hash.update(piece);
        let read = piece.len();
        input.consume(read);
    }
}
