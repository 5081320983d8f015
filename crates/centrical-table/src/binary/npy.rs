//! Arrays of NumPy: `.npy` files, and `.npz` archives of them.
//!
//! A `.npy` file opens with the magic bytes, a version, the length of the header and the header: a Python
//! dictionary of `descr` (type of the numbers), `fortran_order` and `shape`.

use std::io::{self, Read};

use super::arrays;
use super::arrays::{Array, ArrayColumn, Bytes, Packing, Scalar, ScalarKind, lies_on_side, name_of_row};
use super::columnar::Column;
use super::npy_literal::Literal;
use crate::column::{ColumnName, Field};
use crate::error::{Error, Place, quoted};
use crate::source::Source;

/// Longest header [bytes].
const LONGEST_HEADER: usize = 1 << 16;

/// The columns of a `.npy` file.
pub(super) fn columns(source: &Source, fields: &[Field]) -> Result<Vec<Column>, Error> {
    arrays::columns(source, &[only(source)?], fields)
}

/// Their names, or numbers.
pub(super) fn names(source: &Source) -> Result<Vec<ColumnName>, Error> {
    arrays::names(source, &[only(source)?])
}

/// The columns of a `.npz` archive.
pub(super) fn archive_columns(source: &Source, fields: &[Field]) -> Result<Vec<Column>, Error> {
    arrays::columns(source, &members(source)?, fields)
}

/// Their names, or numbers.
pub(super) fn archive_names(source: &Source) -> Result<Vec<ColumnName>, Error> {
    arrays::names(source, &members(source)?)
}

/// The array of a `.npy` file.
fn only(source: &Source) -> Result<Array, Error> {
    let bytes = Bytes { packing: Packing::Plain, offset: 0, length: source.length(), skip: 0, crc_32: None };
    array(source, "", bytes)?.ok_or_else(|| {
        Error::content(source.name(), Place::Whole, "an array of another shape", "a vector, a matrix or records")
    })
}

/// The arrays of a `.npz` archive.
fn members(source: &Source) -> Result<Vec<Array>, Error> {
    let file = source.name();
    let damaged = |e: zip::result::ZipError| Error::content(file, Place::Whole, e.to_string(), "a .npz archive");
    let mut archive = zip::ZipArchive::new(source.reader_at(0)).map_err(damaged)?;
    let mut arrays = Vec::new();
    for member in 0..archive.len() {
        let member = archive.by_index_raw(member).map_err(damaged)?;
        let name = member.name().map_err(damaged)?;
        let Some(name) = name.strip_suffix(".npy") else { continue };
        let packing = match member.compression() {
            zip::CompressionMethod::Stored => Packing::Plain,
            zip::CompressionMethod::Deflated => Packing::Deflate,
            other => {
                let place = Place::Column(name.to_owned());
                return Err(Error::content(file, place, format!("{other} compression"), "deflate or none"));
            }
        };
        let offset = member.data_start().unwrap_or(0);
        let (length, crc_32) = (member.compressed_size(), Some(member.crc32()));
        arrays.extend(array(source, name, Bytes { packing, offset, length, skip: 0, crc_32 })?);
    }
    Ok(arrays)
}

/// The array that starts with a header at these bytes, if it has rows and columns.
fn array(source: &Source, name: &str, bytes: Bytes) -> Result<Option<Array>, Error> {
    let place = || if name.is_empty() { Place::Whole } else { Place::Column(name.to_owned()) };
    let wrong = |found: String| Error::content(source.name(), place(), found, "the header of an array of NumPy");
    let header = header(bytes, source).map_err(|e| wrong(format!("a damaged header ({e})")))?;
    let literal = Literal::parse(&header.text).ok_or_else(|| wrong(quoted(header.text.trim_ascii())))?;
    Ok(Shape::of(&literal).map(|shape| shape.array(name, Bytes { skip: header.length, ..bytes })))
}

/// The header as text, and its length with all before it.
struct Header {
    text: Vec<u8>,
    length: u64,
}

