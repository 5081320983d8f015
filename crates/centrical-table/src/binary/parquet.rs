//! Tables in Parquet files, some rows at a time.

use std::path::Path;
use std::sync::Arc;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use parquet::basic::{Compression, ConvertedType, LogicalType, TimeUnit, Type};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl, get_column_reader};
use parquet::data_type::DataType;
use parquet::errors::{ParquetError, Result as ParquetResult};
use parquet::file::metadata::{ParquetMetaData, ParquetMetaDataReader};
use parquet::schema::types::ColumnDescPtr;

use super::arrow;
use super::catch_panic::catch_panic;
use super::columnar::{Column, MISSING, Parts, place_of};
use super::dates::SECONDS_OF_DAY;
use super::parquet_pages::{Checked, Pages};
use crate::column::{Field, ROWS, Rule};
use crate::error::{Error, Place};
use crate::source::Source;
use crate::stamp::{TickForm, TickUnit};

/// The row groups of a file.
pub(super) fn parts(source: &Source, fields: &[Field]) -> Result<Parts, Error> {
    let file = source.name();
    let metadata = metadata(source)?;
    let durations = durations(&metadata);
    let found = fields.iter().map(|field| find(file, &metadata, &durations, field));
    let columns: Vec<usize> = found.collect::<Result<_, Error>>()?;
    for (field, column) in fields.iter().zip(&columns) {
        let mut packings = metadata.row_groups().iter().map(|group| group.column(*column).compression());
        if let Some(other) = packings.find_map(other_packing) {
            let place = Place::Column(field.name.to_string());
            return Err(Error::content(file, place, format!("{other} compression"), PACKINGS));
        }
    }
    let (file, pages) = (file.to_owned(), Arc::new(Pages(source.clone())));
    Ok(Box::new((0..metadata.num_row_groups()).map(move |group| {
        let open = |c: &usize| column(&file, &pages, &metadata, group, *c);
        let columns = columns.iter().map(open).collect::<ParquetResult<Vec<_>>>();
        columns.map_err(|e| damaged(&file, Some(&e)))
    })))
}

/// The names of the columns.
pub(super) fn names(source: &Source) -> Result<Vec<String>, Error> {
    Ok(column_names(&metadata(source)?))
}

fn column_names(metadata: &ParquetMetaData) -> Vec<String> {
    metadata.file_metadata().schema_descr().columns().iter().map(|column| column.path().string()).collect()
}

fn metadata(source: &Source) -> Result<ParquetMetaData, Error> {
    let metadata = catch_panic(|| ParquetMetaDataReader::new().parse_and_finish(source));
    metadata.map_err(|e| damaged(source.name(), e.as_ref()))
}

/// Compressions of pages that are read.
const PACKINGS: &str = "Snappy, gzip, LZ4, Zstandard or none";

/// The name of a compression that is not read.
fn other_packing(packing: Compression) -> Option<&'static str> {
    match packing {
        Compression::BROTLI(_) => Some("Brotli"),
        Compression::LZO => Some("LZO"),
        _ => None,
    }
}

/// What the parquet library complains of.
fn damaged(file: &Path, error: Option<&ParquetError>) -> Error {
    let why = error.map_or_else(|| "a page that contradicts itself".to_owned(), ToString::to_string);
    Error::content(file, Place::Whole, format!("damaged Parquet ({why})"), "a whole Parquet file")
}

/// The column that a field asks for: numbers, one a row.
fn find(file: &Path, metadata: &ParquetMetaData, durations: &[String], field: &Field) -> Result<usize, Error> {
    let wrong = |found: String, expected: &str| {
        Err(Error::content(file, Place::Column(field.name.to_string()), found, expected))
    };
    let columns = metadata.file_metadata().schema_descr().columns();
    let place = place_of(file, &column_names(metadata), field)?;
    match describe(&columns[place], durations, field.rule) {
        None => Ok(place),
        Some(other) => wrong(other, &field.expected),
    }
}

/// What a column is if it is not numbers, one a row, or stamps where these are allowed.
fn describe(column: &ColumnDescPtr, durations: &[String], rule: Rule) -> Option<String> {
    let numbers = matches!(column.physical_type(), Type::DOUBLE | Type::FLOAT | Type::INT32 | Type::INT64);
    match column.logical_type_ref() {
        _ if column.max_rep_level() > 0 => Some("lists".to_owned()),
        // To Parquet it is a number; its unit stands in the schema of Arrow alone.
        _ if durations.contains(&column.path().string()) => Some("a duration".to_owned()),
        _ if counted(column).is_some_and(|counted| counted.rule == rule) => None,
        None if !is_plain_of_old(column) => Some(format!("{:?}", column.converted_type())),
        None | Some(LogicalType::Integer(_)) if numbers && rule.takes_numbers() => None,
        Some(LogicalType::Float16) => Some("numbers of 16 bits (float16)".to_owned()),
        Some(logical) => Some(type_name(logical)),
        None => Some(format!("{:?}", column.physical_type())),
    }
}

/// The name of a type without its details: `Decimal`, `Time`, `String`.
fn type_name(logical: &LogicalType) -> String {
    format!("{logical:?}").chars().take_while(|c| c.is_alphanumeric()).collect()
}

/// Whether a column without a logical type is of numbers also as older writers state types.
fn is_plain_of_old(column: &ColumnDescPtr) -> bool {
    use ConvertedType as Old;
    let signed = matches!(column.converted_type(), Old::NONE | Old::INT_8 | Old::INT_16 | Old::INT_32 | Old::INT_64);
    signed || is_unsigned(column)
}

