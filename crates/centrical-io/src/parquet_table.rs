//! Tables of numbers as Parquet.

use std::io::{self, Write};
use std::mem;
use std::sync::Arc;

use bytes::Bytes;
use parquet::basic::{Compression, Repetition, Type as Physical};
use parquet::column::writer::{ColumnCloseResult, ColumnWriterImpl};
use parquet::data_type::DoubleType;
use parquet::errors::ParquetError;
use parquet::file::properties::{EnabledStatistics, WriterProperties, WriterPropertiesPtr};
use parquet::file::writer::{SerializedFileWriter, SerializedPageWriter, TrackedWrite};
use parquet::schema::types::{ColumnDescPtr, Type};
use rayon::prelude::*;

/// How a table is laid out in its file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Layout {
    name: &'static str,
    compression: Compression,
}

impl Layout {
    /// Readings with all their digits, which do not compress.
    pub const PLAIN: Self = Self { name: "record", compression: Compression::UNCOMPRESSED };
    /// Numbers of few digits.
    pub const PACKED: Self = Self { name: "schema", compression: Compression::SNAPPY };
}

/// Rows in a row group: a MB a column, which the processor's caches hold from the first number to the last page.
const GROUP: usize = 1 << 17;

/// A table that is written row group by row group.
pub(crate) struct ParquetTable<W: Write + Send> {
    file: SerializedFileWriter<W>,
    /// The next row group.
    columns: Vec<Column>,
}

/// A column of a row group.
#[derive(Default)]
struct Column {
    values: Vec<f64>,
    /// Room for its pages: memory that is asked for anew would be faulted in anew, page by page.
    room: Vec<u8>,
}

impl<W: Write + Send> ParquetTable<W> {
    /// Begins the table: required doubles under `names`.
    pub fn new<S: AsRef<str>>(output: W, layout: Layout, names: &[S]) -> io::Result<Self> {
        let column = |name: &S| {
            Type::primitive_type_builder(name.as_ref(), Physical::DOUBLE).with_repetition(Repetition::REQUIRED).build()
        };
        let fields = names.iter().map(|name| column(name).map(Arc::new)).collect::<Result<_, _>>().map_err(failed)?;
        let schema = Type::group_type_builder(layout.name).with_fields(fields).build().map_err(failed)?;
        // Noise does not repeat: a dictionary would only cost time. Nor is it looked for by its value, as times are.
        let time = names.first().map_or("", S::as_ref);
        let properties = WriterProperties::builder()
            .set_dictionary_enabled(false)
            .set_compression(layout.compression)
            .set_statistics_enabled(EnabledStatistics::None)
            .set_column_statistics_enabled(time.into(), EnabledStatistics::Chunk)
            .build();
        let file = SerializedFileWriter::new(output, Arc::new(schema), Arc::new(properties)).map_err(failed)?;
        Ok(Self { file, columns: names.iter().map(|_| Column::default()).collect() })
    }

    /// Adds rows, given as columns of equal length.
    pub fn write<C: AsRef<[f64]>>(&mut self, columns: &[C]) -> io::Result<()> {
        for (column, piece) in self.columns.iter_mut().zip(columns) {
            column.values.extend_from_slice(piece.as_ref());
        }
        if self.columns[0].values.len() >= GROUP { self.flush().map_err(failed) } else { Ok(()) }
    }

    /// Ends the table and gives its output back.
    pub fn finish(mut self) -> io::Result<W> {
        self.flush().map_err(failed)?;
        self.file.into_inner().map_err(failed)
    }

    /// Ends the row group. Columns are encoded side by side.
    fn flush(&mut self) -> Result<(), ParquetError> {
        let descriptions = self.file.schema_descr().columns();
        let properties = self.file.properties();
        let encode = |(column, description): (&mut Column, _)| column.encode(description, properties);
        let encoded: Vec<_> = self.columns.par_iter_mut().zip(descriptions).map(encode).collect();
        let mut group = self.file.next_row_group()?;
        for (column, encoded) in self.columns.iter_mut().zip(encoded) {
            let (pages, closed) = encoded?;
            group.append_column(&pages, closed)?;
            column.room = pages.try_into_mut().map_or_else(|_| Vec::new(), Vec::from);
        }
        group.close().map(|_| ())
    }
}

impl Column {
    /// Its pages, and what the footer says of them. The values are taken.
    fn encode(
        &mut self,
        description: &ColumnDescPtr,
        properties: &WriterPropertiesPtr,
    ) -> Result<(Bytes, ColumnCloseResult), ParquetError> {
        let mut room = mem::take(&mut self.room);
        room.clear();
        let mut pages = TrackedWrite::new(room);
        let page_writer = Box::new(SerializedPageWriter::new(&mut pages));
        let (description, properties) = (Arc::clone(description), Arc::clone(properties));
        let mut writer = ColumnWriterImpl::<DoubleType>::new(description, properties, page_writer);
        writer.write_batch(&self.values, None, None)?;
        self.values.clear();
        let closed = writer.close()?;
        Ok((pages.into_inner()?.into(), closed))
    }
}

/// The library's complaint as one of writing.
fn failed(error: ParquetError) -> io::Error {
    match error {
        ParquetError::External(source) => io::Error::other(source),
        other => io::Error::other(other.to_string()),
    }
}
