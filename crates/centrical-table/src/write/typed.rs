//! Tables with columns of several kinds as Parquet: a flat column is optional, a list is required with optional elements.

use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use parquet::basic::{Compression, Encoding, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::{ParquetError, Result as ParquetResult};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{ColumnPath, Type};

use super::file::Beside;
use crate::binary::{CHECKSUMS, Cell, Checksums, Kind, TypedColumn};
use crate::error::Error;

/// Writes a table of several kinds of columns beside the file, and renames at the end: whoever looks sees the whole table or none. It is
/// on the disk then.
pub struct TypedWriter {
    file: PathBuf,
    beside: Beside,
    columns: Vec<TypedColumn>,
    checksums: Checksums,
    table: SerializedFileWriter<BufWriter<File>>,
}

/// The levels and values of one column of a row group, as Parquet takes them.
struct Levels<T> {
    definition: Vec<i16>,
    repetition: Vec<i16>,
    values: Vec<T>,
}

impl TypedWriter {
    /// Begins a table under a name of its schema, with texts that its footer keeps.
    ///
    /// # Errors
    /// [`Error::Io`] if the folder does not take the file.
    pub fn create(file: &Path, columns: &[TypedColumn], notes: &[(&str, &str)]) -> Result<Self, Error> {
        let failed = |error| Error::writing(file, error);
        let (beside, output) = Beside::create(file).map_err(failed)?;
        let table =
            begin(BufWriter::new(output), columns, notes).map_err(|error| failed(super::parquet::failed(error)))?;
        let checksums = Checksums::of_names(columns.iter().map(|column| column.name));
        Ok(Self { file: file.to_owned(), beside, columns: columns.to_vec(), checksums, table })
    }

    /// Adds a row group: rows of one cell a column. A cell of another kind than its column is nothing, or an empty list.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be written.
    pub fn write_group(&mut self, rows: &[Vec<Cell>]) -> Result<(), Error> {
        let (columns, checksums) = (&self.columns, &mut self.checksums);
        let mut write = || {
            let mut group = self.table.next_row_group()?;
            for (n, column) in columns.iter().enumerate() {
                let cells = || rows.iter().filter_map(|row| row.get(n));
                write_column(&mut group, column.kind, cells())?;
                checksums.push(column.kind, cells());
            }
            group.close().map(|_| ())
        };
        if rows.is_empty() {
            return Ok(());
        }
        write().map_err(|error| Error::writing(&self.file, super::parquet::failed(error)))
    }

    /// Ends the table; only now the file is there.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be written.
    pub fn finish(mut self) -> Result<(), Error> {
        self.table.append_key_value_metadata(KeyValue::new(CHECKSUMS.to_owned(), self.checksums.text()));
        let output = self.table.into_inner().map_err(super::parquet::failed);
        let synced =
            output.and_then(|output| output.into_inner().map_err(std::io::IntoInnerError::into_error)?.sync_all());
        synced.and_then(|()| self.beside.take_place()).map_err(|error| Error::writing(&self.file, error))
    }
}

fn begin(
    output: BufWriter<File>,
    columns: &[TypedColumn],
    notes: &[(&str, &str)],
) -> ParquetResult<SerializedFileWriter<BufWriter<File>>> {
    let fields = columns.iter().map(|column| field(*column).map(Arc::new)).collect::<ParquetResult<_>>()?;
    let schema = Type::group_type_builder("rows").with_fields(fields).build()?;
    let notes = notes.iter().map(|(key, value)| KeyValue::new((*key).to_owned(), (*value).to_owned()));
    let mut properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::try_new(3)?))
        .set_statistics_enabled(EnabledStatistics::Chunk)
        .set_key_value_metadata(Some(notes.collect()));
    for column in columns.iter().filter(|column| column.kind == Kind::Numbers) {
        // Numbers of full length do not repeat, but their exponents do.
        let path = path(*column);
        properties = properties
            .set_column_dictionary_enabled(path.clone(), false)
            .set_column_encoding(path.clone(), Encoding::BYTE_STREAM_SPLIT)
            .set_column_statistics_enabled(path, EnabledStatistics::None);
    }
    SerializedFileWriter::new(output, Arc::new(schema), Arc::new(properties.build()))
}

fn path(column: TypedColumn) -> ColumnPath {
    ColumnPath::new(vec![column.name.to_owned(), "list".to_owned(), "element".to_owned()])
}

