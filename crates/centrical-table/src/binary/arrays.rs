//! Numbers as arrays of bytes: columns of vectors, matrices and records, wherever they lie in a file.

use std::io::{self, Read};
use std::path::Path;

use flate2::read::{DeflateDecoder, ZlibDecoder};
use lz4_flex::frame::FrameDecoder;

use super::columnar::Column;
use crate::column::{ColumnName, Field, ROWS};
use crate::error::{Error, Place, quoted};
use crate::source::Source;
use crate::stamp::TickForm;
use crate::unpacking::Unpacked;

/// Longest row of an array [bytes]: thousands of columns.
const LONGEST_ROW: u64 = 1 << 16;

/// Bytes of rows that are read at a time.
const BUFFER: usize = 1 << 20;

/// What a file without numbers should be.
const OF_NUMBERS: &str =
    "vectors or matrices of numbers (in MATLAB save -struct makes them of the fields of a structure)";

/// An array of a file: rows of numbers in columns.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Array {
    /// Its name in the file; empty for a file of one array.
    pub name: String,
    /// Where its bytes are.
    pub bytes: Bytes,
    pub rows: u64,
    /// Bytes from one row to the next.
    pub stride: u64,
    pub columns: Vec<ArrayColumn>,
    /// Names of columns of 16-bit floating point, which are not read.
    pub halves: Vec<String>,
}

/// A column of an array.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ArrayColumn {
    /// Its name in the array; empty where columns have none.
    pub name: String,
    /// Bytes before its first number.
    pub start: u64,
    pub scalar: Scalar,
}

/// Where the bytes of an array are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Bytes {
    pub packing: Packing,
    /// First byte in the file, and how many there are at most.
    pub offset: u64,
    pub length: u64,
    /// Bytes before the array, after unpacking.
    pub skip: u64,
    /// The CRC-32 of what is unpacked, where the file has it.
    pub crc_32: Option<u32>,
}

/// How bytes are packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Packing {
    Plain,
    Deflate,
    Zlib,
    /// A frame of LZ4, or of Zstandard, of bytes that are stated to be as many.
    Lz4(u64),
    Zstd(u64),
}

/// A type of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Scalar {
    pub kind: ScalarKind,
    pub size: usize,
    pub big_endian: bool,
}

/// What the bytes of a number mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ScalarKind {
    Float,
    Signed,
    Unsigned,
}

/// The wanted columns of arrays, in the order of the fields.
///
/// A name is that of an array of one column, or of a column of an array (as in `f(:,2)` where it has none); a number
/// counts the columns of the only array.
pub(super) fn columns(source: &Source, arrays: &[Array], fields: &[Field]) -> Result<Vec<Column>, Error> {
    fields.iter().map(|field| column(source, find(source.name(), arrays, field)?, field)).collect()
}

/// The columns of arrays as a field asks for them: by name, those of a single matrix by number. A single number beside longer
/// arrays, such as a sampling rate, is no column.
pub(super) fn names(source: &Source, arrays: &[Array]) -> Result<Vec<ColumnName>, Error> {
    let of_numbers = arrays.iter().filter(|array| array.has_numbers()).count();
    if of_numbers == 0 {
        return Err(Error::content(source.name(), Place::Whole, contents(arrays), OF_NUMBERS));
    }
    let of_array = |array: &Array| -> Vec<ColumnName> {
        match array.columns.as_slice() {
            [column] if column.name.is_empty() && !array.name.is_empty() => vec![ColumnName::Name(array.name.clone())],
            columns if columns.iter().all(|column| column.name.is_empty()) => match of_numbers {
                1 => (1..=columns.len()).map(ColumnName::Number).collect(),
                _ => column_names(&array.name, columns.len()),
            },
            columns => columns.iter().map(|column| ColumnName::Name(column.name.clone())).collect(),
        }
    };
    let has_rows = arrays.iter().any(|array| array.rows > 1);
    Ok(arrays.iter().filter(|array| array.rows > 1 || !has_rows).flat_map(of_array).collect())
}

/// Columns of a record or of telemetry at most.
const MOST_COLUMNS: u64 = 1000;

/// Whether a matrix lies on its side: its rows are columns of a table then, and have names as in `f(2,:)`.
pub(super) fn lies_on_side(rows: u64, columns: u64) -> bool {
    (2..=MOST_COLUMNS).contains(&rows) && columns > MOST_COLUMNS
}

/// The name of a row of a matrix, as MATLAB writes it, from 1.
pub(super) fn name_of_row(matrix: &str, number: u64) -> String {
    if matrix.is_empty() { String::new() } else { format!("{matrix}({number},:)") }
}

