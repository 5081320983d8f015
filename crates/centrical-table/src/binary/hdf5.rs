//! HDF5 files, and MATLAB files of version 7.3, which are HDF5 too.

use std::path::Path;

use hdf5_pure::{ChunkIndex, Dataset, Error as HdfError, File, FormatError, ReadSeekSource};

use super::arrays::{Line, column_names, lies_on_side, matrix_of, name_of_row};
use super::catch_panic::catch_panic;
use super::columnar::Column;
use crate::column::{ColumnName, Field, ROWS};
use crate::error::{Error, Place, quoted};
use crate::source::Source;

/// Numbers of a matrix that are read together.
const AT_ONCE: u64 = 16 * ROWS as u64;

/// No number takes more [bytes]: room is made for as many as there are of what a file claims.
const LARGEST_NUMBER: u64 = 16;

/// The columns of an HDF5 file that can hold `most` rows. MATLAB keeps its matrices there by columns.
pub(super) fn columns(source: &Source, by_columns: bool, fields: &[Field], most: u64) -> Result<Vec<Column>, Error> {
    let hdf = open(source)?;
    fields.iter().map(|field| column(source, &hdf, field, by_columns, most)).collect()
}

/// The names of the datasets, and of the columns of matrices.
pub(super) fn names(source: &Source, by_columns: bool) -> Result<Vec<ColumnName>, Error> {
    let hdf = open(source)?;
    let datasets = catch_panic(|| hdf.root().datasets());
    let datasets = datasets.map_err(|e| damaged(source.name(), Place::Whole, e.as_ref()))?;
    let of_dataset = |name: &String| -> Vec<ColumnName> {
        let shape = catch_panic(|| hdf.dataset(name)?.shape()).unwrap_or_default();
        match Table::of(&shape, by_columns) {
            Some(Table { columns: columns @ 2.., is_on_side: true, .. }) => {
                (1..=columns).map(|number| ColumnName::Name(name_of_row(name, number))).collect()
            }
            Some(Table { columns: columns @ 2.., .. }) => {
                column_names(name, usize::try_from(columns).unwrap_or(usize::MAX))
            }
            _ => vec![ColumnName::Name(name.clone())],
        }
    };
    Ok(datasets.iter().flat_map(of_dataset).collect())
}

/// A vector or a matrix as a table.
struct Table {
    rows: u64,
    columns: u64,
    /// Whether the file has its numbers column by column.
    by_columns: bool,
    /// Whether its columns are the rows of the matrix.
    is_on_side: bool,
}

impl Table {
    /// Of this shape.
    fn of(shape: &[u64], by_columns: bool) -> Option<Self> {
        let (rows, columns) = match *shape {
            [rows] | [1, rows] | [rows, 1] => (rows, 1),
            [columns, rows] if by_columns => (rows, columns),
            [rows, columns] => (rows, columns),
            _ => return None,
        };
        let is_on_side = lies_on_side(rows, columns);
        let (rows, columns) = if is_on_side { (columns, rows) } else { (rows, columns) };
        Some(Self { rows, columns, by_columns: by_columns != is_on_side, is_on_side })
    }
}

fn open(source: &Source) -> Result<File, Error> {
    let hdf = catch_panic(|| File::from_source(ReadSeekSource::new(source.reader_at(0)).map_err(HdfError::Format)?));
    hdf.map_err(|e| damaged(source.name(), Place::Whole, e.as_ref()))
}

/// What the library complains of.
fn damaged(file: &Path, place: Place, error: Option<&HdfError>) -> Error {
    let why = error.map_or_else(|| "it contradicts itself".to_owned(), ToString::to_string);
    Error::content(file, place, format!("damaged HDF5 ({why})"), "a whole HDF5 file")
}

