//! Tables in, whatever the format: chosen columns, row by row, in batches of bounded size.
//!
//! The first bytes of the file show its format, not its name.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use flate2::read::MultiGzDecoder;
use memchr::{memchr_iter, memrchr};

#[cfg(feature = "xlsx")]
use crate::binary::catch_panic;
use crate::binary::{BinaryFormat, ColumnReader};
use crate::column::{Field, TableLines, UnitsFound};
use crate::document::open_regular;
use crate::error::{Error, Place};
use crate::rows::{RowNumber, Rows};
use crate::stamp::Stamps;
use crate::text::{FromUtf16, Index, Lines, Packed, Plain, SIGHT, TextEncoding, TextForm, TextReader};
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
    source: Source,
    row_number: RowNumber,
    /// Rows that were handed out, and sets of rows in the last batch.
    count: u64,
    batch: usize,
}

enum Source {
    Text(Box<TextReader>),
    Binary(ColumnReader),
}

impl TableReader {
    /// Opens `file`, which should be what `expected` says, to read `fields`.
    ///
    /// # Errors
    /// If it cannot be read, or a binary table lacks a column.
    pub fn open(file: &Path, extent: Extent, fields: &[Field], expected: &str) -> Result<Self, Error> {
        Self::open_at(file, extent, fields, expected, TableLines::default())
    }

    /// The same of a text whose header or first row stands in a line that is known.
    ///
    /// # Errors
    /// As [`TableReader::open`].
    pub fn open_at(
        file: &Path,
        extent: Extent,
        fields: &[Field],
        expected: &str,
        lines: TableLines,
    ) -> Result<Self, Error> {
        let said = lines;
        let failed = |e| Error::reading(file, e, expected);
        let mut input = open_regular(file, expected)?;
        let length = input.metadata().map_err(failed)?.len();
        let magic = first_bytes(&mut input, SIGHT).map_err(failed)?;
        if magic.is_empty() {
            return Err(Error::content(file, Place::Whole, "an empty file", expected));
        }
        let mut fields = fields.to_vec();
        let row_number = RowNumber::take_out(&mut fields);
        let source = match Format::of(&magic) {
            Format::Binary(BinaryFormat::Npz) if is_workbook(&mut input) => {
                let text = workbook_text(file, input)?;
                let most = length.max(text.len() as u64);
                let lines = Lines::Packed(Packed::new(file, io::Cursor::new(text), most));
                Source::Text(Box::new(TextReader::new(file, lines, fields, said)))
            }
            Format::Binary(format) => Source::Binary(format.open(file, input, fields, most_rows(length))?),
            format => {
                let utf_16 = TextEncoding::utf_16(&magic).filter(|_| format == Format::Text);
                let lines = match (format, extent) {
                    _ if utf_16.is_some() => Lines::Packed(utf_16_lines(file, input, utf_16, extent).map_err(failed)?),
                    (Format::Gzip, _) => Lines::Packed(Packed::new(file, MultiGzDecoder::new(input), length)),
                    (Format::Zstd, _) => {
                        Lines::Packed(Packed::new(file, zstd::Decoder::new(input).map_err(failed)?, length))
                    }
                    (_, Extent::Whole) => Lines::Plain(Plain::new(file, input).map_err(failed)?),
                    (_, Extent::Growing) => {
                        Lines::Plain(Plain::new(file, input).and_then(Plain::complete).map_err(failed)?)
                    }
                };
                Source::Text(Box::new(TextReader::new(file, lines, fields, said)))
            }
        };
        let (file, expected) = (file.to_owned(), expected.to_owned());
        Ok(Self { file, expected, length, bytes: 0, source, row_number, count: 0, batch: 0 })
    }

