//! Records out, block by block: CSV, or Parquet where the file's name ends in `.parquet`.

mod output;
mod parquet;
mod text;

use std::ffi::OsString;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use self::output::SteadyFile;
use self::parquet::RowGroups;
use self::text::TextTable;
use crate::error::Error;
use crate::text_lines::Decimals;
use centrical::reduction::RecordSlice;

/// Writes `t` [s], `f1`, `f2`, `f3` [m/s^2] beside the file and renames at the end: whoever looks sees the whole
/// record or none. Numbers read back as they were unless they are rounded; NaN is written as such.
pub struct RecordWriter {
    file: PathBuf,
    /// Decimals of rounded specific forces.
    decimals: Option<u32>,
    beside: OsString,
    /// The table in the making; none once it is finished.
    table: Option<Box<dyn Table>>,
}

/// A format.
trait Table: Send {
    /// Adds rows.
    fn write(&mut self, blocks: &[RecordSlice]) -> io::Result<()>;

    /// Writes what is left and sees it to the disk.
    fn finish(self: Box<Self>) -> io::Result<()>;
}

impl RecordWriter {
    /// Begins a record.
    ///
    /// # Errors
    /// [`Error::Io`] if the folder does not take the file.
    pub fn create(file: &Path) -> Result<Self, Error> {
        Self::begin(file, None)
    }

    /// Begins a record of specific forces within `range` [m/s^2]. As text they have so many decimals that half of the last
    /// one is at most `10^-12` of the range; they are shorter so, and sooner made.
    ///
    /// # Errors
    /// As [`RecordWriter::create`].
    pub fn create_rounded(file: &Path, range: f64) -> Result<Self, Error> {
        Self::begin(file, Decimals::for_range(range))
    }

    fn begin(file: &Path, decimals: Option<Decimals>) -> Result<Self, Error> {
        let mut beside = file.as_os_str().to_owned();
        beside.push(".tmp");
        let failed = |error| Error::writing(file, error);
        let output = File::create(&beside).and_then(SteadyFile::new).map_err(failed)?;
        let is_parquet = file.extension().is_some_and(|e| e.eq_ignore_ascii_case("parquet"));
        let decimals = decimals.filter(|_| !is_parquet);
        let table: Box<dyn Table> = if is_parquet {
            Box::new(RowGroups::new(output).map_err(failed)?)
        } else {
            Box::new(TextTable::new(output, decimals).map_err(failed)?)
        };
        Ok(Self { file: file.to_owned(), decimals: decimals.map(Decimals::count), beside, table: Some(table) })
    }

    /// Decimals that the specific forces have, if they are rounded.
    pub fn decimals(&self) -> Option<u32> {
        self.decimals
    }

    /// Adds a stretch of the record.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be written.
    pub fn write(&mut self, block: RecordSlice) -> Result<(), Error> {
        self.write_all(&[block])
    }

    /// Adds several, on all threads.
    ///
    /// # Errors
    /// As [`RecordWriter::write`].
    pub fn write_all(&mut self, blocks: &[RecordSlice]) -> Result<(), Error> {
        let written = self.table.as_mut().map_or(Ok(()), |table| table.write(blocks));
        written.map_err(|error| Error::writing(&self.file, error))
    }

    /// Ends the record; only now the file is there.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be written.
    pub fn finish(mut self) -> Result<(), Error> {
        let finished = self.table.take().map_or(Ok(()), Table::finish);
        finished.and_then(|()| fs::rename(&self.beside, &self.file)).map_err(|error| {
            // Best effort: the first error is the one to tell.
            let _ = fs::remove_file(&self.beside);
            Error::writing(&self.file, error)
        })
    }
}

impl Drop for RecordWriter {
    /// Leaves nothing of a record that was not finished.
    fn drop(&mut self) {
        if self.table.take().is_some() {
            let _ = fs::remove_file(&self.beside);
        }
    }
}