/// One column: a vector by the path of its dataset, a line of a matrix by [`matrix_of`], or a column of the only dataset by
/// its number.
fn column(source: &Source, hdf: &File, field: &Field, by_columns: bool, most: u64) -> Result<Column, Error> {
    let (file, place) = (source.name(), || Place::Column(field.name.to_string()));
    let (path, name) = (file.to_owned(), place());
    let damaged = move |e: Option<HdfError>| damaged(&path, name.clone(), e.as_ref());
    let wrong = |found: String, expected: &str| Err(Error::content(file, place(), found, expected));
    let names = catch_panic(|| hdf.root().datasets()).map_err(&damaged)?;
    let found = || format!("datasets {}", quoted(names.join(", ").as_bytes()));
    let (name, line) = match (&field.name, names.as_slice()) {
        (ColumnName::Name(name), _) => matrix_of(name).map_or((&**name, None), |(name, line)| (name, Some(line))),
        (ColumnName::Number(number), [only]) => (&**only, Some(Line::Column(*number))),
        _ => return wrong(found(), "one dataset, or [columns] by name"),
    };
    let Ok(dataset) = catch_panic(|| hdf.dataset(name)) else { return wrong(found(), "a dataset of this name") };
    let shape = catch_panic(|| dataset.shape()).map_err(&damaged)?;
    let Some(Table { rows, columns, by_columns, is_on_side }) = Table::of(&shape, by_columns) else {
        return wrong(format!("an array of shape {shape:?}"), "a vector or a matrix");
    };
    let (number, is_asked) = match (line, &field.name) {
        (None, _) => (1, columns == 1),
        (Some(Line::Row(number)), _) => (number, is_on_side),
        (Some(Line::Column(number)), name) => (number, !is_on_side || matches!(name, ColumnName::Number(_))),
    };
    if !is_asked || !(1..=columns).contains(&(number as u64)) || columns > AT_ONCE || rows > most {
        let expected = "a vector by name, or a column of a matrix by number, or by name as in f(:,2)";
        return wrong(format!("an array of shape {shape:?}"), expected);
    }
    if let Some((found, expected)) = unreadable(&dataset).map_err(&damaged)? {
        return wrong(found, expected);
    }
    let size = catch_panic(|| dataset.element_size()).map_err(&damaged)?;
    if size > LARGEST_NUMBER {
        return wrong(format!("elements of {size} bytes"), "numbers");
    }
    if let Some(found) = too_large_chunk(source.length(), &dataset, most).map_err(&damaged)? {
        return wrong(found, "chunks that the file can hold");
    }
    if by_columns || shape.first() == Some(&1) {
        // A row of the file holds the whole column.
        let mut whole = catch_panic(|| row(&dataset, number as u64 - 1)).map_err(&damaged)?.into_iter();
        return Ok(Column::Numbers(Box::new(move |values| {
            values.extend(whole.by_ref().take(ROWS));
            Ok(())
        })));
    }
    let (mut start, step) = (0, AT_ONCE / columns);
    Ok(Column::Numbers(Box::new(move |values| {
        let end = (start + ROWS as u64).min(rows);
        while start < end {
            let count = step.min(end - start);
            let block = catch_panic(|| dataset.read_f64_rows(start, count)).map_err(&damaged)?;
            start += count;
            values.extend(block.iter().skip(number - 1).step_by(usize::try_from(columns).unwrap_or(usize::MAX)));
        }
        Ok(())
    })))
}

/// A layout that the library does not know, and what it does.
fn unreadable(dataset: &Dataset) -> Result<Option<(String, &'static str)>, Option<HdfError>> {
    match catch_panic(|| dataset.chunk_index()) {
        Ok(Some(ChunkIndex::BTreeV2)) => Ok(Some((
            "chunks indexed by a B-tree of version 2".to_owned(),
            "another index: at most one unlimited dimension, or a file for earlier versions (in h5py libver=\"earliest\")",
        ))),
        Err(Some(HdfError::Format(FormatError::InvalidLayoutVersion(version)))) => Ok(Some((
            format!("a data layout of version {version}"),
            "4 or before: a file for HDF5 1.14 or earlier versions (in h5py libver=\"earliest\")",
        ))),
        known => known.map(|_| None),
    }
}

/// A chunk that claims more than there can be: it is unpacked as a whole, and room is made for what it claims to take in the file
/// before that is read.
fn too_large_chunk(bytes: u64, dataset: &Dataset, most: u64) -> Result<Option<String>, Option<HdfError>> {
    if !dataset.is_chunked() {
        return Ok(None);
    }
    let shape = catch_panic(|| dataset.chunk_shape())?.unwrap_or_default();
    if shape.iter().fold(1, |numbers: u64, length| numbers.saturating_mul(*length)) > most {
        return Ok(Some(format!("chunks of shape {shape:?}")));
    }
    let stored = catch_panic(|| dataset.chunks())?;
    let size = stored.iter().map(|chunk| chunk.storage_size).find(|size| *size > bytes);
    Ok(size.map(|size| format!("a chunk of {size} bytes")))
}

/// A row of a matrix, or a whole vector.
fn row(dataset: &Dataset, row: u64) -> Result<Vec<f64>, HdfError> {
    if dataset.shape()?.len() == 1 { dataset.read_f64() } else { dataset.read_f64_rows(row, 1) }
}
