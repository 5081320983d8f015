//! Tables of numbers as Parquet.

use std::io::{self, Write};
use std::mem;
use std::sync::Arc;

use parquet::basic::{Compression, Repetition, Type as Physical};
use parquet::data_type::DoubleType;
use parquet::errors::ParquetError;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

/// How a table is laid out in its file.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
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
pub(super) struct ParquetTable<W: Write + Send> {
    file: SerializedFileWriter<W>,
    /// The next one.
    next: RowGroup,
}

/// Columns of a row group in the making.
#[derive(Debug, Default)]
pub(super) struct RowGroup(Vec<Vec<f64>>);

impl RowGroup {
    /// Adds rows, given as columns of equal length: whether there are enough.
    pub fn add<C: AsRef<[f64]>>(&mut self, columns: &[C]) -> bool {
        self.0.resize_with(columns.len(), Vec::new);
        for (column, piece) in self.0.iter_mut().zip(columns) {
            column.extend_from_slice(piece.as_ref());
        }
        self.0.first().is_some_and(|column| column.len() >= GROUP)
    }

    /// Takes the rows out.
    pub fn clear(&mut self) {
        self.0.iter_mut().for_each(Vec::clear);
    }
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
        Ok(Self { file, next: RowGroup::default() })
    }

    /// Adds rows, given as columns of equal length.
    pub fn write<C: AsRef<[f64]>>(&mut self, columns: &[C]) -> io::Result<()> {
        if self.next.add(columns) { self.flush() } else { Ok(()) }
    }

    /// Writes a row group, unless it has no rows.
    pub fn write_group(&mut self, group: &RowGroup) -> io::Result<()> {
        let has_rows = group.0.first().is_some_and(|column| !column.is_empty());
        if has_rows { self.try_group(&group.0).map_err(failed) } else { Ok(()) }
    }

    /// Ends the table and gives its output back.
    pub fn finish(mut self) -> io::Result<W> {
        self.flush()?;
        self.file.into_inner().map_err(failed)
    }

    fn flush(&mut self) -> io::Result<()> {
        let mut group = mem::take(&mut self.next);
        self.write_group(&group)?;
        group.clear();
        self.next = group;
        Ok(())
    }

    fn try_group(&mut self, columns: &[Vec<f64>]) -> Result<(), ParquetError> {
        let mut group = self.file.next_row_group()?;
        for values in columns {
            let mut column = group.next_column()?.ok_or_else(|| ParquetError::General("one column more".to_owned()))?;
            column.typed::<DoubleType>().write_batch(values, None, None)?;
            column.close()?;
        }
        group.close().map(|_| ())
    }
}

/// The library's complaint as one of writing.
fn failed(error: ParquetError) -> io::Error {
    match error {
        ParquetError::External(source) => io::Error::other(source),
        other => io::Error::other(other.to_string()),
    }
}
