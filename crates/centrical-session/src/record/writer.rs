//! Records out, stretch by stretch: CSV, or Parquet where the file's name ends in `.parquet` or `.pq`.

use std::path::Path;

use centrical::reduction::RecordSlice;
use centrical_table::{Decimals, Stamps, TableFormat, TableWriter};

use crate::error::Error;

/// Writes `t` [s], `f1`, `f2`, `f3` [m/s^2] beside the file and renames at the end: whoever looks sees the whole
/// record or none. Numbers read back as they were unless they are rounded; NaN is written as such.
pub struct RecordWriter {
    /// Decimals of rounded specific forces.
    decimals: Option<u32>,
    table: TableWriter<4>,
}

impl RecordWriter {
    /// Begins a record.
    ///
    /// # Errors
    /// [`Error::Table`] if the folder does not take the file.
    pub fn create(file: &Path) -> Result<Self, Error> {
        Self::begin(file, None)
    }

    /// Begins a record of specific forces within `range` [m/s^2]. As text they have the fewest decimals whose last half
    /// unit is at most `10^-12` of the range, which is shorter and faster.
    ///
    /// # Errors
    /// As [`RecordWriter::create`].
    pub fn create_rounded(file: &Path, range: f64) -> Result<Self, Error> {
        Self::begin(file, Decimals::for_range(range))
    }

    fn begin(file: &Path, decimals: Option<Decimals>) -> Result<Self, Error> {
        let decimals = decimals.filter(|_| TableFormat::of(file) == TableFormat::Csv);
        let of_force = decimals.unwrap_or(Decimals::SHORTEST);
        let of_columns = [Decimals::SHORTEST, of_force, of_force, of_force];
        let table = TableWriter::create(file, &["t", "f1", "f2", "f3"], of_columns)?;
        Ok(Self { decimals: decimals.map(Decimals::count), table })
    }

    /// Decimals that the specific forces have, if they are rounded.
    pub fn decimals(&self) -> Option<u32> {
        self.decimals
    }

    /// Adds a stretch of the record.
    ///
    /// # Errors
    /// [`Error::Table`] if it cannot be written.
    pub fn write(&mut self, stretch: RecordSlice) -> Result<(), Error> {
        self.write_all(&[stretch])
    }

    /// Adds several, on all threads.
    ///
    /// # Errors
    /// As [`RecordWriter::write`].
    pub fn write_all(&mut self, stretches: &[RecordSlice]) -> Result<(), Error> {
        let pieces: Vec<_> = stretches.iter().map(|RecordSlice { t, f_z: [f1, f2, f3] }| [*t, f1, f2, f3]).collect();
        Ok(self.table.write(&pieces)?)
    }

    /// Adds a stretch whose rows begin with stamps as they were read ([`TableWriter::write_stamped`]).
    ///
    /// # Errors
    /// As [`RecordWriter::write`].
    pub fn write_stamped(&mut self, stamps: &Stamps, stretch: RecordSlice) -> Result<(), Error> {
        let RecordSlice { t, f_z: [f1, f2, f3] } = stretch;
        Ok(self.table.write_stamped(stamps, [t, f1, f2, f3])?)
    }

    /// Ends the record; only now the file is there.
    ///
    /// # Errors
    /// [`Error::Table`] if it cannot be written.
    pub fn finish(self) -> Result<(), Error> {
        Ok(self.table.finish()?)
    }
}
