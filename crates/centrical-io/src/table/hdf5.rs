//! HDF5 files, and MATLAB files of version 7.3, which are HDF5 too.

use std::path::Path;

use hdf5_pure::{Dataset, Error as HdfError, File};

use super::columnar::{self, Column};
use super::{BLOCK, ColumnName, Field, Rows, caught};
use crate::error::{Error, Place, quoted};

/// Reads an HDF5 file. MATLAB keeps its matrices there by columns.
pub(super) fn read(file: &Path, by_columns: bool, rows: &mut Rows) -> Result<(), Error> {
    let hdf = caught(|| File::open_streaming(file)).map_err(|e| damaged(file, Place::Whole, e.as_ref()))?;
    let most = rows.most;
    let open = |field| column(file, &hdf, field, by_columns, most);
    let mut columns = rows.fields.iter().map(open).collect::<Result<Vec<_>, Error>>()?;
    columnar::read(file, &mut columns, &mut 0, rows)
}

/// What the library complains of.
fn damaged(file: &Path, place: Place, error: Option<&HdfError>) -> Error {
    let why = error.map_or_else(|| "it contradicts itself".to_owned(), ToString::to_string);
    Error::content(file, place, format!("damaged HDF5 ({why})"), "a whole HDF5 file")
}

/// One column: a vector by the path of its dataset, or a column of the only dataset by its number.
fn column<'a>(file: &'a Path, hdf: &File, field: &'a Field, by_columns: bool, most: u64) -> Result<Column<'a>, Error> {
    let place = || Place::Column(field.name.to_string());
    let damaged = move |e: Option<HdfError>| damaged(file, place(), e.as_ref());
    let wrong = |found: String, expected: &str| Err(Error::content(file, place(), found, expected));
    let names = caught(|| hdf.root().datasets()).map_err(damaged)?;
    let found = || format!("datasets {}", quoted(names.join(", ").as_bytes()));
    let (name, number) = match (&field.name, names.as_slice()) {
        (ColumnName::Name(name), _) => (name, 1),
        (ColumnName::Number(number), [only]) => (only, *number),
        _ => return wrong(found(), "one dataset, or [columns] by name"),
    };
    let Ok(dataset) = caught(|| hdf.dataset(name)) else { return wrong(found(), "a dataset of this name") };
    let shape = caught(|| dataset.shape()).map_err(damaged)?;
    let (rows, columns) = match shape.as_slice() {
        [rows] | [1, rows] | [rows, 1] => (*rows, 1),
        [columns, rows] if by_columns => (*rows, *columns),
        [rows, columns] => (*rows, *columns),
        _ => return wrong(format!("an array of shape {shape:?}"), "a vector or a matrix"),
    };
    let by_name = matches!(field.name, ColumnName::Name(_));
    if (by_name && columns != 1) || !(1..=columns.min(1 << 16)).contains(&(number as u64)) || rows > most {
        return wrong(format!("an array of shape {shape:?}"), "a vector by name, or a column of a matrix by number");
    }
    if by_columns || shape.first() == Some(&1) {
        // A row of the file holds the whole column.
        let mut whole = caught(|| row(&dataset, number as u64 - 1)).map_err(damaged)?.into_iter();
        return Ok(Box::new(move |values| {
            values.extend(whole.by_ref().take(BLOCK));
            Ok(())
        }));
    }
    let mut start = 0;
    Ok(Box::new(move |values| {
        let block = caught(|| dataset.read_f64_rows(start, BLOCK as u64)).map_err(damaged)?;
        start += BLOCK as u64;
        values.extend(block.iter().skip(number - 1).step_by(usize::try_from(columns).unwrap_or(usize::MAX)));
        Ok(())
    }))
}

/// A row of a matrix, or a whole vector.
fn row(dataset: &Dataset, row: u64) -> Result<Vec<f64>, HdfError> {
    if dataset.shape()?.len() == 1 { dataset.read_f64() } else { dataset.read_f64_rows(row, 1) }
}
