//! What went wrong with a file, in the user's words: where, found, expected.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Why a session, a record or a table could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The content of a file is not what its place calls for.
    #[error("{}{place}: found {found}, expected {expected}", file.display())]
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
    /// The experiment file does not follow the form: syntax, type of a value, unknown or missing key.
    #[error("{}{place}: {message}", file.display())]
    Form {
        /// The file.
        file: PathBuf,
        /// Where in the file.
        place: Place,
        /// What the parser says: what it found and what it expected.
        message: String,
    },
    /// A record does not hold what the schedule says.
    #[error("{}, mounting {mounting}: {source}", file.display())]
    Reduction {
        /// The record.
        file: PathBuf,
        /// Number of the mounting, from 1.
        mounting: usize,
        /// What was looked for and what was seen.
        source: Box<centrical::reduction::ReductionError>,
    },
    /// The plateau means of a session cannot be fitted.
    #[error("{}: {source}", file.display())]
    Fit {
        /// The experiment file.
        file: PathBuf,
        /// Which plateau, and why.
        source: centrical::FitError,
    },
    /// A result does not say how to compensate.
    #[error("{}: {source}", file.display())]
    ErrorModel {
        /// The result.
        file: PathBuf,
        /// Which coefficient, and why.
        source: NoErrorModel,
    },
    /// The error model of a result has no certain inverse over the range asked for.
    #[error("{}: {source}", file.display())]
    NotInvertible {
        /// The result.
        file: PathBuf,
        /// Why, and over what range it has one.
        source: centrical_compensate::NotInvertible,
    },
    /// There is no plan.
    #[error("{}: {source}", file.display())]
    Planning {
        /// The plan file.
        file: PathBuf,
        /// Why.
        source: centrical::plan::PlanError,
    },
    /// A column of readings cannot be analysed for noise.
    #[error("{}, {reading}: {source}", file.display())]
    Noise {
        /// The file.
        file: PathBuf,
        /// The column.
        reading: String,
        /// What was found and what was expected.
        source: centrical::noise::NoiseError,
    },
    /// Nothing can be simulated of a truth.
    #[error("{}: {source}", file.display())]
    Simulation {
        /// The truth file.
        file: PathBuf,
        /// Which setting or value, and why.
        source: centrical::simulate::SimulationError,
    },
    /// The operating system refused to read or write a file.
    #[error("{}: cannot be {action}: {source}", file.display())]
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
    /// A key of the experiment file.
    Key {
        /// Its table, and which one where there are several: `[[mounting]] 3`.
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
            Self::Line { line, column: Some(column) } => write!(f, ", line {line}, {column}"),
            Self::Line { line, column: None } => write!(f, ", line {line}"),
            Self::Row { row, column } => write!(f, ", row {row}, {column}"),
            Self::Column(column) => write!(f, ", {column}"),
            Self::Key { table, key } => write!(f, ", {table}, {key}"),
        }
    }
}

impl Place {
    /// Line and column of a byte of the text.
    pub(crate) fn of_byte(text: &str, byte: usize) -> Self {
        let before = text.get(..byte).unwrap_or(text);
        let line = before.matches('\n').count() + 1;
        let column = before.chars().rev().take_while(|c| *c != '\n').count() + 1;
        Self::Character { line, column }
    }
}

impl Error {
    /// The content of `file` at `place` is not what was expected.
    pub(crate) fn content(file: &Path, place: Place, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self::Content { file: file.to_owned(), place, found: found.into(), expected: expected.into() }
    }

    /// Reading `file`, of which `expected` says what it should be, failed with `source`.
    pub(crate) fn reading(file: &Path, source: io::Error, expected: &str) -> Self {
        match source.kind() {
            io::ErrorKind::NotFound => Self::content(file, Place::Whole, "no such file", expected),
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
    pub(crate) fn writing(file: &Path, source: io::Error) -> Self {
        Self::Io { file: file.to_owned(), action: "written", source }
    }
}

/// Text as found in a file, quoted and cut to a length that can be read.
pub(crate) fn quoted(text: &[u8]) -> String {
    const READABLE: usize = 60;
    let shown = String::from_utf8_lossy(&text[..text.len().min(READABLE)]);
    if text.len() > READABLE { format!("{:?}...", shown.trim_end_matches('\u{fffd}')) } else { format!("{shown:?}") }
}

/// Why a result does not say how to compensate.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NoErrorModel {
    /// The data did not determine a coefficient.
    #[error("{name}: found no value, the data do not determine it; expected a number to compensate with")]
    NotEstimable {
        /// Name of the coefficient.
        name: String,
    },
    /// A term is of no axis.
    #[error("{name}: found an axis that is not 1, 2 or 3")]
    Axis {
        /// Name of the coefficient.
        name: String,
    },
}
