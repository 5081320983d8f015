//! Tables stored column by column: some rows of every column at a time, side by side.

use std::path::{Path, PathBuf};

use rayon::prelude::*;

use crate::column::{Backwards, Before, ColumnName, Field, LARGEST_NUMBER, Rows, Rule, runs_backwards};
use crate::error::{Error, Place, quoted};
use crate::stamp::{Stamps, TickForm};

/// A column that is read some values at a time.
pub(super) enum Column {
    Numbers(NextNumbers),
    Stamps(TickForm, NextStamps),
}

/// Appends the next values of a column, [`crate::column::ROWS`] at most, and none at its end.
pub(super) type NextNumbers = Box<dyn FnMut(&mut Vec<f64>) -> Result<(), Error> + Send>;

/// The same of stamps: their seconds, and what they are counted as.
pub(super) type NextStamps = Box<dyn FnMut(&mut Vec<f64>, &mut Vec<i64>) -> Result<(), Error> + Send>;

/// The columns, in the order of the fields, of each part of a file in turn: of its row groups, or of all of it.
pub(super) type Parts = Box<dyn Iterator<Item = Result<Vec<Column>, Error>>>;

/// What stands for a missing value while rows are read: a NaN unlike the usual one, for the message alone.
pub(super) const MISSING: f64 = f64::from_bits(0x7ff8_0000_0000_0eaf);

/// Sets of rows in a batch.
const BATCH: usize = 8;

/// The place of the column that a field asks for, among columns of these names.
pub(super) fn place_of(file: &Path, names: &[String], field: &Field) -> Result<usize, Error> {
    let mut places = match &field.name {
        ColumnName::Name(name) => (0..names.len()).filter(|i| names[*i] == *name).collect(),
        ColumnName::Number(number) => vec![number.wrapping_sub(1)],
        ColumnName::Row | ColumnName::DateAndTime(_) => Vec::new(),
    };
    let (Some(place), None) = (places.pop().filter(|i| *i < names.len()), places.pop()) else {
        let found = format!("columns {}", quoted(names.join(", ").as_bytes()));
        return Err(Error::content(file, Place::Column(field.name.to_string()), found, "one column of this name"));
    };
    Ok(place)
}

impl Column {
    /// Appends the next values, and what stamps are counted as.
    pub fn read(&mut self, values: &mut Vec<f64>, ticks: &mut Vec<i64>) -> Result<(), Error> {
        match self {
            Self::Numbers(next) => next(values),
            Self::Stamps(_, next) => next(values, ticks),
        }
    }
}

/// A binary table on its way to rows.
pub(crate) struct ColumnReader {
    file: PathBuf,
    fields: Vec<Field>,
    parts: Parts,
    /// Of the part that is being read.
    columns: Vec<Column>,
    rows: Vec<Rows>,
    /// Of the first field, for each set of rows, if they are kept.
    stamps: Vec<Stamps>,
    keeps_stamps: bool,
    before: Before,
    /// Rows that the file can hold.
    most: u64,
}

impl ColumnReader {
    /// The parts of `file`, which can hold `most` rows.
    pub(super) fn new(file: &Path, fields: Vec<Field>, parts: Parts, most: u64) -> Self {
        let rows = vec![vec![Vec::new(); fields.len()]; BATCH];
        let before = Before::new(fields.len());
        let (columns, stamps) = (Vec::new(), vec![Stamps::default(); BATCH]);
        Self { file: file.to_owned(), fields, parts, columns, rows, stamps, keeps_stamps: false, before, most }
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

    /// Keeps stamps of the first field.
    pub fn keep_stamps(&mut self) {
        self.keeps_stamps = true;
    }

    /// The stamps of the rows that were read last.
    pub fn take_stamps(&mut self, count: usize) -> Vec<Stamps> {
        self.stamps[..count].iter_mut().map(std::mem::take).collect()
    }

    /// Fills one set of rows; whether there are any.
    fn fill(&mut self, number: usize) -> Result<bool, Error> {
        let Self { file, fields, columns, rows, before, .. } = self;
        let rows = &mut rows[number];
        rows.iter_mut().for_each(Vec::clear);
        let mut ticks = vec![Vec::new(); columns.len()];
        let read = columns.par_iter_mut().zip(&mut *rows).zip(&mut ticks);
        let read = read.map(|((column, values), ticks)| column.read(values, ticks));
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
        let ticks = ticks.swap_remove(0);
        // What no whole number of the unit counts stays a number of seconds.
        self.stamps[number] = match &columns[0] {
            Column::Stamps(form, _) if self.keeps_stamps && ticks.len() == length => Stamps::counted(*form, ticks),
            _ => Stamps::default(),
        };
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
            if value.is_nan() && !missing_is_fine || value.abs() > LARGEST_NUMBER {
                let missing = value.to_bits() == MISSING.to_bits();
                return wrong(i, if missing { "no value".to_owned() } else { value.to_string() }, &field.expected);
            }
            if value < last && field.rule.ascends() {
                let backwards = Backwards { field: 0, value: *value, before: *last };
                return wrong(i, backwards.found(), &backwards.expected(false));
            }
            *last = *value;
        }
    }
    Ok(())
}

/// Whether all values are numbers in order; `last` is the one before them.
fn is_plain(values: &[f64], last: f64, rule: Rule) -> bool {
    let wrong = values.iter().map(|value| usize::from(value.is_nan() || value.abs() > LARGEST_NUMBER)).sum::<usize>();
    let ascends = || values.first().is_none_or(|first| *first >= last) && !runs_backwards(values);
    wrong == 0 && (!rule.ascends() || ascends())
}
