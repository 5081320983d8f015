//! Records and telemetry from their files, batch by batch, in SI.

use std::path::{Path, PathBuf};

use centrical::reduction::{Record, RecordSlice, SpeedTrace};
use centrical_table::{Extent, Index, Reread, Rows, Stamps, TableLines, TableReader};

use super::columns::{Column, Columns, Scale, fields};
use super::joined::Joined;
use super::units_found::StatedUnits;
use crate::error::Error;

/// Reads the whole record of `file`.
///
/// # Errors
/// As [`RecordReader::next_batch`].
pub fn read_record(file: &Path, columns: &Columns) -> Result<Record, Error> {
    RecordReader::open(file, columns)?.into_record()
}

/// Reads the whole record of a mounting in its file, or in the three of its newtonometers.
///
/// # Errors
/// As [`RecordReader::next_batch`].
pub(crate) fn read_records(files: &[&Path], columns: &Columns) -> Result<Record, Error> {
    RecordReader::open_all(files, Extent::Whole, columns)?.into_record()
}

/// Reads the part of them that was written so far.
///
/// # Errors
/// As [`RecordReader::next_batch`].
pub(crate) fn read_growing_records(files: &[&Path], columns: &Columns) -> Result<Record, Error> {
    RecordReader::open_all(files, Extent::Growing, columns)?.into_record()
}

/// Reads the part written so far of a record that is still growing: an incomplete last line is left for the next
/// time. A file of another format than text has to appear whole, by renaming.
///
/// # Errors
/// As [`RecordReader::next_batch`].
pub fn read_growing_record(file: &Path, columns: &Columns) -> Result<Record, Error> {
    let lines = columns.record_lines;
    RecordReader::with(file, Extent::Growing, &columns.of_record(), lines, "a record")?.into_record()
}

/// Reads the telemetry of `file`.
///
/// # Errors
/// As [`RecordReader::next_batch`].
pub fn read_telemetry(file: &Path, columns: &Columns) -> Result<SpeedTrace, Error> {
    telemetry_of(file, columns, Extent::Whole)
}

/// Reads the part written so far of telemetry that is still growing.
///
/// # Errors
/// As [`RecordReader::next_batch`].
pub(crate) fn read_growing_telemetry(file: &Path, columns: &Columns) -> Result<SpeedTrace, Error> {
    telemetry_of(file, columns, Extent::Growing)
}

fn telemetry_of(file: &Path, columns: &Columns, extent: Extent) -> Result<SpeedTrace, Error> {
    let of_telemetry = [&columns.telemetry_time, &columns.speed];
    let mut reader = RecordReader::with(file, extent, &of_telemetry, columns.telemetry_lines, "telemetry")?;
    let mut telemetry = SpeedTrace::default();
    while let Some(batch) = reader.next_batch()? {
        for rows in batch {
            telemetry.t.extend_from_slice(&rows[0]);
            telemetry.omega.extend_from_slice(&rows[1]);
        }
    }
    Ok(telemetry)
}

/// Reads the times of the pulses in `file` [s].
///
/// # Errors
/// As [`RecordReader::next_batch`].
pub fn read_pulses(file: &Path, columns: &Columns) -> Result<Vec<f64>, Error> {
    pulses_of(file, columns, Extent::Whole)
}

/// Reads the part written so far of times that are still being written.
///
/// # Errors
/// As [`RecordReader::next_batch`].
pub(crate) fn read_growing_pulses(file: &Path, columns: &Columns) -> Result<Vec<f64>, Error> {
    pulses_of(file, columns, Extent::Growing)
}

fn pulses_of(file: &Path, columns: &Columns, extent: Extent) -> Result<Vec<f64>, Error> {
    let mut reader = RecordReader::with(file, extent, &[&columns.pulse], TableLines::default(), "times of pulses")?;
    let mut times = Vec::new();
    while let Some(batch) = reader.next_batch()? {
        for rows in batch {
            times.extend_from_slice(&rows[0]);
        }
    }
    Ok(times)
}

/// A record that is read in memory that does not grow with it.
pub struct RecordReader {
    file: PathBuf,
    table: Source,
    scales: Scales,
    units: StatedUnits,
    /// Bytes that [`RecordReader::newly_read`] has returned.
    reported: u64,
}