/// How a column counts stamps, dates or times of the day.
struct Counted {
    /// By which of them it can be asked for.
    rule: Rule,
    form: TickForm,
    /// Ticks of the form that one of the column stands for.
    ticks: i64,
}

/// How a column counts time; nothing of numbers. Without a logical type stamps are always in UTC.
fn counted(column: &ColumnDescPtr) -> Option<Counted> {
    const STAMPS: Rule = Rule::Ascending { stamps: true };
    let unit_of = |unit: &TimeUnit| match unit {
        TimeUnit::MILLIS => TickUnit::Millisecond,
        TimeUnit::MICROS => TickUnit::Microsecond,
        TimeUnit::NANOS => TickUnit::Nanosecond,
    };
    let (rule, unit, is_utc) = match (column.logical_type_ref(), column.converted_type()) {
        (Some(LogicalType::Timestamp(stamp)), _) => (STAMPS, unit_of(&stamp.unit), stamp.is_adjusted_to_u_t_c),
        (Some(LogicalType::Time(time)), _) => (Rule::TimeOfDay, unit_of(&time.unit), time.is_adjusted_to_u_t_c),
        (Some(LogicalType::Date), _) | (None, ConvertedType::DATE) => (Rule::Date, TickUnit::Second, false),
        (None, ConvertedType::TIMESTAMP_MILLIS) => (STAMPS, TickUnit::Millisecond, true),
        (None, ConvertedType::TIMESTAMP_MICROS) => (STAMPS, TickUnit::Microsecond, true),
        (None, ConvertedType::TIME_MILLIS) => (Rule::TimeOfDay, TickUnit::Millisecond, true),
        (None, ConvertedType::TIME_MICROS) => (Rule::TimeOfDay, TickUnit::Microsecond, true),
        _ => return None,
    };
    let ticks = if rule == Rule::Date { SECONDS_OF_DAY } else { 1 };
    Some(Counted { rule, form: TickForm { unit, is_utc }, ticks })
}

/// Whether the integers of a column have no sign.
fn is_unsigned(column: &ColumnDescPtr) -> bool {
    use ConvertedType as Old;
    match column.logical_type_ref() {
        Some(LogicalType::Integer(integer)) => !integer.is_signed,
        _ => matches!(column.converted_type(), Old::UINT_8 | Old::UINT_16 | Old::UINT_32 | Old::UINT_64),
    }
}

/// Names of the columns that are durations, from the schema of Arrow that its writers put into a file.
fn durations(metadata: &ParquetMetaData) -> Vec<String> {
    let pairs = metadata.file_metadata().key_value_metadata();
    let schema = pairs.into_iter().flatten().find(|pair| pair.key == "ARROW:schema");
    let bytes = schema.and_then(|pair| STANDARD.decode(pair.value.as_deref()?).ok()).unwrap_or_default();
    // One that contradicts itself says nothing.
    catch_panic(|| Ok::<_, ParquetError>(arrow::durations(&bytes))).unwrap_or_default()
}

/// One column of one row group.
fn column(
    file: &Path,
    pages: &Arc<Pages>,
    metadata: &ParquetMetaData,
    group: usize,
    column: usize,
) -> ParquetResult<Column> {
    let pages = Checked::new(pages, metadata.row_group(group), column)?;
    let description = metadata.file_metadata().schema_descr().column(column);
    let (counted, is_unsigned) = (counted(&description), is_unsigned(&description));
    let whole = description.max_def_level();
    let mut reader = get_column_reader(description, Box::new(pages));
    let file = file.to_owned();
    if let Some(Counted { form, ticks: each, .. }) = counted {
        let unit = form.unit.seconds();
        return Ok(Column::Stamps(
            form,
            Box::new(move |values, ticks| {
                let mut count = |v: i64| {
                    ticks.push(v.saturating_mul(each));
                    ticks.last().map_or(0.0, |ticks| *ticks as f64 * unit)
                };
                let read = catch_panic(|| match &mut reader {
                    ColumnReader::Int64ColumnReader(reader) => numbers(reader, values, count),
                    ColumnReader::Int32ColumnReader(reader) => numbers(reader, values, |v| count(v.into())),
                    _ => Err(ParquetError::General("a count of time that is no integer".to_owned())),
                });
                read.map_err(|e| damaged(&file, e.as_ref()))
            }),
        ));
    }
    Ok(Column::Numbers(Box::new(move |values| {
        let read = catch_panic(|| match &mut reader {
            // As they are, if every row has one.
            ColumnReader::DoubleColumnReader(reader) if whole == 0 => {
                reader.read_records(ROWS, None, None, values).map(|_| ())
            }
            ColumnReader::DoubleColumnReader(reader) => numbers(reader, values, |v| v),
            ColumnReader::FloatColumnReader(reader) => numbers(reader, values, f64::from),
            ColumnReader::Int32ColumnReader(reader) if is_unsigned => {
                numbers(reader, values, |v| f64::from(v.cast_unsigned()))
            }
            ColumnReader::Int32ColumnReader(reader) => numbers(reader, values, f64::from),
            ColumnReader::Int64ColumnReader(reader) if is_unsigned => {
                numbers(reader, values, |v| v.cast_unsigned() as f64)
            }
            ColumnReader::Int64ColumnReader(reader) => numbers(reader, values, |v| v as f64),
            _ => Err(ParquetError::General("a column without numbers".to_owned())),
        });
        read.map_err(|e| damaged(&file, e.as_ref()))
    })))
}

/// Reads the next values of one column.
fn numbers<T: DataType>(
    reader: &mut ColumnReaderImpl<T>,
    values: &mut Vec<f64>,
    convert: impl FnMut(T::T) -> f64,
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