/// The names of the columns of a matrix, unless it is of more columns than a record or telemetry has.
pub(super) fn column_names(matrix: &str, columns: usize) -> Vec<ColumnName> {
    let columns = if columns as u64 > MOST_COLUMNS { 0 } else { columns };
    (1..=columns).map(|number| ColumnName::Name(name_in_matrix(matrix, number))).collect()
}

/// The name of a column of a matrix, as MATLAB writes it: `f(:,2)`, from 1.
fn name_in_matrix(matrix: &str, number: usize) -> String {
    format!("{matrix}(:,{number})")
}

/// A column or a row of a matrix, counted from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Line {
    Column(usize),
    Row(usize),
}

/// The matrix and the line in it of such a name; blanks between its signs do not count.
pub(super) fn matrix_of(name: &str) -> Option<(&str, Line)> {
    let (matrix, place) = name.trim_end().strip_suffix(')')?.rsplit_once('(')?;
    let (row, column) = place.split_once(',')?;
    let line = match (row.trim(), column.trim()) {
        (":", number) => Line::Column(number.parse().ok()?),
        (number, ":") => Line::Row(number.parse().ok()?),
        _ => return None,
    };
    Some((matrix.trim_end(), line))
}

/// The array and the column in it that a field asks for.
fn find<'a>(file: &Path, arrays: &'a [Array], field: &Field) -> Result<(&'a Array, &'a ArrayColumn), Error> {
    let wrong = |found: String, expected: &str| {
        Err(Error::content(file, Place::Column(field.name.to_string()), found, expected))
    };
    let half = || wrong("numbers of 16 bits (float16)".to_owned(), "numbers of 32 or 64 bits");
    let of_numbers: Vec<&Array> = arrays.iter().filter(|array| array.has_numbers()).collect();
    match &field.name {
        ColumnName::Name(name) => {
            let in_matrix = matrix_of(name);
            let places = |array: &'a Array| {
                let is_whole = array.name == *name && array.columns.len() == 1;
                array.columns.iter().zip(1..).filter_map(move |(column, number)| {
                    let is_in_matrix =
                        column.name.is_empty() && in_matrix == Some((&*array.name, Line::Column(number)));
                    (is_whole || column.name == *name || is_in_matrix).then_some((array, column))
                })
            };
            let mut places = arrays.iter().flat_map(places);
            let is_half = |array: &Array| {
                let names = [&**name, in_matrix.map_or("", |(matrix, _)| matrix), ""];
                let is_asked = names.contains(&&*array.name);
                array.halves.iter().any(|half| half == name || half.is_empty() && is_asked)
            };
            match (places.next(), places.next()) {
                (Some(place), None) => Ok(place),
                (None, _) if arrays.iter().any(is_half) => half(),
                (None, _) if of_numbers.is_empty() => wrong(contents(arrays), OF_NUMBERS),
                (None, _) if of_numbers.len() > 1 => wrong(contents(arrays), "a column of this name"),
                (None, _) => wrong(contents(arrays), "a column of this name (for a matrix give [columns] by number)"),
                _ => wrong(format!("two such columns in {}", contents(arrays)), "one"),
            }
        }
        ColumnName::Number(number) => match of_numbers.as_slice() {
            [array] if array.columns.is_empty() && !array.halves.is_empty() => half(),
            [array] => number
                .checked_sub(1)
                .and_then(|i| Some((*array, array.columns.get(i)?)))
                .map_or_else(|| wrong(format!("{} columns", array.columns.len()), "that many columns"), Ok),
            _ => wrong(contents(arrays), "one array, or [columns] by name"),
        },
        ColumnName::Row | ColumnName::DateAndTime(_) => {
            wrong("no such column".to_owned(), "a column by name or number")
        }
    }
}

/// The contents of the file, for messages.
fn contents(arrays: &[Array]) -> String {
    let of_numbers = arrays.iter().filter(|array| array.has_numbers()).count();
    let named = |array: &Array| match array.columns.as_slice() {
        [] => format!("{} (no numbers)", array.name),
        [column] if column.name.is_empty() => array.name.clone(),
        columns if columns.iter().all(|c| c.name.is_empty()) => match of_numbers {
            1 => format!("{} ({} x {})", array.name, array.rows, columns.len()),
            _ => [1, columns.len()].map(|n| name_in_matrix(&array.name, n)).join(" to "),
        },
        columns => columns.iter().map(|c| c.name.as_str()).collect::<Vec<_>>().join(", "),
    };
    format!("columns {}", quoted(arrays.iter().map(named).collect::<Vec<_>>().join(", ").trim().as_bytes()))
}

