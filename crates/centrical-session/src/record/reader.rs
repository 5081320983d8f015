//! Records and telemetry from their files, batch by batch, in SI.

use std::path::Path;

use centrical::reduction::{Record, RecordSlice, SpeedTrace};
use centrical::{OnProgress, advance};
use centrical_table::{Extent, Index, Reread, Rows, Source, Stamps, TableLines};

use super::columns::{
    CheckedTable, Column, Columns, Form, MissingReadings, PULSES, RECORD, Scale, TELEMETRY, TimeSpan,
};
use super::equal_columns::EqualColumns;
use super::joined::Joined;
use crate::error::{Error, Place};

/// Reads the record of a mounting in its file, or in the three of its newtonometers, as far as it was written. `progress` is
/// called with the number of bytes read.
///
/// # Errors
/// As [`RecordReader::next_batch`]; [`Error::Stopped`].
pub(crate) fn read_records(
    sources: Vec<Source>,
    columns: &Columns,
    extent: Extent,
    progress: OnProgress,
) -> Result<Record, Error> {
    RecordReader::open_all(sources, extent, columns)?.into_record(progress)
}

/// Reads the telemetry of `file`.
///
/// # Errors
/// As [`RecordReader::next_batch`].
pub(crate) fn read_telemetry(file: &Path, columns: &Columns) -> Result<SpeedTrace, Error> {
    telemetry_of(Source::open(file, TELEMETRY)?, columns, Extent::Whole)
}

/// Reads telemetry as far as it was written.
///
/// # Errors
/// As [`RecordReader::next_batch`].
pub(crate) fn telemetry_of(source: Source, columns: &Columns, extent: Extent) -> Result<SpeedTrace, Error> {
    let form = Form { lines: columns.telemetry_lines, missing: None, expected: TELEMETRY };
    let [t, omega] = whole_columns(source, extent, [&columns.telemetry_time, &columns.speed], form)?;
    Ok(SpeedTrace { t, omega })
}

/// Reads times of pulses [s] as far as they were written.
///
/// # Errors
/// As [`RecordReader::next_batch`].
pub(crate) fn pulses_of(source: Source, columns: &Columns, extent: Extent) -> Result<Vec<f64>, Error> {
    let form = Form { lines: TableLines::default(), missing: None, expected: PULSES };
    let [times] = whole_columns(source, extent, [&columns.pulse], form)?;
    Ok(times)
}

/// All values of some columns, in SI.
fn whole_columns<const N: usize>(
    source: Source,
    extent: Extent,
    columns: [&Column; N],
    form: Form,
) -> Result<[Vec<f64>; N], Error> {
    let mut reader = RecordReader::with(source, extent, &columns, form)?;
    let mut all = [const { Vec::new() }; N];
    while let Some(batch) = reader.next_batch()? {
        for rows in batch {
            all.iter_mut().zip(rows).for_each(|(all, values)| all.extend_from_slice(values));
        }
    }
    Ok(all)
}

/// A record that is read in memory that does not grow with it.
pub struct RecordReader {
    table: Tables,
    scales: Scales,
    /// Of one file with three readings, where it is asked.
    equal: Option<EqualColumns>,
    /// Where it must not be of years.
    span: Option<TimeSpan>,
    /// Bytes that [`RecordReader::newly_read`] has returned.
    reported: u64,
}

