//! Tables in, whatever the format: chosen columns, row by row, in batches of bounded size.
//!
//! The first bytes of the file show its format, not its name.

use std::io::{self, Read};
use std::path::{Path, PathBuf};

use flate2::read::MultiGzDecoder;
use memchr::{memchr_iter, memrchr};

#[cfg(feature = "xlsx")]
use crate::binary::catch_panic;
use crate::binary::{BinaryFormat, ColumnReader};
use crate::column::{ColumnName, Field, RowNumber, Rows, TableLines, UnitsFound};
use crate::error::{Error, Place};
use crate::source::Source;
use crate::stamp::Stamps;
use crate::text::{Index, Lines, Packed, Plain, SIGHT, TextEncoding, TextForm, TextReader, complete_lines, in_utf_8};
use crate::unpacking::Unpacked;

/// Rows per byte of a packed file: the noise of a sensor takes a bit a row and more, however it is packed.
const ROWS_PER_BYTE: u64 = 8;

/// Rows that may be packed into nothing: 32 MB of four columns.
const ROWS_ALLOWANCE: u64 = 1_000_000;

/// How much of a file is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// All of it.
    Whole,
    /// Someone is still writing: of a text the complete lines, as the last one may be there in part. Other formats
    /// are whole or cannot be read.
    Growing,
}

/// A table that is read batch by batch, in memory that does not grow with it.
pub struct TableReader {
    file: PathBuf,
    /// What the file is, for messages.
    expected: String,
    /// Its length, and how much of it was read.
    length: u64,
    bytes: u64,
    table: Table,
    row_number: RowNumber,
    /// Rows that were handed out, and sets of rows in the last batch.
    count: u64,
    batch: usize,
}

enum Table {
    Text(Box<TextReader>),
    Binary(ColumnReader),
}

impl TableReader {
    /// Opens `file`, which should be what `expected` says, to read `fields`.
    ///
    /// # Errors
    /// If it cannot be read, or a binary table lacks a column.
    pub fn open(file: &Path, extent: Extent, fields: &[Field], expected: &str) -> Result<Self, Error> {
        Self::new(Source::open(file, expected)?, extent, fields, expected, TableLines::default())
    }

    /// The table in a source, which should be what `expected` says, to read `fields`; of a text, `lines` says in which of them
    /// the header or the first row stands, where that is known.
    ///
    /// # Errors
    /// As [`TableReader::open`].
    pub fn new(
        source: Source,
        extent: Extent,
        fields: &[Field],
        expected: &str,
        lines: TableLines,
    ) -> Result<Self, Error> {
        let (file, length) = (source.name().to_owned(), source.length());
        let magic = first_bytes(&source).map_err(|e| Error::reading(&file, e, expected))?;
        if magic.is_empty() {
            return Err(Error::content(&file, Place::Whole, "an empty file", expected));
        }
        let mut fields = fields.to_vec();
        let row_number = RowNumber::take_out(&mut fields);
        let table = match Format::of(&magic, &source) {
            Format::Binary(format) => Table::Binary(format.open(&source, fields, most_rows(length))?),
            format => {
                let text = text_lines(source, format, &magic, extent, expected)?;
                Table::Text(Box::new(TextReader::new(&file, text, fields, lines)))
            }
        };
        let expected = expected.to_owned();
        Ok(Self { file, expected, length, bytes: 0, table, row_number, count: 0, batch: 0 })
    }

    /// The next rows, several sets of them so that they may be worked on in parallel; none at the end. They belong to the
    /// caller until the next call.
    ///
    /// # Errors
    /// If the file cannot be read, has no rows, lacks a column, or a value is not what its field asks for.
    pub fn next_batch(&mut self) -> Result<Option<&mut [Rows]>, Error> {
        self.row_number.remove(self.table.rows(std::mem::take(&mut self.batch)));
        let read = match &mut self.table {
            Table::Text(text) => text.read()?,
            Table::Binary(columns) => Some((columns.read()?, 0)).filter(|(sets, _)| *sets > 0),
        };
        let Some((sets, bytes)) = read else {
            self.bytes = self.length;
            return if self.count == 0 { Err(self.refuse("a table without rows".to_owned())) } else { Ok(None) };
        };
        self.bytes += bytes;
        self.batch = sets;
        for rows in self.table.rows(sets) {
            let first = self.count;
            self.count += rows[0].len() as u64;
            self.row_number.put(first, rows);
        }
        let most = most_rows(self.length);
        if self.count > most {
            let found = format!("a file of {} bytes that unpacks to more than {most} rows", self.length);
            return Err(self.refuse(found));
        }
        Ok(Some(self.table.rows(sets)))
    }

