//! Tables of numbers as Parquet.

use std::io::{self, Write};
use std::sync::Arc;

use parquet::basic::{Compression, Repetition, Type as Physical};
use parquet::data_type::DoubleType;
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

/// Rows in a row group: 4 MB of four columns.
const GROUP: usize = 1 << 17;

/// A table that is written row group by row group.
pub(crate) struct ParquetTable<'a> {
    file: SerializedFileWriter<&'a mut (dyn Write + Send)>,
    columns: Vec<Vec<f64>>,
}

impl<'a> ParquetTable<'a> {
    /// Begins the table: required doubles under `names`.
    pub fn new(output: &'a mut (dyn Write + Send), names: &[String]) -> io::Result<Self> {
        let column = |name: &String| {
            Type::primitive_type_builder(name, Physical::DOUBLE).with_repetition(Repetition::REQUIRED).build()
        };
        let fields = names.iter().map(|name| column(name).map(Arc::new)).collect::<Result<_, _>>().map_err(failed)?;
        let schema = Type::group_type_builder("schema").with_fields(fields).build().map_err(failed)?;
        // Noise does not repeat: a dictionary would only cost time.
        let properties =
            WriterProperties::builder().set_dictionary_enabled(false).set_compression(Compression::SNAPPY).build();
        let file = SerializedFileWriter::new(output, Arc::new(schema), Arc::new(properties)).map_err(failed)?;
        Ok(Self { file, columns: vec![Vec::with_capacity(GROUP); names.len()] })
    }

    /// Adds rows, given as columns of equal length.
    pub fn write(&mut self, columns: &[Vec<f64>]) -> io::Result<()> {
        for (whole, piece) in self.columns.iter_mut().zip(columns) {
            whole.extend_from_slice(piece);
        }
        if self.columns[0].len() >= GROUP { self.flush().map_err(failed) } else { Ok(()) }
    }

    /// Ends the table.
    pub fn finish(mut self) -> io::Result<()> {
        self.flush().map_err(failed)?;
        self.file.close().map(|_| ()).map_err(failed)
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