/// `optional T name`, or `required group name (LIST) { repeated group list { optional T element } }`.
fn field(column: TypedColumn) -> ParquetResult<Type> {
    let (physical, logical) = match column.kind {
        Kind::Text | Kind::Texts => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        Kind::Number | Kind::Numbers => (Physical::DOUBLE, None),
        Kind::Integer | Kind::Integers => (Physical::INT64, None),
        Kind::Truth => (Physical::BOOLEAN, None),
    };
    let leaf = |name| {
        let leaf = Type::primitive_type_builder(name, physical).with_repetition(Repetition::OPTIONAL);
        leaf.with_logical_type(logical.clone()).build()
    };
    if !column.kind.is_list() {
        return leaf(column.name);
    }
    let list = Type::group_type_builder("list").with_repetition(Repetition::REPEATED);
    let list = list.with_fields(vec![Arc::new(leaf("element")?)]).build()?;
    let whole = Type::group_type_builder(column.name).with_repetition(Repetition::REQUIRED);
    whole.with_logical_type(Some(LogicalType::List)).with_fields(vec![Arc::new(list)]).build()
}

fn write_column<'a>(
    group: &mut SerializedRowGroupWriter<BufWriter<File>>,
    kind: Kind,
    cells: impl Iterator<Item = &'a Cell>,
) -> ParquetResult<()> {
    let bytes = |text: &String| ByteArray::from(text.as_str());
    match kind {
        Kind::Text => write::<ByteArrayType>(
            group,
            &flat(cells, |cell| match cell {
                Cell::Text(text) => Some(bytes(text)),
                _ => None,
            }),
        ),
        Kind::Number => write::<DoubleType>(
            group,
            &flat(cells, |cell| match cell {
                Cell::Number(value) if !value.is_nan() => Some(*value),
                _ => None,
            }),
        ),
        Kind::Integer => write::<Int64Type>(
            group,
            &flat(cells, |cell| match cell {
                Cell::Integer(value) => Some(*value),
                _ => None,
            }),
        ),
        Kind::Truth => write::<BoolType>(
            group,
            &flat(cells, |cell| match cell {
                Cell::Truth(value) => Some(*value),
                _ => None,
            }),
        ),
        Kind::Texts => write::<ByteArrayType>(
            group,
            &lists(cells, |cell| match cell {
                Cell::Texts(list) => list.iter().map(|text| Some(bytes(text))).collect(),
                _ => Vec::new(),
            }),
        ),
        Kind::Numbers => write::<DoubleType>(
            group,
            &lists(cells, |cell| match cell {
                Cell::Numbers(list) => list.iter().map(|value| Some(*value).filter(|value| !value.is_nan())).collect(),
                _ => Vec::new(),
            }),
        ),
        Kind::Integers => write::<Int64Type>(
            group,
            &lists(cells, |cell| match cell {
                Cell::Integers(list) => list.iter().map(|value| Some(*value)).collect(),
                _ => Vec::new(),
            }),
        ),
    }
}

fn flat<'a, T>(cells: impl Iterator<Item = &'a Cell>, value: impl Fn(&Cell) -> Option<T>) -> Levels<T> {
    let mut levels = Levels { definition: Vec::new(), repetition: Vec::new(), values: Vec::new() };
    for cell in cells {
        let value = value(cell);
        levels.definition.push(i16::from(value.is_some()));
        levels.values.extend(value);
    }
    levels
}

/// Definition 0 is an empty list, 1 an element that is nothing, 2 one that is there; repetition 1 goes on with a list.
fn lists<'a, T>(cells: impl Iterator<Item = &'a Cell>, list: impl Fn(&Cell) -> Vec<Option<T>>) -> Levels<T> {
    let mut levels = Levels { definition: Vec::new(), repetition: Vec::new(), values: Vec::new() };
    for cell in cells {
        let list = list(cell);
        if list.is_empty() {
            levels.definition.push(0);
            levels.repetition.push(0);
        }
        for (n, value) in list.into_iter().enumerate() {
            levels.definition.push(if value.is_some() { 2 } else { 1 });
            levels.repetition.push(i16::from(n > 0));
            levels.values.extend(value);
        }
    }
    levels
}

fn write<D: DataType>(
    group: &mut SerializedRowGroupWriter<BufWriter<File>>,
    levels: &Levels<D::T>,
) -> ParquetResult<()> {
    let next = group.next_column()?;
    let mut column = next.ok_or_else(|| ParquetError::General("one column more".to_owned()))?;
    let repetition = Some(levels.repetition.as_slice()).filter(|levels| !levels.is_empty());
    column.typed::<D>().write_batch(&levels.values, Some(&levels.definition), repetition)?;
    column.close()
}