fn header(bytes: Bytes, source: &Source) -> io::Result<Header> {
    let mut input = bytes.open(source, 0)?;
    let mut start = [0; 8];
    input.read_exact(&mut start)?;
    let (length, before) = match start {
        [0x93, b'N', b'U', b'M', b'P', b'Y', 1, _] => {
            let mut length = [0; 2];
            input.read_exact(&mut length)?;
            (usize::from(u16::from_le_bytes(length)), 10)
        }
        [0x93, b'N', b'U', b'M', b'P', b'Y', 2 | 3, _] => {
            let mut length = [0; 4];
            input.read_exact(&mut length)?;
            (u32::from_le_bytes(length) as usize, 12)
        }
        _ => return Err(io::Error::other("an unknown version")),
    };
    if length > LONGEST_HEADER {
        return Err(io::Error::other(format!("{length} bytes")));
    }
    let mut text = vec![0; length];
    input.read_exact(&mut text)?;
    Ok(Header { text, length: (before + length) as u64 })
}

/// What a header says.
struct Shape {
    rows: u64,
    /// Columns of a matrix.
    columns: u64,
    by_columns: bool,
    /// Names, places and types of the numbers of one element, and its size.
    numbers: Vec<(String, u64, Scalar)>,
    /// Names of numbers of 16 bits, which are not read: they have three digits.
    halves: Vec<String>,
    size: u64,
}

impl Shape {
    fn of(header: &Literal) -> Option<Self> {
        let shape = header.get("shape")?.list()?;
        let (rows, columns) = match shape.iter().map(Literal::number).collect::<Option<Vec<_>>>()?.as_slice() {
            [rows] | [1, rows] => (*rows, 1),
            [rows, columns] => (*rows, *columns),
            _ => return None,
        };
        let by_columns = header.get("fortran_order")?.truth()?;
        let (mut numbers, mut halves) = (Vec::new(), Vec::new());
        let mut size = 0_u64;
        match header.get("descr")? {
            Literal::Text(kind) => {
                let (width, scalar) = scalar(kind)?;
                halves.extend(is_half(kind).then(String::new));
                numbers.extend(scalar.map(|scalar| (String::new(), 0, scalar)));
                size = width;
            }
            record => {
                for field in record.list()? {
                    let [Literal::Text(name), Literal::Text(kind)] = field.list()? else { return None };
                    let (width, scalar) = scalar(kind)?;
                    halves.extend(is_half(kind).then(|| name.clone()));
                    numbers.extend(scalar.map(|scalar| (name.clone(), size, scalar)));
                    size = size.checked_add(width)?;
                }
            }
        }
        (columns <= LONGEST_HEADER as u64 || lies_on_side(rows, columns)).then_some(Self {
            rows,
            columns,
            by_columns,
            numbers,
            halves,
            size,
        })
    }

    fn array(self, name: &str, bytes: Bytes) -> Array {
        let (row, column) = if self.by_columns {
            (self.size, self.size.saturating_mul(self.rows))
        } else {
            (self.size.saturating_mul(self.columns), self.size)
        };
        let is_on_side = lies_on_side(self.rows, self.columns);
        let (rows, stride, columns, step) =
            if is_on_side { (self.columns, column, self.rows, row) } else { (self.rows, row, self.columns, column) };
        let numbers = &self.numbers;
        let place = |j: u64| {
            numbers.iter().map(move |(own, start, scalar)| ArrayColumn {
                name: if is_on_side && own.is_empty() { name_of_row(name, j + 1) } else { own.clone() },
                start: step.saturating_mul(j).saturating_add(*start),
                scalar: *scalar,
            })
        };
        let columns = (0..columns).flat_map(place).collect();
        Array { name: name.to_owned(), bytes, rows, stride, columns, halves: self.halves }
    }
}

/// Whether a type is of floating point in 16 bits.
fn is_half(kind: &str) -> bool {
    kind.get(1..) == Some("f2")
}

/// Size of a type such as `<f8`, and how to read it where it is a number.
fn scalar(kind: &str) -> Option<(u64, Option<Scalar>)> {
    let (order, letter, size) = (kind.get(..1)?, kind.get(1..2)?, kind.get(2..)?);
    let kind = match letter {
        "f" => ScalarKind::Float,
        "i" => ScalarKind::Signed,
        "u" => ScalarKind::Unsigned,
        // Four bytes a character.
        "U" => return Some((size.parse::<u32>().map(u64::from).ok()? * 4, None)),
        _ => return Some((size.parse::<u32>().map(u64::from).ok()?, None)),
    };
    let size: u8 = size.parse().ok()?;
    Some((size.into(), Scalar::new(kind, size.into(), order == ">")))
}
