//! Tables stored column by column: some rows of every column at a time, side by side.

use std::path::{Path, PathBuf};

use rayon::prelude::*;

use crate::column::{Field, LARGEST, Rule};
use crate::error::{Error, Place};
use crate::rows::{ASCENDING, Before, Rows, runs_backwards};

/// Appends the next values of a column, [`crate::rows::ROWS`] at most, and none at its end.
pub(super) type Column = Box<dyn FnMut(&mut Vec<f64>) -> Result<(), Error> + Send>;

/// The columns, in the order of the fields, of each part of a file in turn: of its row groups, or of all of it.
pub(super) type Parts = Box<dyn Iterator<Item = Result<Vec<Column>, Error>>>;

/// What stands for a missing value while rows are read: a NaN unlike the usual one, for the message alone.
pub(super) const MISSING: f64 = f64::from_bits(0x7ff8_0000_0000_0eaf);

/// Sets of rows in a batch.
const BATCH: usize = 8;

/// A binary table on its way to rows.
pub(crate) struct ColumnReader {
    file: PathBuf,
    fields: Vec<Field>,
    parts: Parts,
    /// Of the part that is being read.
    columns: Vec<Column>,
    rows: Vec<Rows>,
    before: Before,
    /// Rows that the file can hold.
    most: u64,
}

impl ColumnReader {
    /// The parts of `file`, which can hold `most` rows.
    pub(super) fn new(file: &Path, fields: Vec<Field>, parts: Parts, most: u64) -> Self {
        let rows = vec![vec![Vec::new(); fields.len()]; BATCH];
        let before = Before::new(fields.len());
        Self { file: file.to_owned(), fields, parts, columns: Vec::new(), rows, before, most }
    }

    /// The parts of a file that is one.
    pub(super) fn whole(file: &Path, fields: Vec<Field>, columns: Vec<Column>, most: u64) -> Self {
        Self::new(file, fields, Box::new(std::iter::once(Ok(columns))), most)
    }

    /// Reads the next rows, how many sets of them; none at the end, or where there are more than the file can hold.
    pub fn read(&mut self) -> Result<usize, Error> {
        let mut filled = 0;
        while filled < BATCH && self.before.count <= self.most {
            if self.columns.is_empty() || !self.fill(filled)? {
                match self.parts.next() {
                    Some(columns) => self.columns = columns?,
                    None => break,
                }
            } else {
                filled += 1;
            }
        }
        Ok(filled)
    }

    /// The rows that were read last.
    pub fn rows(&mut self, count: usize) -> &mut [Rows] {
        &mut self.rows[..count]
    }

    /// Fills one set of rows; whether there are any.
    fn fill(&mut self, number: usize) -> Result<bool, Error> {
        let Self { file, fields, columns, rows, before, .. } = self;
        let rows = &mut rows[number];
        rows.iter_mut().for_each(Vec::clear);
        let read = columns.par_iter_mut().zip(&mut *rows).map(|(column, values)| column(values));
        // Gathered before the first error is taken: which one it is does not depend on the threads.
        read.collect::<Vec<_>>().into_iter().collect::<Result<(), Error>>()?;
        let length = rows[0].len();
        if let Some(k) = rows.iter().position(|values| values.len() != length) {
            let found = format!("{} rows where {} has {length}", rows[k].len(), fields[0].name);
            let place = Place::Column(fields[k].name.to_string());
            return Err(Error::content(file, place, found, "columns of equal length"));
        }
        check(file, fields, rows, before)?;
        before.count += length as u64;
        Ok(length > 0)
    }
}

/// The values are numbers, and time does not run backwards.
fn check(file: &Path, fields: &[Field], rows: &Rows, before: &mut Before) -> Result<(), Error> {
    let first_row = before.count;
    for ((field, values), last) in fields.iter().zip(rows).zip(&mut before.last) {
        let wrong = |i: usize, found: String, expected: &str| {
            let place = Place::Row { row: first_row + i as u64 + 1, column: field.name.to_string() };
            Err(Error::content(file, place, found, expected))
        };
        if is_plain(values, *last, field.rule) {
            *last = values.last().copied().unwrap_or(*last);
            continue;
        }
        let missing_is_fine = field.rule == Rule::OrMissing;
        for (i, value) in values.iter().enumerate() {
            if value.is_nan() && !missing_is_fine || value.abs() > LARGEST {
                let missing = value.to_bits() == MISSING.to_bits();
                return wrong(i, if missing { "no value".to_owned() } else { value.to_string() }, &field.expected);
            }
            if value < last && field.rule.ascends() {
                return wrong(i, format!("{value} after {last}"), ASCENDING);
            }
            *last = *value;
        }
    }
    Ok(())
}

/// Whether there is nothing to say of any of the values, the last one before them being that.
fn is_plain(values: &[f64], last: f64, rule: Rule) -> bool {
    let wrong = values.iter().map(|value| usize::from(value.is_nan() || value.abs() > LARGEST)).sum::<usize>();
    let ascends = || values.first().is_none_or(|first| *first >= last) && !runs_backwards(values);
    wrong == 0 && (!rule.ascends() || ascends())
}
