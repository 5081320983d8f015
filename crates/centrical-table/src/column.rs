//! The columns to read of a table.

use std::fmt;

/// Numbers above this have no place in a record or a calibration: their squares, summed, would leave `f64`.
pub const LARGEST_NUMBER: f64 = 1e100;

/// How a column is found in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ColumnName {
    /// By its name in the header.
    Name(String),
    /// By its number from 1, for files without a header.
    Number(usize),
    /// It is not in the file: the number of the row, from 0.
    Row,
}

/// A column to read.
#[derive(Debug, Clone)]
pub struct Field {
    /// How it is found.
    pub name: ColumnName,
    /// What its values are, for messages: "a number in m/s^2".
    pub expected: String,
    /// What is asked of its values beside being numbers.
    pub rule: Rule,
}

/// What is asked of the values of a column beside being numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// Nothing.
    Any,
    /// They never decrease; repeated values are allowed. With `stamps`, a stamp such as `2026-10-05T10:00:00.25`
    /// stands for its seconds since 1970.
    Ascending {
        /// Whether stamps are allowed beside numbers.
        stamps: bool,
    },
    /// A value may be missing ([`is_missing`]), and is NaN then.
    OrMissing,
}

/// How programs write a value that they lack, in small letters.
const MISSING: [&str; 12] =
    ["", "nan", "-nan", "nan(ind)", "-nan(ind)", "1.#qnan", "-1.#ind", "na", "n/a", "#n/a", "null", "none"];

/// Whether a field stands for a value that is missing: it is empty, or a word for no number, such as `NaN`, `null` or `#N/A`.
pub fn is_missing(field: &str) -> bool {
    MISSING.iter().any(|word| field.trim().eq_ignore_ascii_case(word))
}

impl Rule {
    pub(crate) fn ascends(self) -> bool {
        matches!(self, Self::Ascending { .. })
    }
}

/// Where a table begins in a text, where it is not to be recognised: lines of the file, counted from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TableLines {
    /// The line with the names of the columns.
    pub header: Option<u64>,
    /// The first row.
    pub first_row: Option<u64>,
}

/// Units that a text names beside or below the names of its columns.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnitsFound {
    /// The line, counted from 1.
    pub line: u64,
    /// Of every field the unit, in the spelling of settings (`m/s^2`, `ms`, `V`), if it is understood.
    pub units: Vec<Option<&'static str>>,
}

impl fmt::Display for ColumnName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Name(name) => f.write_str(name),
            Self::Number(number) => write!(f, "column {number}"),
            Self::Row => f.write_str("row"),
        }
    }
}
