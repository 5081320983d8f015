//! Tables of numbers as Parquet.

use std::io::{self, Write};
use std::mem;
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, TimeUnit, Type as Physical};
use parquet::data_type::{DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use crate::stamp::{TickForm, TickUnit};

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
    has_stamps: bool,
    /// The next one.
    next: RowGroup,
}

/// Columns of a row group in the making.
#[derive(Debug, Default)]
pub(super) struct RowGroup {
    /// Stamps of the rows, if the first column is of them.
    ticks: Vec<i64>,
    /// The columns of numbers.
    numbers: Vec<Vec<f64>>,
}

impl RowGroup {
    /// Adds rows, given as columns of equal length: whether there are enough.
    pub fn add<C: AsRef<[f64]>>(&mut self, columns: &[C]) -> bool {
        self.numbers.resize_with(columns.len(), Vec::new);
        for (column, piece) in self.numbers.iter_mut().zip(columns) {
            column.extend_from_slice(piece.as_ref());
        }
        self.rows() >= GROUP
    }

    /// The same of rows that begin with stamps.
    pub fn add_stamped(&mut self, ticks: &[i64], columns: &[&[f64]]) -> bool {
        self.ticks.extend_from_slice(ticks);
        self.add(columns)
    }

    fn rows(&self) -> usize {
        self.numbers.first().map_or(self.ticks.len(), Vec::len)
    }

    /// Takes the rows out.
    pub fn clear(&mut self) {
        self.ticks.clear();
        self.numbers.iter_mut().for_each(Vec::clear);
    }
}

impl<W: Write + Send> ParquetTable<W> {
    /// Begins the table: required doubles under `names`, the first column as timestamps if `stamps` says how they are counted.
    pub fn new<S: AsRef<str>>(output: W, layout: Layout, names: &[S], stamps: Option<TickForm>) -> io::Result<Self> {
        let column = |(place, name): (usize, &S)| {
            let logical = stamps.filter(|_| place == 0).map(timestamp);
            let physical = if logical.is_some() { Physical::INT64 } else { Physical::DOUBLE };
            let column = Type::primitive_type_builder(name.as_ref(), physical).with_repetition(Repetition::REQUIRED);
            column.with_logical_type(logical).build()
        };
        let fields = names.iter().enumerate().map(|named| column(named).map(Arc::new));
        let fields = fields.collect::<Result<_, _>>().map_err(failed)?;
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
        Ok(Self { file, has_stamps: stamps.is_some(), next: RowGroup::default() })
    }

    /// Adds rows, given as columns of equal length.
    pub fn write<C: AsRef<[f64]>>(&mut self, columns: &[C]) -> io::Result<()> {
        if self.next.add(columns) { self.flush() } else { Ok(()) }
    }

    /// Writes a row group, unless it has no rows.
    pub fn write_group(&mut self, group: &RowGroup) -> io::Result<()> {
        if group.rows() > 0 { self.try_group(group).map_err(failed) } else { Ok(()) }
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

    fn try_group(&mut self, rows: &RowGroup) -> Result<(), ParquetError> {
        let mut group = self.file.next_row_group()?;
        let one_more = || ParquetError::General("one column more".to_owned());
        if self.has_stamps {
            let mut column = group.next_column()?.ok_or_else(one_more)?;
            column.typed::<Int64Type>().write_batch(&rows.ticks, None, None)?;
            column.close()?;
        }
        for values in &rows.numbers {
            let mut column = group.next_column()?.ok_or_else(one_more)?;
            column.typed::<DoubleType>().write_batch(values, None, None)?;
            column.close()?;
        }
        group.close().map(|_| ())
    }
}

/// The type of a column of stamps. Parquet counts no seconds: they are to be written as milliseconds.
fn timestamp(form: TickForm) -> LogicalType {
    let unit = match form.unit {
        TickUnit::Second | TickUnit::Millisecond => TimeUnit::MILLIS,
        TickUnit::Microsecond => TimeUnit::MICROS,
        TickUnit::Nanosecond => TimeUnit::NANOS,
    };
    LogicalType::timestamp(form.is_utc, unit)
}

/// The library's complaint as one of writing.
pub(super) fn failed(error: ParquetError) -> io::Error {
    match error {
        ParquetError::External(source) => io::Error::other(source),
        other => io::Error::other(other.to_string()),
    }
}
