//! Parquet tables with columns of several kinds, a row group and a column at a time.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use parquet::column::reader::{ColumnReader, ColumnReaderImpl, get_column_reader};
use parquet::data_type::{ByteArray, DataType};
use parquet::errors::{ParquetError, Result as ParquetResult};
use parquet::file::metadata::{ParquetMetaData, ParquetMetaDataReader};

use super::catch_panic::catch_panic;
use super::cells::{Cell, Kind, TypedColumn};
use super::checksums::{CHECKSUMS, Checksums};
use super::parquet_pages::{Checked, Pages};
use crate::error::{Error, Place};
use crate::source::Source;

/// Values that a column of one row group may hold: above, a damaged file would fill the memory.
const MOST: i64 = 1 << 26;

/// A Parquet table with columns of several kinds, open.
pub struct TypedReader {
    file: PathBuf,
    pages: Arc<Pages>,
    metadata: ParquetMetaData,
    /// None of a table that another program wrote, or an older one.
    checksums: Option<Checksums>,
}

impl TypedReader {
    /// Opens a table, which should be what `expected` says.
    ///
    /// # Errors
    /// [`Error`] if it is not there, or is not a whole Parquet file.
    pub fn open(file: &Path, expected: &str) -> Result<Self, Error> {
        let source = Source::open(file, expected)?;
        let metadata = catch_panic(|| ParquetMetaDataReader::new().parse_and_finish(&source));
        let metadata = metadata.map_err(|error| damaged(file, Place::Whole, error.as_ref(), expected))?;
        let mut table = Self { file: file.to_owned(), pages: Arc::new(Pages(source)), metadata, checksums: None };
        // Another program that copies rows may copy the texts of the footer with them.
        let creator = table.metadata.file_metadata().created_by().unwrap_or_default();
        if let Some(text) = table.note(CHECKSUMS).filter(|_| creator.starts_with("parquet-rs")) {
            let kept = Checksums::kept(text, table.names(), table.groups() * table.names().count());
            let error = general("columns or row groups other than those that were written".to_owned());
            table.checksums = Some(kept.ok_or_else(|| damaged(file, Place::Whole, Some(&error), expected))?);
        }
        Ok(table)
    }

    /// The names of its columns.
    fn names(&self) -> impl Iterator<Item = &str> {
        let columns = self.metadata.file_metadata().schema_descr().columns();
        columns.iter().filter_map(|column| column.path().parts().first()).map(String::as_str)
    }

    /// The text that the footer keeps under a key.
    pub fn note(&self, key: &str) -> Option<&str> {
        let pairs = self.metadata.file_metadata().key_value_metadata();
        pairs.into_iter().flatten().find(|pair| pair.key == key)?.value.as_deref()
    }

    /// Number of row groups.
    pub fn groups(&self) -> usize {
        self.metadata.num_row_groups()
    }

    /// Number of rows.
    pub fn rows(&self) -> u64 {
        u64::try_from(self.metadata.file_metadata().num_rows()).unwrap_or(0)
    }

    /// Number of rows in the row groups before one.
    pub fn rows_before(&self, group: usize) -> u64 {
        self.metadata.row_groups().iter().take(group).map(|group| u64::try_from(group.num_rows()).unwrap_or(0)).sum()
    }

    /// Cells of a column in a row group, one a row; none if the table has no such column.
    ///
    /// # Errors
    /// [`Error`] naming the column if its pages are damaged or of another kind.
    pub fn read(&self, group: usize, column: TypedColumn) -> Result<Option<Vec<Cell>>, Error> {
        let Some(number) = self.names().position(|name| name == column.name) else { return Ok(None) };
        let read = catch_panic(|| self.checked(group, number, column.kind));
        let place = Place::Column(format!("{}, row group {}", column.name, group + 1));
        read.map(Some).map_err(|error| damaged(&self.file, place, error.as_ref(), "a whole part of a store"))
    }

    /// The cells as they were written.
    fn checked(&self, group: usize, number: usize, kind: Kind) -> ParquetResult<Vec<Cell>> {
        let cells = self.cells(group, number, kind)?;
        let chunk = group * self.names().count() + number;
        match &self.checksums {
            Some(checksums) if !checksums.hold(chunk, kind, cells.iter()) => {
                Err(general("its cells do not give the CRC-32 written with them".to_owned()))
            }
            _ => Ok(cells),
        }
    }

