//! Records as Parquet: four columns of doubles, plain, since the last digits of readings do not compress.

use std::fs::File;
use std::io;
use std::sync::Arc;

use parquet::data_type::DoubleType;
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;

use super::Table;
use centrical::reduction::RecordSlice;

/// Rows in a row group: 32 MB, so that readers have pieces to share and the footer stays short.
const GROUP: usize = 1 << 20;

const SCHEMA: &str =
    "message record { required double t; required double f1; required double f2; required double f3; }";

/// A Parquet file in the making.
pub(super) struct ParquetTable {
    output: SerializedFileWriter<File>,
    /// Rows of the next group, by columns.
    group: [Vec<f64>; 4],
}

impl ParquetTable {
    pub fn new(output: File) -> io::Result<Self> {
        let schema = Arc::new(parse_message_type(SCHEMA).map_err(other)?);
        let properties = Arc::new(WriterProperties::builder().set_dictionary_enabled(false).build());
        let output = SerializedFileWriter::new(output, schema, properties).map_err(other)?;
        Ok(Self { output, group: [const { Vec::new() }; 4] })
    }
}

impl Table for ParquetTable {
    fn write(&mut self, block: RecordSlice) -> io::Result<()> {
        let [f1, f2, f3] = block.f_z;
        for (column, values) in self.group.iter_mut().zip([block.t, f1, f2, f3]) {
            column.extend_from_slice(values);
        }
        if self.group[0].len() >= GROUP { self.flush() } else { Ok(()) }
    }

    fn finish(mut self: Box<Self>) -> io::Result<()> {
        self.flush()?;
        let file = self.output.into_inner().map_err(other)?;
        file.sync_all()
    }
}

impl ParquetTable {
    /// Writes the rows gathered so far as a group.
    fn flush(&mut self) -> io::Result<()> {
        let mut group = self.output.next_row_group().map_err(other)?;
        for values in &mut self.group {
            if let Some(mut column) = group.next_column().map_err(other)? {
                column.typed::<DoubleType>().write_batch(values, None, None).map_err(other)?;
                column.close().map_err(other)?;
            }
            values.clear();
        }
        group.close().map_err(other)?;
        Ok(())
    }
}

fn other(error: ParquetError) -> io::Error {
    io::Error::other(error)
}
