//! The file of one newtonometer: rows that are read and not taken yet, and its reading at a time at which it was not sampled.

use std::path::Path;

use centrical_table::{Extent, Rows, Source};

use crate::error::Error;
use crate::record::columns::{CheckedTable, Columns, Form, NEWTONOMETER_RECORD};

/// A table of time and one reading.
pub(super) struct Part {
    table: CheckedTable,
    /// Rows that are read and not taken yet begin at `at`.
    rows: Rows,
    at: usize,
    is_over: bool,
    /// Rows that were read.
    pub count: u64,
    /// The last row that was passed: time and reading. Of rows with one stamp it is the first, as the reduction takes it.
    pub before: Option<[f64; 2]>,
}

impl Part {
    /// Reads the source of newtonometer `j`, counted from 0.
    pub fn open(source: Source, j: usize, extent: Extent, columns: &Columns) -> Result<Self, Error> {
        let missing = Some(columns.missing_readings);
        let form = Form { lines: columns.record_lines, missing, expected: NEWTONOMETER_RECORD };
        let table = CheckedTable::of_columns(source, extent, &[&columns.time, &columns.f[j]], form)?;
        Ok(Self { table, rows: vec![Vec::new(); 2], at: 0, is_over: false, count: 0, before: None })
    }

    /// The file.
    pub fn file(&self) -> &Path {
        &self.table.file
    }

    /// The time of the next row; none at the end.
    pub fn time(&mut self) -> Result<Option<f64>, Error> {
        while self.at == self.rows[0].len() && !self.is_over {
            self.read()?;
        }
        Ok(self.rows[0].get(self.at).copied())
    }

    /// The times of the next rows, `count` of them or all that there are.
    pub fn times(&mut self, count: usize) -> Result<&[f64], Error> {
        while self.rows[0].len() - self.at < count && !self.is_over {
            self.read()?;
        }
        let times = &self.rows[0][self.at..];
        Ok(&times[..count.min(times.len())])
    }

    /// The reading of the next row, which [`Part::time`] has found.
    pub fn reading(&self) -> f64 {
        self.rows[1][self.at]
    }

    /// Goes on to the row after the next.
    pub fn skip(&mut self) {
        self.at += 1;
    }

    /// The same, and remembers the row.
    pub fn pass(&mut self) {
        let row = [self.rows[0][self.at], self.rows[1][self.at]];
        if self.before.is_none_or(|before| before[0] < row[0]) {
            self.before = Some(row);
        }
        self.skip();
    }

    /// Goes on to the end.
    pub fn skip_all(&mut self) -> Result<(), Error> {
        while self.time()?.is_some() {
            self.at = self.rows[0].len();
        }
        Ok(())
    }

    /// Bytes of the file that were read so far.
    pub fn bytes(&self) -> u64 {
        self.table.reader.bytes()
    }

    /// Reads the next rows behind those that are not taken yet.
    fn read(&mut self) -> Result<(), Error> {
        let at = std::mem::take(&mut self.at);
        self.rows.iter_mut().for_each(|values| drop(values.drain(..at)));
        let batch = self.table.next_batch()?;
        self.is_over = batch.is_none();
        for rows in batch.unwrap_or_default() {
            self.count += rows[0].len() as u64;
            self.rows.iter_mut().zip(rows).for_each(|(all, values)| all.extend_from_slice(values));
        }
        Ok(())
    }
}

/// A reading at the time that was asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Reading {
    /// That of a sample.
    Sampled(f64),
    /// On the straight line between two samples.
    Interpolated(f64),
}

impl Reading {
    /// Its value.
    pub fn value(self) -> f64 {
        match self {
            Self::Sampled(value) | Self::Interpolated(value) => value,
        }
    }
}

/// The reading of a file at `t`, which is not before those asked for earlier:
/// `f0 + (f1 - f0) (t - t0) / (t1 - t0)` between the neighbours. None before the first sample, after the last, and in a gap, where
/// the neighbours are farther apart than `gap`.
pub(super) fn reading_at(part: &mut Part, t: f64, gap: f64) -> Result<Option<Reading>, Error> {
    while part.time()?.is_some_and(|time| time <= t) {
        part.pass();
    }
    Ok(match (part.before, part.time()?) {
        (Some([t0, f0]), _) if t0 == t => Some(Reading::Sampled(f0)),
        (Some([t0, f0]), Some(t1)) if t1 - t0 <= gap => {
            Some(Reading::Interpolated(f0 + (part.reading() - f0) * ((t - t0) / (t1 - t0))))
        }
        _ => None,
    })
}
