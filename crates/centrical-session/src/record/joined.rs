//! Three files of one mounting, one for each newtonometer, as one table.
//!
//! Files of one recorder have the same stamps: rows with one stamp in all three are joined. What one file lacks, as it began later,
//! ended earlier or lost a sample, is a gap of all. Files of three recorders have stamps or rates of their own, on one clock:
//! readings are interpolated to the stamps of the slowest file, neither beyond the ends of a file nor across its gaps.

mod part;
mod stamps;

use std::path::Path;

use centrical_table::{Extent, Rows, Source};

use self::part::{Part, Reading, reading_at};
use self::stamps::Joining;
use super::columns::Columns;
use crate::error::{Error, Place};

/// Rows of a set, and sets of a batch.
const ROWS: usize = 16 * 1024;
const SETS: usize = 8;

/// Stamps of each file that are looked at before its rows are joined.
const BEGINNING: usize = 4096;

/// Three tables of time and one reading each.
pub(super) struct Joined {
    parts: [Part; 3],
    extent: Extent,
    /// Once the beginnings of the files were seen.
    joining: Option<Joining>,
    sets: Vec<Rows>,
    filled: usize,
    /// Rows that were joined so far.
    count: u64,
    /// Of each newtonometer the readings among them that were interpolated, and the rows that there are not for lack of one.
    interpolated: [u64; 3],
    missed: [u64; 3],
}

impl Joined {
    /// Reads the sources of newtonometers 1, 2, 3.
    pub fn open([x, y, z]: [Source; 3], extent: Extent, columns: &Columns) -> Result<Self, Error> {
        let part = |(j, source)| Part::open(source, j, extent, columns);
        let [x, y, z] = [(0, x), (1, y), (2, z)].map(part);
        let sets = vec![vec![Vec::new(); 4]; SETS];
        let (interpolated, missed) = ([0; 3], [0; 3]);
        Ok(Self { parts: [x?, y?, z?], extent, joining: None, sets, filled: 0, count: 0, interpolated, missed })
    }

    /// The next rows: time and three readings, raw. How many sets there are; none at the end.
    pub fn next_batch(&mut self) -> Result<usize, Error> {
        self.filled = 0;
        if self.joining.is_none() {
            self.joining = self.begin()?;
        }
        // Files that are still being written may have no time in common yet.
        let Some(joining) = self.joining else { return Ok(0) };
        while self.filled < SETS && self.fill(joining)? {
            self.filled += 1;
        }
        if self.filled == 0 && self.extent == Extent::Whole {
            match joining {
                Joining::ByStamp => self.check_partners()?,
                Joining::Interpolated { grid, .. } => self.check_readings(grid)?,
            }
        }
        Ok(self.filled)
    }

    /// The rows that were read last.
    pub fn batch(&mut self) -> &mut [Rows] {
        &mut self.sets[..self.filled]
    }

    /// The file of newtonometer 1.
    pub fn file(&self) -> &Path {
        self.parts[0].file()
    }

    /// Bytes of the files that were read so far.
    pub fn bytes(&self) -> u64 {
        self.parts.iter().map(Part::bytes).sum()
    }

    /// Readings of newtonometers 1, 2, 3 that were interpolated so far; none where rows are joined by their stamps.
    pub fn interpolated(&self) -> Option<[u64; 3]> {
        matches!(self.joining, Some(Joining::Interpolated { .. })).then_some(self.interpolated)
    }

