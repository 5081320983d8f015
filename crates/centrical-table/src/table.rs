//! Tables of numbers, whatever the format: chosen columns, row by row, in blocks of bounded size.
//!
//! The format is told by the first bytes of the file, not by its name.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use flate2::read::MultiGzDecoder;
use memchr::memchr_iter;

#[cfg(feature = "hdf5")]
use crate::binary::hdf5;
use crate::binary::{arrow, mat, npy, parquet};
use crate::column::Field;
use crate::error::{Error, Place};
use crate::rows::{Block, Rows, Visitor};
use crate::text::{self, Index, Packed, Plain};

/// Reads `fields` of the table in `file` and hands them to `visit` in blocks.
///
/// Memory stays bounded however long the table is.
pub fn read(file: &Path, fields: &[Field], expected: &str, visit: &mut dyn FnMut(&mut Block)) -> Result<(), Error> {
    let mut each = |blocks: &mut [Block]| blocks.iter_mut().for_each(&mut *visit);
    read_batches(file, Extent::Whole, fields, expected, &mut Visitor { visit: &mut each, progress: &|_| {} })
        .map(|_| ())
}

/// How much of a file there is to read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// All of it.
    Whole,
    /// Someone is still writing: of a text the lines that are ended, the last one may have come in part. Other formats
    /// are whole or cannot be read.
    Growing,
}

/// [`read`] of what there is, in batches of blocks. Of a text that is not packed the index is returned, by which any
/// part of it can be read again.
pub fn read_batches(
    file: &Path,
    extent: Extent,
    fields: &[Field],
    expected: &str,
    visitor: &mut Visitor,
) -> Result<Option<Index>, Error> {
    let mut input = open(file, expected)?;
    let bytes = input.metadata().map_err(|e| Error::reading(file, e, expected))?.len();
    let mut rows = Rows::new(fields, bytes, visitor);
    let mut index = None;
    let magic = first_bytes(&mut input).map_err(|e| Error::reading(file, e, expected))?;
    if magic.is_empty() {
        return Err(Error::content(file, Place::Whole, "an empty file", expected));
    }
    let format = Format::of(&magic);
    match format {
        Format::Text => {
            let lines = Plain::open(file).map_err(|e| Error::reading(file, e, expected))?;
            let mut lines = match extent {
                Extent::Whole => lines,
                Extent::Growing => {
                    let ended = ended_lines(&mut input, bytes).map_err(|e| Error::reading(file, e, expected))?;
                    lines.up_to(ended)
                }
            };
            index = text::read(file, &mut lines, &mut rows)?;
        }
        Format::Gzip => drop(text::read(file, &mut Packed::new(file, MultiGzDecoder::new(input)), &mut rows)?),
        Format::Zstd => {
            let unpacked = zstd::Decoder::new(input).map_err(|e| Error::reading(file, e, expected))?;
            text::read(file, &mut Packed::new(file, unpacked), &mut rows)?;
        }
        Format::Parquet => parquet::read(file, &input, &mut rows)?,
        Format::Npy => npy::read(file, &input, &mut rows)?,
        Format::Npz => npy::read_archive(file, input, &mut rows)?,
        Format::Arrow => arrow::read(file, &input, &mut rows)?,
        Format::Mat => mat::read(file, &input, &mut rows)?,
        #[cfg(feature = "hdf5")]
        Format::Hdf5 | Format::MatHdf5 => hdf5::read(file, format == Format::MatHdf5, &mut rows)?,
        #[cfg(not(feature = "hdf5"))]
        Format::Hdf5 | Format::MatHdf5 => {
            let expected = "another format (this program was built without the feature hdf5)";
            return Err(Error::content(file, Place::Whole, "HDF5", expected));
        }
    }
    rows.deliver_gathered();
    if index.is_none() {
        (rows.progress)(bytes);
    }
    let found = match rows.count {
        0 => "a table without rows".to_owned(),
        _ if rows.is_too_long() => format!("a file of {bytes} bytes that unpacks to more than {} rows", rows.most),
        _ => return Ok(index),
    };
    Err(Error::content(file, Place::Whole, found, expected))
}