    /// The next rows, several sets of them so that they may be worked on in parallel; none at the end. They belong to the
    /// caller until the next call.
    ///
    /// # Errors
    /// If the file cannot be read, has no rows, lacks a column, or a value is not what its field asks for.
    pub fn next_batch(&mut self) -> Result<Option<&mut [Rows]>, Error> {
        self.row_number.remove(self.source.rows(std::mem::take(&mut self.batch)));
        let read = match &mut self.source {
            Source::Text(text) => text.read()?,
            Source::Binary(columns) => Some((columns.read()?, 0)).filter(|(sets, _)| *sets > 0),
        };
        let Some((sets, bytes)) = read else {
            self.bytes = self.length;
            return if self.count == 0 { Err(self.refuse("a table without rows".to_owned())) } else { Ok(None) };
        };
        self.bytes += bytes;
        self.batch = sets;
        for rows in self.source.rows(sets) {
            let first = self.count;
            self.count += rows[0].len() as u64;
            self.row_number.put(first, rows);
        }
        let most = most_rows(self.length);
        if self.count > most {
            let found = format!("a file of {} bytes that unpacks to more than {most} rows", self.length);
            return Err(self.refuse(found));
        }
        Ok(Some(self.source.rows(sets)))
    }

    /// The rows that were read last, once more.
    pub fn batch(&mut self) -> &mut [Rows] {
        self.source.rows(self.batch)
    }

    /// Keeps stamps in the first field as they are read, for [`TableReader::take_stamps`].
    pub fn keep_stamps(&mut self) {
        match &mut self.source {
            Source::Text(text) => text.keep_stamps(),
            Source::Binary(columns) => columns.keep_stamps(),
        }
    }

    /// The stamps of the rows that were read last, for each set of them; none where the field is of numbers.
    pub fn take_stamps(&mut self) -> Vec<Stamps> {
        match &mut self.source {
            Source::Text(text) => text.take_stamps(self.batch),
            Source::Binary(columns) => columns.take_stamps(self.batch),
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
        let Source::Text(text) = &self.source else { return None };
        Some(self.row_number.in_all(text.units()?.clone()))
    }

    /// After the end: where the rows are, so that any part can be read again; only of a text that is not packed.
    pub fn into_index(self) -> Option<Index> {
        match self.source {
            Source::Text(text) => text.into_index(self.row_number),
            Source::Binary(_) => None,
        }
    }
}

impl Source {
    /// The rows that were read last.
    fn rows(&mut self, sets: usize) -> &mut [Rows] {
        match self {
            Self::Text(text) => text.rows(sets),
            Self::Binary(columns) => columns.rows(sets),
        }
    }
}

/// Rows that a file of this length can hold: a packed file can claim any number of them.
fn most_rows(length: u64) -> u64 {
    ROWS_ALLOWANCE + ROWS_PER_BYTE * length
}

/// Estimates the rows of a table: of a text by how long the lines in its middle are; none of other formats.
pub fn estimate_rows(file: &Path) -> Option<u64> {
    const SAMPLE: u64 = 1 << 16;
    let mut input = open_regular(file, "a table of numbers").ok()?;
    let bytes = input.metadata().ok()?.len();
    let magic = first_bytes(&mut input, SIGHT).ok()?;
    let format = Format::of(&magic);
    let mut sample = Vec::new();
    input.seek(SeekFrom::Start(bytes.saturating_sub(SAMPLE) / 2)).ok()?;
    input.take(SAMPLE).read_to_end(&mut sample).ok()?;
    let lines = memchr_iter(b'\n', &sample).count() as u64;
    (format == Format::Text && TextEncoding::utf_16(&magic).is_none() && lines > 0)
        .then(|| bytes.div_ceil(sample.len() as u64) * lines)
}

/// The formats, recognised by their first bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Text,
    /// Text in gzip.
    Gzip,
    /// Text in Zstandard.
    Zstd,
    Binary(BinaryFormat),
}

impl Format {
    fn of(magic: &[u8]) -> Self {
        match magic {
            [0x1f, 0x8b, ..] => Self::Gzip,
            [0x28, 0xb5, 0x2f, 0xfd, ..] => Self::Zstd,
            _ => BinaryFormat::of(magic).map_or(Self::Text, Self::Binary),
        }
    }
}

