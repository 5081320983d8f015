//! Tables as Parquet, written behind.

use std::io;

use super::output::{Output, Sink, SteadyFile};
use super::parquet::{Layout, ParquetTable, RowGroup};

/// Row groups that may wait to be written.
const AHEAD: usize = 1;

/// A Parquet file in the making.
pub(super) struct RowGroups {
    output: Output<RowGroup>,
    /// The next one.
    next: RowGroup,
}

impl Sink<RowGroup> for ParquetTable<SteadyFile> {
    fn write(&mut self, group: &mut RowGroup) -> io::Result<()> {
        self.write_group(group)
    }

    fn finish(self) -> io::Result<()> {
        ParquetTable::finish(self)?.finish()
    }
}

impl RowGroups {
    /// Begins the file.
    pub fn new(file: SteadyFile, names: &[&str]) -> io::Result<Self> {
        let table = ParquetTable::new(file, Layout::PLAIN, names)?;
        Ok(Self { output: Output::new(table, AHEAD), next: RowGroup::default() })
    }

    /// Adds rows, piece after piece.
    pub fn write<const N: usize>(&mut self, pieces: &[[&[f64]; N]]) -> io::Result<()> {
        for columns in pieces {
            if self.next.add(columns) {
                self.flush()?;
            }
        }
        Ok(())
    }

    /// Writes the rest and sees it to the disk.
    pub fn finish(mut self) -> io::Result<()> {
        self.flush()?;
        self.output.finish()
    }

    /// Ends the row group.
    fn flush(&mut self) -> io::Result<()> {
        let mut room = self.output.room();
        room.clear();
        self.output.send(std::mem::replace(&mut self.next, room))
    }
}