    /// The rows that were read last, once more.
    pub fn batch(&mut self) -> &mut [Rows] {
        self.table.rows(self.batch)
    }

    /// Keeps stamps in the first field as they are read, for [`TableReader::take_stamps`].
    pub fn keep_stamps(&mut self) {
        match &mut self.table {
            Table::Text(text) => text.keep_stamps(),
            Table::Binary(columns) => columns.keep_stamps(),
        }
    }

    /// The stamps of the rows that were read last, for each set of them; none where the field is of numbers.
    pub fn take_stamps(&mut self) -> Vec<Stamps> {
        match &mut self.table {
            Table::Text(text) => text.take_stamps(self.batch),
            Table::Binary(columns) => columns.take_stamps(self.batch),
        }
    }

    fn refuse(&self, found: String) -> Error {
        Error::content(&self.file, Place::Whole, found, self.expected.as_str())
    }

    /// Bytes of the file that were read so far; of a packed or binary file none before its end.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Units that a text names beside or below the names of its columns, once rows were read.
    pub fn units(&self) -> Option<UnitsFound> {
        let Table::Text(text) = &self.table else { return None };
        Some(self.row_number.in_all(text.units()?.clone()))
    }

    /// After the end: where the rows are, so that any part can be read again; only of a text that is not packed.
    pub fn into_index(self) -> Option<Index> {
        match self.table {
            Table::Text(text) => text.into_index(self.row_number),
            Table::Binary(_) => None,
        }
    }
}

impl Table {
    /// The rows that were read last.
    fn rows(&mut self, sets: usize) -> &mut [Rows] {
        match self {
            Self::Text(text) => text.rows(sets),
            Self::Binary(columns) => columns.rows(sets),
        }
    }
}

/// `(value - offset) factor` of each value of a column, in place.
pub fn to_scale(values: &mut [f64], offset: f64, factor: f64) {
    for value in values {
        *value = (*value - offset) * factor;
    }
}

/// Rows that a file of this length can hold: a packed file can claim any number of them.
fn most_rows(length: u64) -> u64 {
    ROWS_ALLOWANCE + ROWS_PER_BYTE * length
}

/// Estimates the rows of a table: of a text by how long the lines in its middle are; none of other formats.
pub fn estimate_rows(source: &Source) -> Option<u64> {
    const SAMPLE: u64 = 1 << 16;
    let magic = first_bytes(source).ok()?;
    let format = Format::of(&magic, source);
    let mut sample = Vec::new();
    source.reader_at(source.length().saturating_sub(SAMPLE) / 2).take(SAMPLE).read_to_end(&mut sample).ok()?;
    let lines = memchr_iter(b'\n', &sample).count() as u64;
    (format == Format::Text && TextEncoding::utf_16(&magic).is_none() && lines > 0)
        .then(|| source.length().div_ceil(sample.len() as u64) * lines)
}

/// The formats, recognised by their first bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Text,
    /// Text in gzip.
    Gzip,
    /// Text in Zstandard.
    Zstd,
    /// Text in the cells of a sheet.
    Workbook,
    Binary(BinaryFormat),
}

impl Format {
    /// The format of a source that begins with `magic`.
    fn of(magic: &[u8], source: &Source) -> Self {
        match magic {
            [0x1f, 0x8b, ..] => Self::Gzip,
            [0x28, 0xb5, 0x2f, 0xfd, ..] => Self::Zstd,
            _ => match BinaryFormat::of(magic) {
                None => Self::Text,
                Some(BinaryFormat::Npz) if is_workbook(source) => Self::Workbook,
                Some(format) => Self::Binary(format),
            },
        }
    }
}

/// The lines of a text that begins with `magic`.
fn text_lines(source: Source, format: Format, magic: &[u8], extent: Extent, expected: &str) -> Result<Lines, Error> {
    let file = source.name().to_owned();
    let failed = |e| Error::reading(&file, e, expected);
    Ok(match (format, TextEncoding::utf_16(magic), extent) {
        (Format::Text, None, Extent::Whole) => Lines::Plain(Plain::new(source)),
        (Format::Text, None, Extent::Growing) => Lines::Plain(Plain::new(source).complete().map_err(failed)?),
        (Format::Text, Some(encoding), Extent::Growing) => {
            let newline: [u8; 2] = if encoding == TextEncoding::Utf16Be { [0, b'\n'] } else { [b'\n', 0] };
            let complete = complete_lines(&source, &newline).map_err(failed)?;
            Lines::Packed(Packed::new(&file, Box::new(source.reader_at(0).take(complete)), complete))
        }
        _ => {
            let (text, length) = packed_text(&source, format, expected)?;
            Lines::Packed(Packed::new(&file, text, length))
        }
    })
}

