//! Tables out, as CSV or Parquet.

mod csv;
mod decimal;
mod file;
mod folder;
mod format;
mod output;
mod outputs;
mod parquet;
mod row_groups;
mod text_lines;
mod typed;

use std::io;
use std::path::{Path, PathBuf};

pub use self::csv::csv_field;
use self::csv::{CsvTable, TextTable};
pub use self::decimal::Decimals;
use self::file::Beside;
pub use self::file::{abandon_files, write_stream, write_together, write_whole};
pub use self::folder::{ClaimedFolder, claim_folder, create_folder, holder_of_lock};
use self::format::not_written;
pub use self::format::{TableFormat, is_ending_of_table};
use self::output::SteadyFile;
pub use self::outputs::{Outputs, refuse_inputs};
use self::parquet::{Layout, ParquetTable};
use self::row_groups::RowGroups;
pub use self::typed::TypedWriter;
use crate::error::{Error, Place};
use crate::stamp::Stamps;

/// Writes a long table beside the file, piece by piece, and renames at the end: whoever looks sees the whole table or none.
/// It is on the disk then. Numbers read back as they were unless they are rounded; NaN is written as such.
///
/// Each call passes on to what is compiled here for any number of columns: a caller compiled for size loses nothing.
pub struct TableWriter<const N: usize>(OpenTable);

struct OpenTable {
    file: PathBuf,
    /// The table in the making. It ends before the file that it is written to.
    table: Table,
    beside: Beside,
}

enum Table {
    Text(TextTable),
    Parquet(RowGroups),
}

impl<const N: usize> TableWriter<N> {
    /// Begins a table of columns with these names, in the format of the file's name. Text has numbers of the given decimals.
    ///
    /// # Errors
    /// [`Error::Io`] if the folder does not take the file.
    pub fn create(file: &Path, names: &[&str; N], decimals: [Decimals; N]) -> Result<Self, Error> {
        OpenTable::create(file, names, &decimals).map(Self)
    }

    /// Adds rows, given as pieces of all columns, on all threads.
    ///
    /// # Errors
    /// [`Error::Io`] if they cannot be written.
    pub fn write(&mut self, pieces: &[[&[f64]; N]]) -> Result<(), Error> {
        let pieces: Vec<&[&[f64]]> = pieces.iter().map(<[_; N]>::as_slice).collect();
        self.0.write(&pieces)
    }

    /// Adds rows that begin with stamps in place of the numbers of the first column, where they have one, given as a piece of all
    /// columns.
    ///
    /// A text has them as they were written, or in ISO 8601 with all decimals of their unit. Parquet has a column of timestamps if the
    /// first row of all has a date: with the unit of the stamps (milliseconds of seconds, nanoseconds of texts), in UTC if they are. It has
    /// numbers of a time of the day.
    ///
    /// # Errors
    /// [`Error::Io`] if they cannot be written, or if a later row does not fit a column of timestamps that was begun.
    pub fn write_stamped(&mut self, stamps: &Stamps, piece: [&[f64]; N]) -> Result<(), Error> {
        self.0.write_stamped(stamps, &piece)
    }

    /// Ends the table; only now the file is there.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be written.
    pub fn finish(self) -> Result<(), Error> {
        self.0.finish()
    }
}

impl OpenTable {
    fn create(file: &Path, names: &[&str], decimals: &[Decimals]) -> Result<Self, Error> {
        let failed = |error| Error::writing(file, error);
        if let Some(name) = not_written(file) {
            let found = format!("the name of a format that is not written ({name})");
            return Err(Error::content(file, Place::Whole, found, "a name that ends in .csv, or in .parquet"));
        }
        let (beside, output) = Beside::create(file).map_err(failed)?;
        let output = SteadyFile::new(output).map_err(failed)?;
        let table = match TableFormat::of(file) {
            TableFormat::Csv => TextTable::new(output, names, decimals).map(Table::Text),
            TableFormat::Parquet => Ok(Table::Parquet(RowGroups::new(output, names))),
        };
        Ok(Self { file: file.to_owned(), table: table.map_err(failed)?, beside })
    }

    fn write(&mut self, pieces: &[&[&[f64]]]) -> Result<(), Error> {
        let written = match &mut self.table {
            Table::Text(table) => table.write(pieces),
            Table::Parquet(table) => table.write(pieces),
        };
        written.map_err(|error| Error::writing(&self.file, error))
    }

    fn write_stamped(&mut self, stamps: &Stamps, piece: &[&[f64]]) -> Result<(), Error> {
        let written = match &mut self.table {
            Table::Text(table) => table.write_stamped(stamps, piece),
            Table::Parquet(table) => table.write_stamped(stamps, piece),
        };
        written.map_err(|error| Error::writing(&self.file, error))
    }

    fn finish(self) -> Result<(), Error> {
        let finished = match self.table {
            Table::Text(table) => table.finish(),
            Table::Parquet(table) => table.finish(),
        };
        finished.and_then(|()| self.beside.take_place()).map_err(|error| Error::writing(&self.file, error))
    }
}

/// Writes a table that can be made again, as by [`write_stream`]: stretches of its columns in order. A number keeps nine decimals
/// as text, and is packed in Parquet.
///
/// # Errors
/// [`Error::Io`] if the folder does not take the file, or a stretch cannot be made; there is no file then.
pub fn write_table<const N: usize>(
    file: &Path,
    format: TableFormat,
    names: &[&str; N],
    stretches: impl Iterator<Item = io::Result<[Vec<f64>; N]>>,
) -> Result<(), Error> {
    let mut stretches = stretches.map(|rows| rows.map(Vec::from));
    write_stretches(file, format, names, &mut stretches)
}

fn write_stretches(
    file: &Path,
    format: TableFormat,
    names: &[&str],
    stretches: &mut dyn Iterator<Item = io::Result<Vec<Vec<f64>>>>,
) -> Result<(), Error> {
    write_stream(file, |output| match format {
        TableFormat::Csv => {
            let mut table = CsvTable::new(output, names)?;
            for rows in stretches {
                table.write(&rows?)?;
            }
            Ok(())
        }
        TableFormat::Parquet => {
            let mut table = ParquetTable::new(output, Layout::PACKED, names, None)?;
            for rows in stretches {
                table.write(&rows?)?;
            }
            table.finish().map(|_| ())
        }
    })
}

/// A short table as a Parquet file.
///
/// # Errors
/// If the table cannot be packed.
pub fn parquet_bytes(names: &[&str], columns: &[Vec<f64>]) -> io::Result<Vec<u8>> {
    let mut table = ParquetTable::new(Vec::new(), Layout::PACKED, names, None)?;
    table.write(columns)?;
    table.finish()
}