/// Rows of a table, more or less, as a glance tells: of a text by how long the lines in its middle are. Nothing of other
/// formats.
pub fn rows_at_a_glance(file: &Path) -> Option<u64> {
    const GLANCE: u64 = 1 << 16;
    let mut input = open(file, "a table of numbers").ok()?;
    let bytes = input.metadata().ok()?.len();
    let format = Format::of(&first_bytes(&mut input).ok()?);
    let mut seen = Vec::new();
    input.seek(SeekFrom::Start(bytes.saturating_sub(GLANCE) / 2)).ok()?;
    input.take(GLANCE).read_to_end(&mut seen).ok()?;
    let lines = memchr_iter(b'\n', &seen).count() as u64;
    (format == Format::Text && lines > 0).then(|| bytes.div_ceil(seen.len() as u64) * lines)
}

/// The formats, told by their first bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Text,
    /// Text in gzip.
    Gzip,
    /// Text in Zstandard.
    Zstd,
    Parquet,
    /// Arrow IPC, as a file or a stream.
    Arrow,
    /// An array of NumPy.
    Npy,
    /// An archive of such arrays.
    Npz,
    /// MATLAB, version 5.
    Mat,
    Hdf5,
    /// MATLAB, version 7.3: HDF5 after a header of its own.
    MatHdf5,
}

impl Format {
    fn of(magic: &[u8]) -> Self {
        const MAGIC: [(&[u8], Format); 10] = [
            (b"\x1f\x8b", Format::Gzip),
            (b"\x28\xb5\x2f\xfd", Format::Zstd),
            (b"PAR1", Format::Parquet),
            (b"ARROW1", Format::Arrow),
            (&arrow::CONTINUATION, Format::Arrow),
            (b"\x93NUMPY", Format::Npy),
            (b"PK\x03\x04", Format::Npz),
            (b"MATLAB 5", Format::Mat),
            (b"\x89HDF\r\n\x1a\n", Format::Hdf5),
            (b"MATLAB 7", Format::MatHdf5),
        ];
        MAGIC.into_iter().find(|(start, _)| magic.starts_with(start)).map_or(Self::Text, |(_, format)| format)
    }
}

/// Opens a regular file: a pipe or a device could keep the reader for ever.
fn open(file: &Path, expected: &str) -> Result<File, Error> {
    let kind = std::fs::metadata(file).map_err(|e| Error::reading(file, e, expected))?.file_type();
    if !kind.is_file() {
        let found = if kind.is_dir() { "a folder" } else { "something that is no regular file" };
        return Err(Error::content(file, Place::Whole, found, expected));
    }
    File::open(file).map_err(|e| Error::reading(file, e, expected))
}

/// The first bytes, up to 8, leaving the file at its start.
fn first_bytes(input: &mut File) -> std::io::Result<Vec<u8>> {
    let mut magic = Vec::new();
    input.take(8).read_to_end(&mut magic)?;
    input.rewind()?;
    Ok(magic)
}

/// Length of the lines that are ended among the first `bytes`, leaving the file at its start.
fn ended_lines(input: &mut File, bytes: u64) -> std::io::Result<u64> {
    const PIECE: u64 = 1 << 16;
    let mut end = bytes;
    let mut piece = Vec::new();
    while end > 0 {
        let start = end.saturating_sub(PIECE);
        input.seek(SeekFrom::Start(start))?;
        piece.clear();
        input.take(end - start).read_to_end(&mut piece)?;
        if let Some(last) = memchr::memrchr(b'\n', &piece) {
            input.rewind()?;
            return Ok(start + last as u64 + 1);
        }
        end = start;
    }
    input.rewind()?;
    Ok(0)
}