    /// Goes to where the last file begins, and sees from there how rows are to be joined. What comes later does not change it: a
    /// growing file is read the same way each time. None where files that are still being written have no time in common.
    fn begin(&mut self) -> Result<Option<Joining>, Error> {
        let (mut last, mut latest) = (0, f64::NEG_INFINITY);
        for (j, part) in self.parts.iter_mut().enumerate() {
            let Some(start) = part.time()? else { return Ok(None) };
            if start > latest {
                (last, latest) = (j, start);
            }
        }
        let mut passed = [0; 3];
        for (part, passed) in self.parts.iter_mut().zip(&mut passed) {
            while part.time()?.is_some_and(|time| time < latest) {
                part.pass();
                *passed += 1;
            }
        }
        let last_file = self.parts[last].file().to_owned();
        for part in &mut self.parts {
            if part.time()?.is_none() {
                if self.extent == Extent::Growing {
                    return Ok(None);
                }
                let found = format!("samples up to t = {}", part.before.map_or(f64::NAN, |[t, _]| t));
                let expected = format!(
                    "samples from t = {latest} on, where {} begins: the files of one mounting have one clock",
                    last_file.display()
                );
                return Err(Error::content(part.file(), Place::Whole, found, expected));
            }
        }
        let [x, y, z] = &mut self.parts;
        let joining = Joining::of([x.times(BEGINNING)?, y.times(BEGINNING)?, z.times(BEGINNING)?]);
        if let Joining::Interpolated { grid, .. } = joining {
            self.missed[last] = passed[grid];
        }
        Ok(Some(joining))
    }

    /// Fills the next set; whether there are any rows.
    fn fill(&mut self, joining: Joining) -> Result<bool, Error> {
        self.sets[self.filled].iter_mut().for_each(Vec::clear);
        match joining {
            Joining::ByStamp => self.fill_by_stamp()?,
            Joining::Interpolated { grid, gaps } => self.fill_interpolated(grid, gaps)?,
        }
        let rows = self.sets[self.filled][0].len();
        self.count += rows as u64;
        Ok(rows > 0)
    }

    /// Rows with one stamp in all files.
    fn fill_by_stamp(&mut self) -> Result<(), Error> {
        let rows = &mut self.sets[self.filled];
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
                    values.push(part.reading());
                    part.skip();
                }
            } else {
                for (part, _) in self.parts.iter_mut().zip([x, y, z]).filter(|(_, time)| *time < latest) {
                    part.skip();
                }
            }
        }
        Ok(())
    }

    /// Rows of one file at whose time the others have readings.
    fn fill_interpolated(&mut self, grid: usize, gaps: [f64; 3]) -> Result<(), Error> {
        let rows = &mut self.sets[self.filled];
        while rows[0].len() < ROWS {
            let Some(t) = self.parts[grid].time()? else { break };
            let mut readings = [None; 3];
            for (j, part) in self.parts.iter_mut().enumerate() {
                readings[j] =
                    if j == grid { Some(Reading::Sampled(part.reading())) } else { reading_at(part, t, gaps[j])? };
                self.missed[j] += u64::from(readings[j].is_none());
            }
            self.parts[grid].skip();
            let [Some(x), Some(y), Some(z)] = readings else { continue };
            rows[0].push(t);
            for (j, reading) in [x, y, z].into_iter().enumerate() {
                rows[1 + j].push(reading.value());
                self.interpolated[j] += u64::from(matches!(reading, Reading::Interpolated(_)));
            }
        }
        Ok(())
    }

    /// Sees at the end that most rows of every file found partners.
    fn check_partners(&mut self) -> Result<(), Error> {
        let joined = self.count;
        for part in &mut self.parts {
            part.skip_all()?;
        }
        let [first, others @ ..] = &self.parts;
        for part in others.iter().chain([first]) {
            if 2 * joined < part.count {
                let found = format!("{joined} of {} samples with a stamp that the other files have too", part.count);
                let expected = format!(
                    "the stamps of {} to the end, as at the beginning: the files of one mounting have one clock",
                    if part.file() == first.file() { others[0].file() } else { first.file() }.display()
                );
                return Err(Error::content(part.file(), Place::Whole, found, expected));
            }
        }
        Ok(())
    }

    /// Sees at the end that the other files have readings at most stamps of `grid`.
    fn check_readings(&self, grid: usize) -> Result<(), Error> {
        let (file, count) = (self.parts[grid].file(), self.parts[grid].count);
        if 2 * self.count >= count {
            return Ok(());
        }
        let worst = (0..3).filter(|j| *j != grid).max_by_key(|j| self.missed[*j]).unwrap_or(grid);
        let found = format!("readings at {} of {count} stamps of {}", count - self.missed[worst], file.display());
        let expected = "most of them between two samples without a gap: the files of one mounting have one clock";
        Err(Error::content(self.parts[worst].file(), Place::Whole, found, expected))
    }
}