/// A reader of one column of numbers.
pub(super) fn column(source: &Source, of: (&Array, &ArrayColumn), field: &Field) -> Result<Column, Error> {
    let scalar = of.1.scalar;
    let mut next = next_bytes(source, of, field)?;
    Ok(Column::Numbers(Box::new(move |values| {
        next(&mut |stride, bytes| values.extend(bytes.chunks(stride).map(|row| scalar.read(&row[..scalar.size]))))
    })))
}

/// A reader of one column of stamps, dates or times of the day, which are integers: how they are counted, and ticks that one stands for.
pub(super) fn stamps(
    source: &Source,
    of: (&Array, &ArrayColumn),
    field: &Field,
    (form, each): (TickForm, i64),
) -> Result<Column, Error> {
    let (scalar, unit) = (of.1.scalar, form.unit.seconds());
    let mut next = next_bytes(source, of, field)?;
    Ok(Column::Stamps(
        form,
        Box::new(move |values, ticks| {
            let begin = ticks.len();
            next(&mut |stride, bytes| {
                ticks.extend(bytes.chunks(stride).map(|row| scalar.integer(&row[..scalar.size]).saturating_mul(each)));
            })?;
            values.extend(ticks[begin..].iter().map(|ticks| *ticks as f64 * unit));
            Ok(())
        }),
    ))
}

/// Takes rows of bytes, and how many a row has; the last row may have fewer.
type TakeBytes<'a> = &'a mut dyn FnMut(usize, &[u8]);

/// Hands out the next rows of a column, [`ROWS`] at most, from the first byte of each number on.
fn next_bytes(
    source: &Source,
    (array, place): (&Array, &ArrayColumn),
    field: &Field,
) -> Result<impl FnMut(TakeBytes) -> Result<(), Error> + Send + use<>, Error> {
    let (name, path) = (Place::Column(field.name.to_string()), source.name().to_owned());
    let failed = move |e: io::Error| {
        let expected = "an array as long as it says";
        match e.kind() {
            io::ErrorKind::NotFound | io::ErrorKind::PermissionDenied => Error::reading(&path, e, expected),
            _ => Error::content(&path, name.clone(), format!("a damaged array ({e})"), expected),
        }
    };
    let (scalar, mut left) = (place.scalar, array.rows);
    let stride = usize::try_from(array.stride.min(LONGEST_ROW)).unwrap_or(usize::MAX);
    if array.stride > LONGEST_ROW || scalar.size > stride {
        return Err(failed(io::Error::other(format!("{} bytes a row", array.stride))));
    }
    let mut input = array.bytes.open(source, place.start).map_err(&failed)?;
    let has_checksum = array.bytes.packing != Packing::Plain || array.bytes.crc_32.is_some();
    let at_a_time = (BUFFER / stride.max(1)).max(1) as u64;
    let mut buffer = Vec::new();
    Ok(move |take: TakeBytes| {
        let mut wanted = left.min(ROWS as u64);
        while wanted > 0 {
            let rows = wanted.min(at_a_time);
            (wanted, left) = (wanted - rows, left - rows);
            // The last row ends with its number, not with its stride.
            let unused = if left == 0 { stride - scalar.size } else { 0 };
            buffer.resize(usize::try_from(rows).unwrap_or(ROWS) * stride - unused, 0);
            input.read_exact(&mut buffer).map_err(&failed)?;
            take(stride, &buffer);
        }
        if left == 0 && has_checksum {
            // A checksum is that of all bytes, and stands at their end.
            io::copy(&mut input, &mut io::sink()).map_err(&failed)?;
        }
        Ok(())
    })
}

impl Array {
    /// Whether it has columns, be they of numbers that are not read.
    fn has_numbers(&self) -> bool {
        !self.columns.is_empty() || !self.halves.is_empty()
    }
}

impl Packing {
    /// How many bytes are stated to be packed.
    fn unpacked(self) -> Option<u64> {
        match self {
            Self::Lz4(stated) | Self::Zstd(stated) => Some(stated),
            Self::Plain | Self::Deflate | Self::Zlib => None,
        }
    }
}

