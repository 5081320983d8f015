//! Records as Parquet.

use std::io;

use super::Table;
use super::output::{Output, Sink, SteadyFile};
use crate::parquet_table::{Layout, ParquetTable, RowGroup};
use centrical::reduction::RecordSlice;

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
    pub fn new(file: SteadyFile) -> io::Result<Self> {
        let table = ParquetTable::new(file, Layout::PLAIN, &["t", "f1", "f2", "f3"])?;
        Ok(Self { output: Output::new(table, AHEAD), next: RowGroup::default() })
    }

    /// Ends the row group.
    fn flush(&mut self) -> io::Result<()> {
        let mut room = self.output.room();
        room.clear();
        self.output.send(std::mem::replace(&mut self.next, room))
    }
}

impl Table for RowGroups {
    fn write(&mut self, blocks: &[RecordSlice]) -> io::Result<()> {
        for block in blocks {
            let [f1, f2, f3] = block.f_z;
            if self.next.add(&[block.t, f1, f2, f3]) {
                self.flush()?;
            }
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> io::Result<()> {
        self.flush()?;
        self.output.finish()
    }
}
