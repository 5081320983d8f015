//! Tables in Parquet files, some rows at a time.

mod pages;

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{LogicalType, TimeUnit, Type};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl, get_column_reader};
use parquet::data_type::DataType;
use parquet::errors::{ParquetError, Result as ParquetResult};
use parquet::file::metadata::{ParquetMetaData, ParquetMetaDataReader};
use parquet::schema::types::ColumnDescPtr;

use self::pages::{Checked, Source};
use super::columnar::{Column, MISSING, Parts};
use super::panics::caught;
use crate::column::{ColumnName, Field, Rule};
use crate::error::{Error, Place, quoted};
use crate::rows::ROWS;

/// The row groups of `file`.
pub(super) fn parts(file: &Path, input: &File, fields: &[Field]) -> Result<Parts, Error> {
    let metadata = caught(|| ParquetMetaDataReader::new().parse_and_finish(input));
    let metadata = metadata.map_err(|e| damaged(file, e.as_ref()))?;
    let columns: Vec<usize> = fields.iter().map(|field| find(file, &metadata, field)).collect::<Result<_, Error>>()?;
    // Columns are read at the same time, and a file has one place that is read next: each column opens it for itself.
    let open = |_: &usize| File::open(file).map(|input| Arc::new(Source(input)));
    let sources: Vec<Arc<Source>> =
        columns.iter().map(open).collect::<std::io::Result<_>>().map_err(|e| Error::reading(file, e, "Parquet"))?;
    let file = file.to_owned();
    Ok(Box::new((0..metadata.num_row_groups()).map(move |group| {
        let open = |(c, source): (&usize, &Arc<Source>)| column(&file, source, &metadata, group, *c);
        let columns = columns.iter().zip(&sources).map(open).collect::<ParquetResult<Vec<_>>>();
        columns.map_err(|e| damaged(&file, Some(&e)))
    })))
}

/// What the parquet library complains of.
fn damaged(file: &Path, error: Option<&ParquetError>) -> Error {
    let why = error.map_or_else(|| "a page that contradicts itself".to_owned(), ToString::to_string);
    Error::content(file, Place::Whole, format!("damaged Parquet ({why})"), "a whole Parquet file")
}

/// The column that a field asks for: numbers, one a row.
fn find(file: &Path, metadata: &ParquetMetaData, field: &Field) -> Result<usize, Error> {
    let wrong = |found: String, expected: &str| {
        Err(Error::content(file, Place::Column(field.name.to_string()), found, expected))
    };
    let columns = metadata.file_metadata().schema_descr().columns();
    let names: Vec<String> = columns.iter().map(|column| column.path().string()).collect();
    let mut places = match &field.name {
        ColumnName::Name(name) => (0..columns.len()).filter(|i| names[*i] == *name).collect(),
        ColumnName::Number(number) => vec![number.wrapping_sub(1)],
        ColumnName::Row => Vec::new(),
    };
    let list = || quoted(names.join(", ").as_bytes());
    let (Some(place), None) = (places.pop().filter(|i| *i < columns.len()), places.pop()) else {
        return wrong(format!("columns {}", list()), "one column of this name");
    };
    match describe(&columns[place], field.rule) {
        None => Ok(place),
        Some(other) => wrong(other, &field.expected),
    }
}

/// What a column is if it is not numbers, one a row, or stamps where these are allowed.
fn describe(column: &ColumnDescPtr, rule: Rule) -> Option<String> {
    let numbers = matches!(column.physical_type(), Type::DOUBLE | Type::FLOAT | Type::INT32 | Type::INT64);
    match column.logical_type_ref() {
        _ if column.max_rep_level() > 0 => Some("lists".to_owned()),
        Some(LogicalType::Timestamp(_)) if rule == (Rule::Ascending { stamps: true }) => None,
        None | Some(LogicalType::Integer(_)) if numbers => None,
        Some(logical) => Some(format!("{logical:?}")),
        None => Some(format!("{:?}", column.physical_type())),
    }
}

/// Seconds per unit of a column of stamps, 1 for numbers.
fn stamp_unit(column: &ColumnDescPtr) -> f64 {
    match column.logical_type_ref() {
        Some(LogicalType::Timestamp(stamp)) => match stamp.unit {
            TimeUnit::MILLIS => 1e-3,
            TimeUnit::MICROS => 1e-6,
            TimeUnit::NANOS => 1e-9,
        },
        _ => 1.0,
    }
}

/// One column of one row group.
fn column(
    file: &Path,
    source: &Arc<Source>,
    metadata: &ParquetMetaData,
    group: usize,
    column: usize,
) -> ParquetResult<Column> {
    let pages = Checked::new(source, metadata.row_group(group), column)?;
    let description = metadata.file_metadata().schema_descr().column(column);
    let unit = stamp_unit(&description);
    let whole = description.max_def_level();
    let mut reader = get_column_reader(description, Box::new(pages));
    let file = file.to_owned();
    Ok(Box::new(move |values| {
        let read = caught(|| match &mut reader {
            // As they are, if there is one in every row.
            ColumnReader::DoubleColumnReader(reader) if whole == 0 => {
                reader.read_records(ROWS, None, None, values).map(|_| ())
            }
            ColumnReader::DoubleColumnReader(reader) => numbers(reader, values, |v| v),
            ColumnReader::FloatColumnReader(reader) => numbers(reader, values, f64::from),
            ColumnReader::Int32ColumnReader(reader) => numbers(reader, values, f64::from),
            ColumnReader::Int64ColumnReader(reader) => numbers(reader, values, |v| v as f64 * unit),
            _ => Err(ParquetError::General("a column without numbers".to_owned())),
        });
        read.map_err(|e| damaged(&file, e.as_ref()))
    }))
}

/// Reads the next values of one column.
fn numbers<T: DataType>(
    reader: &mut ColumnReaderImpl<T>,
    values: &mut Vec<f64>,
    convert: impl Fn(T::T) -> f64,
) -> ParquetResult<()> {
    let (mut levels, mut raw) = (Vec::new(), Vec::with_capacity(ROWS));
    let (rows, present, _) = reader.read_records(ROWS, Some(&mut levels), None, &mut raw)?;
    let mut raw = raw.into_iter().map(convert);
    if present == rows {
        values.extend(raw);
    } else {
        let whole = levels.iter().copied().max().unwrap_or(0);
        values.extend(levels.iter().map(|level| if *level == whole { raw.next() } else { None }.unwrap_or(MISSING)));
    }
    Ok(())
}
