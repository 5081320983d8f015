//! Three files of one mounting, one for each newtonometer, as one table.
//!
//! Rows with the same stamp in all three are joined. What one file lacks, as it began later, ended earlier or lost a sample, is a gap of
//! all: nothing is resampled. Files of which most rows find no partner have different clocks or rates, and are refused.

use std::path::{Path, PathBuf};

use centrical_table::{Extent, Rows, TableReader};

use super::columns::{Columns, fields};
use super::units_found::check_units;
use crate::error::{Error, Place};

/// Rows of a set, and sets of a batch.
const ROWS: usize = 16 * 1024;
const SETS: usize = 8;

/// Three tables of time and one reading each.
pub(super) struct Joined {
    parts: [Part; 3],
    extent: Extent,
    sets: Vec<Rows>,
    filled: usize,
    /// Rows that were joined so far.
    count: u64,
}

/// One of them.
struct Part {
    file: PathBuf,
    /// Names and units of its columns, until those in the file are held against them.
    units: Option<[(String, String); 2]>,
    table: TableReader,
    /// Rows that are read and not joined yet begin at `at`.
    rows: Rows,
    at: usize,
    is_over: bool,
    count: u64,
}

impl Joined {
    /// Opens the files of newtonometers 1, 2, 3.
    pub fn open(files: [&Path; 3], extent: Extent, columns: &Columns) -> Result<Self, Error> {
        let open = |j: usize| {
            let of_file = [&columns.time, &columns.f[j]];
            let lines = columns.record_lines;
            let table =
                TableReader::open_at(files[j], extent, &fields(&of_file), "the record of a newtonometer", lines)?;
            let units = Some(of_file.map(|column| (column.name.to_string(), column.unit.clone())));
            let rows = vec![Vec::new(); 2];
            Ok(Part { file: files[j].to_owned(), units, table, rows, at: 0, is_over: false, count: 0 })
        };
        let parts: [Result<Part, Error>; 3] = [0, 1, 2].map(open);
        let [x, y, z] = parts;
        Ok(Self { parts: [x?, y?, z?], extent, sets: vec![vec![Vec::new(); 4]; SETS], filled: 0, count: 0 })
    }

    /// The next rows: time and three readings, raw. How many sets there are; none at the end.
    pub fn next_batch(&mut self) -> Result<usize, Error> {
        self.filled = 0;
        while self.filled < SETS && self.fill()? {
            self.filled += 1;
        }
        if self.filled == 0 && self.extent == Extent::Whole {
            self.check()?;
        }
        Ok(self.filled)
    }

    /// The rows that were read last.
    pub fn batch(&mut self) -> &mut [Rows] {
        &mut self.sets[..self.filled]
    }

    /// Bytes of the files that were read so far.
    pub fn bytes(&self) -> u64 {
        self.parts.iter().map(|part| part.table.bytes()).sum()
    }

    /// Fills the next set; whether there are any rows.
    fn fill(&mut self) -> Result<bool, Error> {
        let rows = &mut self.sets[self.filled];
        rows.iter_mut().for_each(Vec::clear);
        while rows[0].len() < ROWS {
            let mut times = [None; 3];
            for (time, part) in times.iter_mut().zip(&mut self.parts) {
                *time = part.time()?;
            }
            let [Some(x), Some(y), Some(z)] = times else { break };
            let latest = x.max(y).max(z);
            if x == y && y == z {
                rows[0].push(latest);
                for (values, part) in rows[1..].iter_mut().zip(&mut self.parts) {
                    values.push(part.rows[1][part.at]);
                    part.at += 1;
                }
            } else {
                for (part, time) in self.parts.iter_mut().zip([x, y, z]) {
                    part.at += usize::from(time < latest);
                }
            }
        }
        self.count += rows[0].len() as u64;
        Ok(!rows[0].is_empty())
    }

    /// Sees at the end that most rows of every file found partners.
    fn check(&mut self) -> Result<(), Error> {
        let joined = self.count;
        for part in &mut self.parts {
            while part.time()?.is_some() {
                part.at = part.rows[0].len();
            }
        }
        let [first, others @ ..] = &self.parts;
        for part in others.iter().chain([first]) {
            if 2 * joined < part.count {
                let found = format!("{joined} of {} samples with a stamp that the other files have too", part.count);
                let expected = format!(
                    "the stamps of {}: the files of one mounting have one clock and one rate (nothing is resampled)",
                    if part.file == first.file { &others[0].file } else { &first.file }.display()
                );
                return Err(Error::content(&part.file, Place::Whole, found, expected));
            }
        }
        Ok(())
    }
}

impl Part {
    /// The time of the next row; none at the end.
    fn time(&mut self) -> Result<Option<f64>, Error> {
        while self.at == self.rows[0].len() && !self.is_over {
            self.at = 0;
            self.rows.iter_mut().for_each(Vec::clear);
            self.is_over = self.table.next_batch()?.is_none();
            if self.is_over {
                break;
            }
            if let Some(units) = self.units.take() {
                let units = units.iter().map(|(name, unit)| (name.clone(), unit.as_str()));
                check_units(&self.file, self.table.units().as_ref(), units)?;
            }
            for rows in self.table.batch() {
                self.count += rows[0].len() as u64;
                self.rows.iter_mut().zip(rows).for_each(|(all, values)| all.extend_from_slice(values));
            }
        }
        Ok(self.rows[0].get(self.at).copied())
    }
}
