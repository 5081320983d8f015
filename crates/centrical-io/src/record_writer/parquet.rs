//! Records as Parquet.

use std::io;

use super::Table;
use super::output::{Output, Sink, SteadyFile};
use crate::parquet_table::{GROUP, Layout, ParquetTable};
use centrical::reduction::RecordSlice;

/// Row groups that may wait to be written.
const AHEAD: usize = 1;

/// A Parquet file in the making.
pub(super) struct RowGroups {
    output: Output<Group>,
    /// The next row group.
    group: Group,
}

/// Columns of a row group.
type Group = [Vec<f64>; 4];

impl Sink<Group> for ParquetTable<SteadyFile> {
    fn write(&mut self, group: &mut Group) -> io::Result<()> {
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
        Ok(Self { output: Output::new(table, AHEAD), group: Group::default() })
    }

    /// Ends the row group.
    fn flush(&mut self) -> io::Result<()> {
        let mut room = self.output.room();
        room.iter_mut().for_each(Vec::clear);
        self.output.send(std::mem::replace(&mut self.group, room))
    }
}

impl Table for RowGroups {
    fn write(&mut self, blocks: &[RecordSlice]) -> io::Result<()> {
        for block in blocks {
            let [f1, f2, f3] = block.f_z;
            for (column, values) in self.group.iter_mut().zip([block.t, f1, f2, f3]) {
                column.extend_from_slice(values);
            }
            if self.group[0].len() >= GROUP {
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