impl RecordReader {
    /// Opens the record of `file`.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn open(file: &Path, columns: &Columns) -> Result<Self, Error> {
        Self::with(file, Extent::Whole, &columns.of_record(), columns.record_lines, "a record")
    }

    /// Opens the record in a file, or in three, one for each newtonometer.
    ///
    /// # Errors
    /// If one cannot be read.
    pub(crate) fn open_all(files: &[&Path], extent: Extent, columns: &Columns) -> Result<Self, Error> {
        let of_record = columns.of_record();
        if let [x, y, z] = *files {
            let joined = Box::new(Joined::open([x, y, z], extent, columns)?);
            let (file, scales) = (x.to_owned(), Scales::of(&of_record));
            // Each file's part has its own.
            let units = StatedUnits::of([]);
            return Ok(Self { file, table: Source::Three(joined), scales, units, reported: 0 });
        }
        let file = files.first().copied().unwrap_or(Path::new(""));
        Self::with(file, extent, &of_record, columns.record_lines, "a record")
    }

    fn with(
        file: &Path,
        extent: Extent,
        columns: &[&Column],
        lines: TableLines,
        expected: &str,
    ) -> Result<Self, Error> {
        let table = TableReader::open_at(file, extent, &fields(columns), expected, lines)?;
        let units = StatedUnits::of(columns.iter().copied());
        let table = Source::One(Box::new(table));
        Ok(Self { file: file.to_owned(), table, scales: Scales::of(columns), units, reported: 0 })
    }

    /// The next rows: columns of time [s] and of readings [m/s^2] ([`stretch`]), several sets of them, to be worked on where they
    /// are; none at the end.
    ///
    /// Time never decreases from row to row; it may stand still, as real streams repeat samples.
    ///
    /// # Errors
    /// If the file cannot be read, has no rows, lacks a column, or a value is not finite; if time runs
    /// backwards; if the file names other units than those of the columns.
    pub fn next_batch(&mut self) -> Result<Option<&mut [Rows]>, Error> {
        let is_over = match &mut self.table {
            Source::One(table) => table.next_batch()?.is_none(),
            Source::Three(joined) => joined.next_batch()? == 0,
        };
        if is_over {
            return Ok(None);
        }
        if let Source::One(table) = &self.table {
            self.units.check(&self.file, table)?;
        }
        Ok(Some(self.scales.apply_to(self.table.batch())))
    }

    /// The rows that were read last, once more.
    pub(crate) fn batch(&mut self) -> &mut [Rows] {
        self.table.batch()
    }

    /// Keeps stamps as they are read, for [`RecordReader::take_stamps`].
    pub(crate) fn keep_stamps(&mut self) {
        if let Source::One(table) = &mut self.table {
            table.keep_stamps();
        }
    }

    /// Stamps of the rows that were read last; one entry for each set.
    pub(crate) fn take_stamps(&mut self) -> Vec<Stamps> {
        match &mut self.table {
            Source::One(table) => table.take_stamps(),
            Source::Three(joined) => vec![Stamps::default(); joined.batch().len()],
        }
    }

    /// Readings of newtonometers 1, 2, 3 that were interpolated to the stamps of another one; none where all are samples of one
    /// file, or joined by their stamps.
    pub(super) fn interpolated(&self) -> Option<[u64; 3]> {
        match &self.table {
            Source::One(_) => None,
            Source::Three(joined) => joined.interpolated(),
        }
    }

    /// Bytes of the file that were read since this was last asked.
    pub(crate) fn newly_read(&mut self) -> u64 {
        let before = std::mem::replace(&mut self.reported, self.table.bytes());
        self.reported - before
    }

    /// After the end: where the samples are, if any part can be read again.
    pub(super) fn into_index(self) -> Option<RecordIndex> {
        let scales = self.scales;
        let Source::One(table) = self.table else { return None };
        table.into_index().map(|index| RecordIndex { index, scales })
    }

    fn into_record(mut self) -> Result<Record, Error> {
        let mut record = Record::default();
        while let Some(batch) = self.next_batch()? {
            for rows in batch {
                record.extend(stretch(rows));
            }
        }
        Ok(record)
    }
}

/// The file of a record, or its three.
enum Source {
    One(Box<TableReader>),
    Three(Box<Joined>),
}

impl Source {
    fn batch(&mut self) -> &mut [Rows] {
        match self {
            Self::One(table) => table.batch(),
            Self::Three(joined) => joined.batch(),
        }
    }

    fn bytes(&self) -> u64 {
        match self {
            Self::One(table) => table.bytes(),
            Self::Three(joined) => joined.bytes(),
        }
    }
}

/// Rows of a record.
pub fn stretch(rows: &Rows) -> RecordSlice<'_> {
    RecordSlice { t: &rows[0], f_z: [&rows[1], &rows[2], &rows[3]] }
}

/// Where the samples of a record are in its file.
pub(super) struct RecordIndex {
    index: Index,
    scales: Scales,
}

/// Reads parts of a record again.
pub(super) struct PartReader<'a> {
    index: &'a RecordIndex,
    table: Reread<'a>,
}

impl RecordIndex {
    /// The record, to be read again in parts.
    pub fn parts(&self) -> PartReader<'_> {
        PartReader { index: self, table: self.index.reread() }
    }
}

impl PartReader<'_> {
    /// Reads the samples from and to [s] in place of those in `samples`; the bytes that it took.
    pub fn read(&mut self, part: [f64; 2], samples: &mut Record) -> Result<u64, Error> {
        let RecordIndex { index, scales } = self.index;
        let raw = scales.raw_range(part);
        samples.clear();
        self.table.seek(raw);
        while let Some(batch) = self.table.next_batch()? {
            scales.apply_to(batch).iter().for_each(|rows| samples.extend(stretch(rows).between(part)));
        }
        Ok(index.bytes(raw))
    }
}

/// What takes columns to SI.
#[derive(Debug, Clone)]
struct Scales(Vec<Scale>);

impl Scales {
    fn of(columns: &[&Column]) -> Self {
        Self(columns.iter().map(|column| column.scale).collect())
    }

    fn apply_to<'a>(&self, batch: &'a mut [Rows]) -> &'a mut [Rows] {
        for rows in &mut *batch {
            rows.iter_mut().zip(&self.0).for_each(|(values, scale)| scale.apply(values));
        }
        batch
    }

    /// What the first column, time, has in a window. The rounding of its scale is made up for by a part in 10^12.
    fn raw_range(&self, window: [f64; 2]) -> [f64; 2] {
        let [from, to] = window.map(|t| self.0[0].raw(t));
        let slack = 1e-12 * from.abs().max(to.abs());
        [from - slack, to + slack]
    }
}