/// What a table as text looks like, from its first lines: encoding, delimiter, decimal sign, lines above the header, names, units, kind
/// of stamps. Nothing of other formats, and of text that is no table of numbers.
///
/// # Errors
/// If the file cannot be read.
pub fn text_form(file: &Path) -> Result<Option<TextForm>, Error> {
    const SAMPLE: u64 = 1 << 16;
    const EXPECTED: &str = "a table of numbers";
    let failed = |e| Error::reading(file, e, EXPECTED);
    let mut input = open_regular(file, EXPECTED)?;
    let length = input.metadata().map_err(failed)?.len();
    let text: Box<dyn Read> = match Format::of(&first_bytes(&mut input, SIGHT).map_err(failed)?) {
        Format::Text => Box::new(input),
        Format::Gzip => Box::new(Unpacked::new(MultiGzDecoder::new(input), length, None)),
        Format::Zstd => Box::new(Unpacked::new(zstd::Decoder::new(input).map_err(failed)?, length, None)),
        Format::Binary(BinaryFormat::Npz) if is_workbook(&mut input) => {
            Box::new(io::Cursor::new(workbook_text(file, input)?))
        }
        Format::Binary(_) => return Ok(None),
    };
    let mut sample = Vec::new();
    text.take(SAMPLE).read_to_end(&mut sample).map_err(|e| Error::unpacking(file, e, EXPECTED))?;
    let is_cut = sample.len() as u64 == SAMPLE;
    let encoding = TextEncoding::utf_16(&sample[..sample.len().min(SIGHT)]);
    if let Some(encoding) = encoding {
        let mut text = Vec::new();
        FromUtf16::new(sample.as_slice(), encoding).read_to_end(&mut text).map_err(failed)?;
        sample = text;
    }
    if is_cut {
        sample.truncate(memrchr(b'\n', &sample).map_or(0, |end| end + 1));
    }
    Ok(TextForm::of(sample.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&sample), encoding))
}

/// Whether a zip archive is a workbook. The file is at its start then.
fn is_workbook(input: &mut File) -> bool {
    let is = zip::ZipArchive::new(&*input).is_ok_and(|archive| archive.index_for_name("xl/workbook.xml").is_some());
    input.rewind().is_ok() && is
}

/// The first sheet of a workbook as text.
fn workbook_text(file: &Path, input: File) -> Result<Vec<u8>, Error> {
    #[cfg(feature = "xlsx")]
    {
        let damaged = |found| Error::content(file, Place::Whole, found, "a workbook (.xlsx) that is whole");
        match catch_panic(|| crate::sheet::text(input)) {
            Ok(text) => Ok(text),
            Err(Some(error)) => Err(damaged(format!("a damaged workbook ({error})"))),
            Err(None) => Err(damaged("a damaged workbook".to_owned())),
        }
    }
    #[cfg(not(feature = "xlsx"))]
    {
        drop(input);
        let expected = "the sheet saved as text (this program was built without the feature xlsx)";
        Err(Error::content(file, Place::Whole, "a workbook (.xlsx)", expected))
    }
}

/// A text in UTF-16, from its start to its end or to that of the last complete line.
fn utf_16_lines(file: &Path, mut input: File, encoding: Option<TextEncoding>, extent: Extent) -> io::Result<Packed> {
    let length = match (encoding, extent) {
        (Some(encoding), Extent::Growing) => complete_lines(&mut input, encoding)?,
        _ => input.metadata()?.len(),
    };
    Ok(Packed::new(file, input.take(length), length))
}

/// Bytes up to the end of the last complete line of a text in UTF-16, leaving the file at its start.
fn complete_lines(input: &mut File, encoding: TextEncoding) -> io::Result<u64> {
    const PIECE: u64 = 1 << 16;
    let newline: [u8; 2] = if encoding == TextEncoding::Utf16Be { [0, b'\n'] } else { [b'\n', 0] };
    let (mut end, mut bytes) = (input.metadata()?.len() & !1, Vec::new());
    while end > 0 {
        let start = end.saturating_sub(PIECE);
        input.seek(SeekFrom::Start(start))?;
        bytes.clear();
        input.take(end - start).read_to_end(&mut bytes)?;
        if let Some(last) = bytes.as_chunks().0.iter().rposition(|unit| *unit == newline) {
            end = start + 2 * (last as u64 + 1);
            break;
        }
        end = start;
    }
    input.rewind()?;
    Ok(end)
}

/// The first bytes, `most` of them, leaving the file at its start.
fn first_bytes(input: &mut File, most: usize) -> io::Result<Vec<u8>> {
    let mut magic = Vec::new();
    input.take(most as u64).read_to_end(&mut magic)?;
    input.rewind()?;
    Ok(magic)
}