impl RecordReader {
    /// Opens the record of `file`; a reading that it may lack is NaN.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn open(file: &Path, columns: &Columns) -> Result<Self, Error> {
        // Readings to be compensated are as they are, in any unit of time.
        let form = Form { lines: columns.record_lines, missing: Some(columns.missing_readings), expected: RECORD };
        let mut record = Self::with(Source::open(file, RECORD)?, Extent::Whole, &columns.of_record(), form)?;
        if let Tables::One(table) = &mut record.table {
            // Rows are left out together with their stamps, by whoever takes these.
            table.missing = None;
        }
        Ok(Self { span: None, ..record })
    }

    /// Reads the record in a source, or in three, one for each newtonometer.
    ///
    /// # Errors
    /// If one cannot be read.
    pub(crate) fn open_all(sources: Vec<Source>, extent: Extent, columns: &Columns) -> Result<Self, Error> {
        let (of_record, missing) = (columns.of_record(), Some(columns.missing_readings));
        match <[Source; 3]>::try_from(sources) {
            Ok(sources) => {
                let table = Tables::Three(Box::new(Joined::open(sources, extent, columns)?));
                Ok(Self::of(table, &of_record))
            }
            Err(mut sources) => {
                let form = Form { lines: columns.record_lines, missing, expected: RECORD };
                let one = Self::with(sources.remove(0), extent, &of_record, form)?;
                let names = columns.f.each_ref().map(|column| column.name.to_string());
                Ok(Self { equal: Some(EqualColumns::of(names)), ..one })
            }
        }
    }

    fn with(source: Source, extent: Extent, columns: &[&Column], form: Form) -> Result<Self, Error> {
        Ok(Self::of(Tables::One(Box::new(CheckedTable::of_columns(source, extent, columns, form)?)), columns))
    }

    fn of(table: Tables, columns: &[&Column]) -> Self {
        Self { table, scales: Scales::of(columns), equal: None, span: Some(TimeSpan::EMPTY), reported: 0 }
    }

    /// The next rows: columns of time [s] and of readings [m/s^2] ([`stretch`]), several sets of them, to be worked on where they
    /// are; none at the end.
    ///
    /// Time never decreases from row to row; it may stand still, as real streams repeat samples.
    ///
    /// # Errors
    /// [`Error`]:
    /// - if the file cannot be read, has no rows or lacks a column;
    /// - if a value is not finite, unless such rows are left out;
    /// - if time runs backwards;
    /// - if the file names other units than those of the columns;
    /// - at the end, if two readings of a session are the same;
    /// - at the end, if its time spans more than ten years.
    pub fn next_batch(&mut self) -> Result<Option<&mut [Rows]>, Error> {
        let is_over = match &mut self.table {
            Tables::One(table) => table.next_batch()?.is_none(),
            Tables::Three(joined) => joined.next_batch()? == 0,
        };
        if is_over {
            if let (Some(equal), Tables::One(table)) = (&self.equal, &self.table) {
                equal.refuse(&table.file)?;
            }
            if let Some(span) = self.span {
                span.refuse_years(self.table.file(), Place::Whole)?;
            }
            return Ok(None);
        }
        if let Some(equal) = &mut self.equal {
            // Before the scales, which may differ.
            self.table.batch().iter().for_each(|rows| equal.see([&rows[1], &rows[2], &rows[3]]));
        }
        let batch = self.scales.apply_to(self.table.batch());
        if let Some(span) = &mut self.span {
            for rows in &*batch {
                span.see(&rows[0]);
            }
        }
        Ok(Some(batch))
    }

    /// The rows that were read last, once more.
    pub(crate) fn batch(&mut self) -> &mut [Rows] {
        self.table.batch()
    }

    /// Keeps stamps as they are read, for [`RecordReader::take_stamps`].
    pub(crate) fn keep_stamps(&mut self) {
        if let Tables::One(table) = &mut self.table {
            table.reader.keep_stamps();
        }
    }

    /// Stamps of the rows that were read last; one entry for each set.
    pub(crate) fn take_stamps(&mut self) -> Vec<Stamps> {
        match &mut self.table {
            Tables::One(table) => table.reader.take_stamps(),
            Tables::Three(joined) => vec![Stamps::default(); joined.batch().len()],
        }
    }

    /// Readings of newtonometers 1, 2, 3 that were interpolated to the stamps of another one; none where all are samples of one
    /// file, or joined by their stamps.
    pub(super) fn interpolated(&self) -> Option<[u64; 3]> {
        match &self.table {
            Tables::One(_) => None,
            Tables::Three(joined) => joined.interpolated(),
        }
    }

    /// Bytes of the file that were read since this was last asked.
    pub(crate) fn newly_read(&mut self) -> u64 {
        let before = std::mem::replace(&mut self.reported, self.table.bytes());
        self.reported - before
    }

    /// After the end: where the samples are, if any part can be read again.
    pub(super) fn into_index(self) -> Option<RecordIndex> {
        let Tables::One(table) = self.table else { return None };
        let CheckedTable { reader, missing, .. } = *table;
        let (scales, missing) = (self.scales, missing.unwrap_or_default());
        reader.into_index().map(|index| RecordIndex { index, scales, missing })
    }

    /// All that is left of the record. `progress` is called with the number of bytes read.
    ///
    /// # Errors
    /// As [`RecordReader::next_batch`]; [`Error::Stopped`].
    pub fn into_record(mut self, progress: OnProgress) -> Result<Record, Error> {
        let mut record = Record::default();
        while let Some(batch) = self.next_batch()? {
            for rows in batch {
                record.extend(stretch(rows));
            }
            advance(progress, self.newly_read())?;
        }
        advance(progress, self.newly_read())?;
        Ok(record)
    }
}

/// The file of a record, or its three.
enum Tables {
    One(Box<CheckedTable>),
    Three(Box<Joined>),
}

impl Tables {
    /// The file, the first of three.
    fn file(&self) -> &Path {
        match self {
            Self::One(table) => &table.file,
            Self::Three(joined) => joined.file(),
        }
    }

    fn batch(&mut self) -> &mut [Rows] {
        match self {
            Self::One(table) => table.reader.batch(),
            Self::Three(joined) => joined.batch(),
        }
    }

    fn bytes(&self) -> u64 {
        match self {
            Self::One(table) => table.reader.bytes(),
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
    missing: MissingReadings,
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
        let RecordIndex { index, scales, missing } = self.index;
        let raw = scales.raw_range(part);
        samples.clear();
        self.table.seek(raw);
        while let Some(batch) = self.table.next_batch()? {
            for rows in &mut *batch {
                missing.leave_out(rows);
            }
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
