//! What went wrong with a file, in the user's words: where, found, expected.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use crate::foreign::cut;

/// Characters that a message shows of what was found, and of what was expected, where that is a list of names.
const LONGEST_FOUND: usize = 400;
const LONGEST_EXPECTED: usize = 2000;

/// Characters that a message shows of a name.
const LONGEST_NAME: usize = 100;

/// Characters that a message shows of a path: its end, where the name is.
const LONGEST_PATH: usize = 500;

/// A path as messages show it.
pub fn shown_path(path: &Path) -> String {
    let whole = path.display().to_string();
    let count = whole.chars().count();
    if count <= LONGEST_PATH {
        whole
    } else {
        format!("...{}", whole.chars().skip(count - LONGEST_PATH).collect::<String>())
    }
}

/// Why a table or another file could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The content of a file is not what its place calls for.
    #[error(
        "{}{place}: found {}, expected {}",
        shown_path(file),
        cut(found, LONGEST_FOUND),
        cut(expected, LONGEST_EXPECTED)
    )]
    Content {
        /// The file.
        file: PathBuf,
        /// Where in the file.
        place: Place,
        /// What stands there.
        found: String,
        /// What should stand there.
        expected: String,
    },
    /// There is no such file.
    #[error("{}: found no such file, expected {}", shown_path(file), cut(expected, LONGEST_EXPECTED))]
    Missing {
        /// The file.
        file: PathBuf,
        /// What it should be.
        expected: String,
    },
    /// The operating system refused to read or write a file.
    #[error("{}: cannot be {action}: {source}", shown_path(file))]
    Io {
        /// The file.
        file: PathBuf,
        /// "read" or "written".
        action: &'static str,
        /// What the operating system says.
        source: io::Error,
    },
}

/// A place in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// The file as a whole.
    Whole,
    /// A character of a text, line and column counted from 1.
    Character {
        /// Line.
        line: usize,
        /// Character in the line.
        column: usize,
    },
    /// A line of a text table, counted from 1 with the header and comments.
    Line {
        /// Line.
        line: u64,
        /// Name of the column of the table, where one is meant.
        column: Option<String>,
    },
    /// A row of a binary table, counted from 1.
    Row {
        /// Row.
        row: u64,
        /// Name of the column of the table.
        column: String,
    },
    /// A column of a binary table.
    Column(String),
    /// A key of a file of settings.
    Key {
        /// Its table, and which one where there are several: `[[mounting]] 3`; empty for a key of the file itself.
        table: String,
        /// The key in the table.
        key: String,
    },
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole => Ok(()),
            Self::Character { line, column } => write!(f, ", line {line}, column {column}"),
            Self::Line { line, column: Some(column) } => write!(f, ", line {line}, {}", cut(column, LONGEST_NAME)),
            Self::Line { line, column: None } => write!(f, ", line {line}"),
            Self::Row { row, column } => write!(f, ", row {row}, {}", cut(column, LONGEST_NAME)),
            Self::Column(column) => write!(f, ", {}", cut(column, LONGEST_NAME)),
            Self::Key { table, key } if table.is_empty() => write!(f, ", {}", cut(key, LONGEST_NAME)),
            Self::Key { table, key } => write!(f, ", {table}, {}", cut(key, LONGEST_NAME)),
        }
    }
}

impl Place {
    /// Line and column of a byte of the text.
    pub fn of_byte(text: &str, byte: usize) -> Self {
        let before = text.get(..byte).unwrap_or(text);
        let line = before.matches('\n').count() + 1;
        let column = before.chars().rev().take_while(|c| *c != '\n').count() + 1;
        Self::Character { line, column }
    }

    /// Name of the column of a table, where one is meant.
    pub fn column(&self) -> Option<&str> {
        match self {
            Self::Line { column, .. } => column.as_deref(),
            Self::Row { column, .. } | Self::Column(column) => Some(column),
            Self::Whole | Self::Character { .. } | Self::Key { .. } => None,
        }
    }
}

impl Error {
    /// The content of `file` at `place` is not what was expected.
    #[must_use]
    pub fn content(file: &Path, place: Place, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self::Content { file: file.to_owned(), place, found: found.into(), expected: expected.into() }
    }

    /// Reading `file`, which should be `expected`, failed with `source`.
    #[must_use]
    pub fn reading(file: &Path, source: io::Error, expected: &str) -> Self {
        match source.kind() {
            io::ErrorKind::NotFound => Self::Missing { file: file.to_owned(), expected: expected.to_owned() },
            io::ErrorKind::IsADirectory => Self::content(file, Place::Whole, "a folder", expected),
            _ => Self::Io { file: file.to_owned(), action: "read", source },
        }
    }

    /// Reading `file` failed with `source`, which may be the unpacking of what it holds.
    pub(crate) fn unpacking(file: &Path, source: io::Error, expected: &str) -> Self {
        match source.kind() {
            io::ErrorKind::InvalidData
            | io::ErrorKind::InvalidInput
            | io::ErrorKind::UnexpectedEof
            | io::ErrorKind::Other => {
                Self::content(file, Place::Whole, format!("damaged compression ({source})"), expected)
            }
            _ => Self::reading(file, source, expected),
        }
    }

    /// Writing `file` failed with `source`.
    #[must_use]
    pub fn writing(file: &Path, source: io::Error) -> Self {
        Self::Io { file: file.to_owned(), action: "written", source }
    }
}

/// Text as found in a file, quoted and cut to a length that can be read.
pub fn quoted(text: &[u8]) -> String {
    const READABLE: usize = 60;
    let shown = String::from_utf8_lossy(&text[..text.len().min(READABLE)]);
    if text.len() > READABLE { format!("{:?}...", shown.trim_end_matches('\u{fffd}')) } else { format!("{shown:?}") }
}