/// The text that is packed in a source, and the length of what it is packed in.
fn packed_text(source: &Source, format: Format, expected: &str) -> Result<(Box<dyn Read + Send>, u64), Error> {
    let (whole, length) = (source.reader_at(0), source.length());
    let failed = |e| Error::reading(source.name(), e, expected);
    Ok(match format {
        Format::Gzip => (Box::new(MultiGzDecoder::new(whole)), length),
        Format::Zstd => (Box::new(zstd::Decoder::new(whole).map_err(failed)?), length),
        Format::Workbook => {
            let text = workbook_text(source)?;
            let most = length.max(text.len() as u64);
            (Box::new(io::Cursor::new(text)), most)
        }
        Format::Text | Format::Binary(_) => (Box::new(whole), length),
    })
}

/// What a table as text looks like, from its first lines: encoding, delimiter, decimal sign, lines above the header, names, units, kind
/// of stamps. Nothing of other formats, and of text that is not a table of numbers.
///
/// # Errors
/// If the file cannot be read.
pub fn text_form(file: &Path) -> Result<Option<TextForm>, Error> {
    const SAMPLE: u64 = 1 << 16;
    const EXPECTED: &str = "a table of numbers";
    let failed = |e| Error::reading(file, e, EXPECTED);
    let source = Source::open(file, EXPECTED)?;
    let format = Format::of(&first_bytes(&source).map_err(failed)?, &source);
    if matches!(format, Format::Binary(_)) {
        return Ok(None);
    }
    let (text, length) = packed_text(&source, format, EXPECTED)?;
    let unpacking = |e| Error::unpacking(file, e, EXPECTED);
    let (text, encoding) = in_utf_8(Box::new(Unpacked::new(text, length, None))).map_err(unpacking)?;
    let mut sample = Vec::new();
    text.take(SAMPLE).read_to_end(&mut sample).map_err(unpacking)?;
    if sample.len() as u64 == SAMPLE {
        sample.truncate(memrchr(b'\n', &sample).map_or(0, |end| end + 1));
    }
    Ok(TextForm::of(sample.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&sample), encoding))
}

/// The columns of a table in a binary format: by name, those of a single matrix by number. Of text nothing.
///
/// # Errors
/// If the file cannot be read, or is damaged.
pub fn binary_columns(file: &Path) -> Result<Vec<ColumnName>, Error> {
    const EXPECTED: &str = "a table of numbers";
    let source = Source::open(file, EXPECTED)?;
    let magic = first_bytes(&source).map_err(|e| Error::reading(file, e, EXPECTED))?;
    match Format::of(&magic, &source) {
        Format::Binary(format) => format.columns(&source),
        _ => Ok(Vec::new()),
    }
}

/// Whether a zip archive is a workbook.
fn is_workbook(source: &Source) -> bool {
    let archive = zip::ZipArchive::new(source.reader_at(0));
    archive.is_ok_and(|archive| archive.index_for_name("xl/workbook.xml").is_some())
}

/// The first sheet of a workbook as text.
fn workbook_text(source: &Source) -> Result<Vec<u8>, Error> {
    #[cfg(feature = "xlsx")]
    {
        let damaged = |found| Error::content(source.name(), Place::Whole, found, "a workbook (.xlsx) that is whole");
        match catch_panic(|| crate::sheet::text(source)) {
            Ok(text) => Ok(text),
            Err(Some(error)) => Err(damaged(format!("a damaged workbook ({error})"))),
            Err(None) => Err(damaged("a damaged workbook".to_owned())),
        }
    }
    #[cfg(not(feature = "xlsx"))]
    {
        let expected = "the sheet saved as text (this program was built without the feature xlsx)";
        Err(Error::content(source.name(), Place::Whole, "a workbook (.xlsx)", expected))
    }
}

/// The first bytes, by which a format is recognised.
fn first_bytes(source: &Source) -> io::Result<Vec<u8>> {
    let mut magic = Vec::new();
    source.reader_at(0).take(SIGHT as u64).read_to_end(&mut magic)?;
    Ok(magic)
}
