//! Tables of numbers as Parquet.

use std::io::{self, Write};
use std::sync::Arc;

use parquet::basic::{Compression, Repetition, Type as Physical};
use parquet::data_type::DoubleType;
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

/// How a table is laid out in its file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Layout {
    name: &'static str,
    /// Rows in a row group.
    group: usize,
    compression: Compression,
}

impl Layout {
    /// Readings with all their digits, which do not compress; groups of 32 MB, so that readers have pieces to share and
    /// the footer stays short.
    pub const PLAIN: Self = Self { name: "record", group: 1 << 20, compression: Compression::UNCOMPRESSED };
    /// Numbers of few digits; groups of 4 MB.
    pub const PACKED: Self = Self { name: "schema", group: 1 << 17, compression: Compression::SNAPPY };
}

/// A table that is written row group by row group.
pub(crate) struct ParquetTable<W: Write + Send> {
    file: SerializedFileWriter<W>,
    group: usize,
    /// Rows of the next group, by columns.
    columns: Vec<Vec<f64>>,
}

impl<W: Write + Send> ParquetTable<W> {
    /// Begins the table: required doubles under `names`.
    pub fn new<S: AsRef<str>>(output: W, layout: Layout, names: &[S]) -> io::Result<Self> {
        let column = |name: &S| {
            Type::primitive_type_builder(name.as_ref(), Physical::DOUBLE).with_repetition(Repetition::REQUIRED).build()
        };
        let fields = names.iter().map(|name| column(name).map(Arc::new)).collect::<Result<_, _>>().map_err(failed)?;
        let schema = Type::group_type_builder(layout.name).with_fields(fields).build().map_err(failed)?;
        // Noise does not repeat: a dictionary would only cost time.
        let properties =
            WriterProperties::builder().set_dictionary_enabled(false).set_compression(layout.compression).build();
        let file = SerializedFileWriter::new(output, Arc::new(schema), Arc::new(properties)).map_err(failed)?;
        Ok(Self { file, group: layout.group, columns: vec![Vec::new(); names.len()] })
    }

    /// Adds rows, given as columns of equal length.
    pub fn write<C: AsRef<[f64]>>(&mut self, columns: &[C]) -> io::Result<()> {
        for (whole, piece) in self.columns.iter_mut().zip(columns) {
            whole.extend_from_slice(piece.as_ref());
        }
        if self.columns[0].len() >= self.group { self.flush().map_err(failed) } else { Ok(()) }
    }

    /// Ends the table and gives its output back.
    pub fn finish(mut self) -> io::Result<W> {
        self.flush().map_err(failed)?;
        self.file.into_inner().map_err(failed)
    }

    fn flush(&mut self) -> Result<(), ParquetError> {
        let mut group = self.file.next_row_group()?;
        for column in &mut self.columns {
            let Some(mut writer) = group.next_column()? else { break };
            writer.typed::<DoubleType>().write_batch(column, None, None)?;
            writer.close()?;
            column.clear();
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