impl Bytes {
    /// The bytes of the array from `start` on.
    pub fn open(&self, source: &Source, start: u64) -> io::Result<Box<dyn Read + Send>> {
        let input = io::BufReader::with_capacity(1 << 16, source.reader_at(self.offset).take(self.length));
        let mut unpacked: Box<dyn Read + Send> = match self.packing {
            Packing::Plain => Box::new(input),
            Packing::Deflate => Box::new(DeflateDecoder::new(input)),
            Packing::Zlib => Box::new(ZlibDecoder::new(input)),
            Packing::Lz4(_) => Box::new(FrameDecoder::new(input)),
            Packing::Zstd(_) => Box::new(zstd::Decoder::with_buffer(input)?),
        };
        if self.packing != Packing::Plain || self.crc_32.is_some() {
            unpacked = Box::new(Unpacked::new(unpacked, self.length, self.crc_32).holding(self.packing.unpacked()));
        }
        let skip = self.skip.saturating_add(start);
        if io::copy(&mut unpacked.by_ref().take(skip), &mut io::sink())? < skip {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        Ok(unpacked)
    }
}

impl Scalar {
    /// A type of numbers; nothing where no number has that size.
    pub fn new(kind: ScalarKind, size: usize, big_endian: bool) -> Option<Self> {
        let known = matches!(size, 4 | 8) || (matches!(size, 1 | 2) && kind != ScalarKind::Float);
        known.then_some(Self { kind, size, big_endian })
    }

    /// The first bytes, as many as its size, the lowest first.
    fn low_bytes(self, bytes: &[u8]) -> [u8; 8] {
        let mut low = [0; 8];
        low[..self.size].copy_from_slice(&bytes[..self.size]);
        if self.big_endian {
            low[..self.size].reverse();
        }
        low
    }

    /// The integer with a sign in the first bytes, as many as its size.
    fn integer(self, bytes: &[u8]) -> i64 {
        let unused = 64 - 8 * self.size;
        // Up and down again fills the upper bytes with the sign.
        i64::from_le_bytes(self.low_bytes(bytes)) << unused >> unused
    }

    /// The number in the first bytes, as many as its size.
    pub fn read(self, bytes: &[u8]) -> f64 {
        let low = self.low_bytes(bytes);
        let bits = u64::from_le_bytes(low);
        match self.kind {
            ScalarKind::Float if self.size == 8 => f64::from_bits(bits),
            ScalarKind::Float => f64::from(f32::from_le_bytes([low[0], low[1], low[2], low[3]])),
            ScalarKind::Signed => self.integer(bytes) as f64,
            ScalarKind::Unsigned => bits as f64,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_of_a_matrix_have_names() {
        for name in ["f(:,2)", "f(:, 2)", "f (:,2) "] {
            assert_eq!(matrix_of(name), Some(("f", Line::Column(2))), "{name}");
        }
        assert_eq!(matrix_of("f(2,:)"), Some(("f", Line::Row(2))));
        for name in ["f", "f(2)", "f(:,:)", "f(1,2)", "f(:,x)", "f(:,2", "acc [g]"] {
            assert_eq!(matrix_of(name), None, "{name}");
        }
        let scalar = Scalar { kind: ScalarKind::Float, size: 8, big_endian: false };
        let bytes = Bytes { packing: Packing::Plain, offset: 0, length: 0, skip: 0, crc_32: None };
        let array = |name: &str, rows, columns| {
            let place = |start| ArrayColumn { name: String::new(), start, scalar };
            let columns = (0..columns).map(place).collect();
            Array { name: name.to_owned(), bytes, rows, stride: 8, columns, halves: Vec::new() }
        };
        let arrays = [array("fs", 1, 1), array("t", 9, 1), array("f", 9, 3)];
        let names = |arrays: &[Array]| -> Vec<String> {
            let file = Source::in_memory(Path::new("a.mat"), bytes::Bytes::new());
            super::names(&file, arrays).unwrap().iter().map(ToString::to_string).collect()
        };
        assert_eq!(names(&arrays), ["t", "f(:,1)", "f(:,2)", "f(:,3)"]);
        assert_eq!(contents(&arrays), "columns \"fs, t, f(:,1) to f(:,3)\"");
        let start = |arrays: &[Array], name: &str| {
            let name = ColumnName::Name(name.to_owned());
            let field = Field { name, expected: String::new(), rule: crate::column::Rule::Any };
            find(Path::new("a.mat"), arrays, &field).map(|(_, column)| column.start).ok()
        };
        assert_eq!(["f(:,1)", "f(:,3)", "t(:,1)"].map(|name| start(&arrays, name)), [Some(0), Some(2), Some(0)]);
        assert_eq!(["f", "f(:,0)", "f(:,4)", "g(:,1)"].map(|name| start(&arrays, name)), [None; 4]);
        // A matrix alone has numbers, and these names too.
        assert_eq!(names(&arrays[2..]), ["column 1", "column 2", "column 3"]);
        assert_eq!(start(&arrays[2..], "f(:,2)"), Some(1));
    }
}