    fn cells(&self, group: usize, number: usize, kind: Kind) -> ParquetResult<Vec<Cell>> {
        let of_group = self.metadata.row_group(group);
        let (rows, values) = (of_group.num_rows(), of_group.column(number).num_values());
        if !(0..=MOST).contains(&rows) || !(0..=MOST).contains(&values) {
            return Err(general(format!("a row group that claims {rows} rows and {values} values")));
        }
        let description = self.metadata.file_metadata().schema_descr().column(number);
        let is_list = description.max_rep_level() > 0;
        if is_list != kind.is_list() || description.max_rep_level() > 1 {
            return Err(general("lists where single values are due, or the other way".to_owned()));
        }
        let pages = Box::new(Checked::new(&self.pages, of_group, number)?);
        let (rows, most) = (usize::try_from(rows).unwrap_or(0), description.max_def_level());
        let text = |bytes: ByteArray| String::from_utf8_lossy(bytes.data()).into_owned();
        match (get_column_reader(description, pages), kind) {
            (ColumnReader::ByteArrayColumnReader(r), Kind::Text) => flat(r, rows, most, |v| Cell::Text(text(v))),
            (ColumnReader::DoubleColumnReader(r), Kind::Number) => flat(r, rows, most, Cell::Number),
            (ColumnReader::Int64ColumnReader(r), Kind::Integer) => flat(r, rows, most, Cell::Integer),
            (ColumnReader::BoolColumnReader(r), Kind::Truth) => flat(r, rows, most, Cell::Truth),
            (ColumnReader::ByteArrayColumnReader(r), Kind::Texts) => {
                lists(r, rows, most, |v| v.map_or(String::new(), text), Cell::Texts)
            }
            (ColumnReader::DoubleColumnReader(r), Kind::Numbers) => {
                lists(r, rows, most, |v| v.unwrap_or(f64::NAN), Cell::Numbers)
            }
            (ColumnReader::Int64ColumnReader(r), Kind::Integers) => {
                lists(r, rows, most, |v| v.unwrap_or(0), Cell::Integers)
            }
            _ => Err(general("values of another type".to_owned())),
        }
    }
}

fn flat<D: DataType>(
    mut reader: ColumnReaderImpl<D>,
    rows: usize,
    most: i16,
    cell: impl Fn(D::T) -> Cell,
) -> ParquetResult<Vec<Cell>> {
    let (mut definition, mut values) = (Vec::new(), Vec::new());
    while reader.read_records(rows - definition.len().min(rows), Some(&mut definition), None, &mut values)?.0 > 0 {
        if definition.len() >= rows {
            break;
        }
    }
    let mut values = values.into_iter();
    let present = |level: &i16| if *level == most { values.next().map_or(Cell::Null, &cell) } else { Cell::Null };
    let cells: Vec<Cell> = definition.iter().map(present).collect();
    complete(cells, rows)
}

fn lists<D: DataType, T>(
    mut reader: ColumnReaderImpl<D>,
    rows: usize,
    most: i16,
    element: impl Fn(Option<D::T>) -> T,
    cell: impl Fn(Vec<T>) -> Cell,
) -> ParquetResult<Vec<Cell>> {
    let (mut definition, mut repetition, mut values) = (Vec::new(), Vec::new(), Vec::new());
    let mut records = 0;
    while records < rows {
        let (read, ..) =
            reader.read_records(rows - records, Some(&mut definition), Some(&mut repetition), &mut values)?;
        if read == 0 {
            break;
        }
        records += read;
    }
    let mut values = values.into_iter();
    let mut lists: Vec<Vec<T>> = Vec::with_capacity(records);
    for (definition, repetition) in definition.iter().zip(&repetition) {
        if *repetition == 0 {
            lists.push(Vec::new());
        }
        // One below the deepest is an element that is nothing; above that the list itself has none.
        if *definition >= most - 1 {
            let value = if *definition == most { values.next() } else { None };
            lists
                .last_mut()
                .ok_or_else(|| general("a list that goes on before it begins".to_owned()))?
                .push(element(value));
        }
    }
    complete(lists.into_iter().map(cell).collect(), rows)
}

/// The cells, if there is one for every row.
fn complete(cells: Vec<Cell>, rows: usize) -> ParquetResult<Vec<Cell>> {
    let found = cells.len();
    if found == rows { Ok(cells) } else { Err(general(format!("{found} cells of {rows} rows"))) }
}

fn damaged(file: &Path, place: Place, error: Option<&ParquetError>, expected: &str) -> Error {
    let why = error.map_or_else(|| "a page that contradicts itself".to_owned(), ToString::to_string);
    Error::content(file, place, format!("damaged Parquet ({why})"), expected)
}

fn general(message: String) -> ParquetError {
    ParquetError::General(message)
}
