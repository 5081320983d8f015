//! MATLAB files of version 5 (`save -v6` and `-v7`): vectors and matrices of numbers, packed or not.
//!
//! After a header of 128 bytes come elements: a type, a size and that many bytes, padded to eight. An element is a
//! matrix, or a matrix packed by zlib; inside, further elements hold its class, dimensions, name and numbers. Of what
//! is not a real matrix of numbers (text, cells, structures, complex numbers) only the name is kept, for messages.

use std::io::{self, Read};

use super::arrays;
use super::arrays::{Array, ArrayColumn, Bytes, Packing, Scalar, ScalarKind, lies_on_side, name_of_row};
use super::columnar::Column;
use crate::column::{ColumnName, Field};
use crate::error::{Error, Place};
use crate::source::Source;

/// Length of the header; its last two bytes are `IM` where the numbers start with the low byte.
const HEADER: u64 = 128;

/// Types of elements.
const MATRIX: u32 = 14;
const PACKED: u32 = 15;

/// Longest name of a variable, and most columns of a matrix.
const MOST: u64 = 1 << 16;

/// The columns of a MATLAB file.
pub(super) fn columns(source: &Source, fields: &[Field]) -> Result<Vec<Column>, Error> {
    arrays::columns(source, &matrices(source)?, fields)
}

/// Their names, or numbers.
pub(super) fn names(source: &Source) -> Result<Vec<ColumnName>, Error> {
    arrays::names(source, &matrices(source)?)
}

fn matrices(source: &Source) -> Result<Vec<Array>, Error> {
    let damaged = |e| Error::content(source.name(), Place::Whole, format!("damaged ({e})"), "a MATLAB file");
    arrays(source).map_err(damaged)
}

/// The matrices of numbers in the file.
fn arrays(source: &Source) -> io::Result<Vec<Array>> {
    let length = source.length();
    let plain = |offset: u64| Bytes {
        packing: Packing::Plain,
        offset,
        length: length.saturating_sub(offset),
        skip: 0,
        crc_32: None,
    };
    let mut order = [0; 2];
    plain(HEADER - 2).open(source, 0)?.read_exact(&mut order)?;
    let big_endian = order == *b"MI";
    let mut arrays = Vec::new();
    let mut offset = HEADER;
    while offset + 8 <= length {
        let tag = Stream { input: plain(offset).open(source, 0)?, read: 0, big_endian }.tag()?;
        let bytes = Bytes { packing: Packing::Plain, offset: offset + 8, length: tag.size, skip: 0, crc_32: None };
        match tag.kind {
            MATRIX => arrays.extend(array(source, bytes, big_endian)?),
            PACKED => {
                let bytes = Bytes { packing: Packing::Zlib, ..bytes };
                let inner = Stream { input: bytes.open(source, 0)?, read: 0, big_endian }.tag()?;
                if inner.kind == MATRIX {
                    arrays.extend(array(source, Bytes { skip: 8, ..bytes }, big_endian)?);
                }
            }
            _ => {}
        }
        offset += 8 + tag.size;
    }
    Ok(arrays)
}

/// A matrix of numbers; of another variable its name.
fn array(source: &Source, bytes: Bytes, big_endian: bool) -> io::Result<Option<Array>> {
    /// Classes 6 to 15 are the real numbers, this flag makes them complex.
    const COMPLEX: u32 = 0x800;
    let mut stream = Stream { input: bytes.open(source, 0)?, read: 0, big_endian };
    let flags = stream.element(8)?;
    let class = word(&flags, big_endian);
    let dimensions = stream.element(8)?;
    let name = String::from_utf8_lossy(&stream.element(MOST)?).into_owned();
    if !(6..=15).contains(&(class & 0xff)) || class & COMPLEX != 0 || dimensions.len() != 8 {
        let none = Vec::new();
        return Ok(Some(Array { name, bytes, rows: 0, stride: 0, columns: none, halves: Vec::new() }));
    }
    let numbers = stream.tag()?;
    let Some(scalar) = scalar(numbers.kind, big_endian) else { return Ok(None) };
    let [rows, columns] = [&dimensions[..4], &dimensions[4..]].map(|d| u64::from(word(d, big_endian)));
    let (rows, columns) = if rows == 1 || columns == 1 { (rows * columns, 1) } else { (rows, columns) };
    let size = scalar.size as u64;
    let bytes = Bytes { skip: bytes.skip + stream.read, ..bytes };
    let (rows, stride, places): (u64, u64, Vec<ArrayColumn>) = if lies_on_side(rows, columns) {
        let place = |j| ArrayColumn { name: name_of_row(&name, j + 1), start: size * j, scalar };
        (columns, size * rows, (0..rows).map(place).collect())
    } else if columns > MOST {
        return Ok(None);
    } else {
        let place = |j| ArrayColumn { name: String::new(), start: rows.saturating_mul(size * j), scalar };
        (rows, size, (0..columns).map(place).collect())
    };
    Ok(Some(Array { name, bytes, rows, stride, columns: places, halves: Vec::new() }))
}

/// The numbers of an element of this type.
fn scalar(kind: u32, big_endian: bool) -> Option<Scalar> {
    let (kind, size) = match kind {
        1 => (ScalarKind::Signed, 1),
        2 => (ScalarKind::Unsigned, 1),
        3 => (ScalarKind::Signed, 2),
        4 => (ScalarKind::Unsigned, 2),
        5 => (ScalarKind::Signed, 4),
        6 => (ScalarKind::Unsigned, 4),
        7 => (ScalarKind::Float, 4),
        9 => (ScalarKind::Float, 8),
        12 => (ScalarKind::Signed, 8),
        13 => (ScalarKind::Unsigned, 8),
        _ => return None,
    };
    Scalar::new(kind, size, big_endian)
}

fn word(bytes: &[u8], big_endian: bool) -> u32 {
    let mut word = [0; 4];
    word.iter_mut().zip(bytes).for_each(|(to, from)| *to = *from);
    if big_endian { u32::from_be_bytes(word) } else { u32::from_le_bytes(word) }
}

/// Elements one after the other.
struct Stream {
    input: Box<dyn Read>,
    /// Bytes read so far.
    read: u64,
    big_endian: bool,
}

/// Type and size of an element.
struct Tag {
    kind: u32,
    size: u64,
    /// Size with the padding.
    padded: u64,
}

impl Stream {
    /// The next type and size. Up to four bytes may share the eight bytes of the tag.
    fn tag(&mut self) -> io::Result<Tag> {
        let first = word(&self.bytes(4)?, self.big_endian);
        if first >> 16 != 0 {
            return Ok(Tag { kind: first & 0xffff, size: u64::from(first >> 16), padded: 4 });
        }
        let size = u64::from(word(&self.bytes(4)?, self.big_endian));
        Ok(Tag { kind: first, size, padded: size.next_multiple_of(8) })
    }

    /// The next element, of `most` bytes at most.
    fn element(&mut self, most: u64) -> io::Result<Vec<u8>> {
        let tag = self.tag()?;
        if tag.size > most.min(tag.padded) {
            return Err(io::Error::other(format!("an element of {} bytes", tag.size)));
        }
        let mut bytes = self.bytes(tag.padded)?;
        bytes.truncate(usize::try_from(tag.size).unwrap_or(usize::MAX));
        Ok(bytes)
    }

    fn bytes(&mut self, count: u64) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.input.by_ref().take(count).read_to_end(&mut bytes)?;
        self.read += bytes.len() as u64;
        if bytes.len() as u64 == count { Ok(bytes) } else { Err(io::ErrorKind::UnexpectedEof.into()) }
    }
}
