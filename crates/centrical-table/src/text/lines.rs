//! A text in pieces of whole lines: of a plain one any piece by its number, of a packed one each after the other.

use std::io::{self, Read};
use std::ops::{Deref, Range};
use std::path::{Path, PathBuf};

use memchr::{memchr, memchr_iter, memrchr};

use super::encoding::in_utf_8;
use crate::error::Error;
use crate::source::Source;
use crate::unpacking::Unpacked;

/// Bytes in a piece, more or less a line: several make up a plateau, and each is worth the way to it.
pub(super) const SIZE: u64 = 1 << 17;

/// The longest line [bytes].
const LONGEST_LINE: usize = 1 << 20;

/// Whole lines, within bytes that were read together.
#[derive(Default)]
pub(super) struct Text {
    bytes: Vec<u8>,
    lines: Range<usize>,
}

impl Deref for Text {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        &self.bytes[self.lines.clone()]
    }
}

impl Text {
    /// Leaves out a mark of the byte order.
    fn skip_mark(&mut self) {
        let mark = "\u{feff}".as_bytes();
        if self.starts_with(mark) {
            self.lines.start += mark.len();
        }
    }
}

/// A text that comes in pieces.
pub(crate) enum Lines {
    Plain(Plain),
    Packed(Packed),
}

/// A text that is not packed. A piece has the lines that begin in its range of bytes.
pub(crate) struct Plain {
    source: Source,
    length: u64,
}

/// A text that is read from its start to its end.
pub(crate) struct Packed {
    file: PathBuf,
    input: Box<dyn Read + Send>,
    /// Whether the beginning was looked at.
    is_begun: bool,
    /// Begin of a line that goes on.
    rest: Vec<u8>,
    at_end: bool,
}

impl Plain {
    /// The text, as long as it is now.
    pub fn new(source: Source) -> Self {
        Self { length: source.length(), source }
    }

    /// The same, ending with the last complete line.
    pub fn complete(mut self) -> io::Result<Self> {
        self.length = complete_lines(&self.source, b"\n")?;
        Ok(self)
    }

    /// How many pieces there are from the one of that number on, `most` at most.
    pub(super) fn pieces_from(&self, number: u64, most: usize) -> usize {
        let left = self.length.div_ceil(SIZE).saturating_sub(number);
        usize::try_from(left).unwrap_or(usize::MAX).min(most)
    }

    /// Reads the piece of that number; any thread may read any piece.
    pub(super) fn read(&self, number: u64, text: &mut Text) -> Result<(), Error> {
        self.try_read(number, text).map_err(|e| Error::reading(self.source.name(), e, TABLE))
    }

    fn try_read(&self, number: u64, text: &mut Text) -> io::Result<()> {
        /// Where the last line most likely ends.
        const BEYOND: usize = 512;
        // The byte before: if it ends a line, the next line begins here.
        let from = (number * SIZE).saturating_sub(1);
        let size = usize::try_from(((number + 1) * SIZE).min(self.length).saturating_sub(from)).unwrap_or(0);
        let mut read = self.fill(&mut text.bytes, 0, size + BEYOND, from)?;
        let size = size.min(read);
        let begin = if number == 0 { Some(0) } else { memchr(b'\n', &text.bytes[..size]).map(|end| end + 1) };
        text.lines = 0..0;
        let Some(begin) = begin.filter(|begin| *begin < size) else { return Ok(()) };
        // The rest of the last line.
        let mut end = size;
        while text.bytes[end - 1] != b'\n' && end - size <= LONGEST_LINE {
            if let Some(line_end) = memchr(b'\n', &text.bytes[end..read]) {
                end += line_end + 1;
                break;
            }
            end = read;
            read = self.fill(&mut text.bytes, read, 2 * BEYOND.max(read - size), from)?;
            if read == end {
                break;
            }
        }
        text.lines = begin..end;
        if number == 0 {
            text.skip_mark();
        }
        Ok(())
    }

    /// Reads up to `count` more bytes behind the first `filled`, which stand at `from` in the file; how many there are then.
    fn fill(&self, bytes: &mut Vec<u8>, mut filled: usize, count: usize, from: u64) -> io::Result<usize> {
        let left = self.length.saturating_sub(from + filled as u64);
        let most = filled + usize::try_from(left).unwrap_or(usize::MAX).min(count);
        bytes.resize(bytes.len().max(most), 0);
        while filled < most {
            match self.source.read_at(&mut bytes[filled..most], from + filled as u64) {
                Ok(0) => break,
                Ok(read) => filled += read,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(filled)
    }
}

impl Packed {
    /// The text that `input` gives of a file of `length` bytes.
    pub fn new(file: &Path, input: Box<dyn Read + Send>, length: u64) -> Self {
        let input = Unpacked::new(input, length, None);
        Self { file: file.to_owned(), input: Box::new(input), is_begun: false, rest: Vec::new(), at_end: false }
    }

    /// Looks at the beginning: UTF-16 is turned into UTF-8.
    fn begin(&mut self) -> io::Result<()> {
        let input = std::mem::replace(&mut self.input, Box::new(io::empty()));
        self.input = in_utf_8(input)?.0;
        Ok(())
    }

    /// Reads the next piece, the first one without a mark of the byte order; false at the end.
    pub(super) fn read(&mut self, first: bool, text: &mut Text) -> Result<bool, Error> {
        if !std::mem::replace(&mut self.is_begun, true) {
            self.begin().map_err(|e| Error::unpacking(&self.file, e, TABLE))?;
        }
        if self.at_end && self.rest.is_empty() {
            return Ok(false);
        }
        let bytes = &mut text.bytes;
        bytes.clear();
        bytes.append(&mut self.rest);
        let mut end = None;
        while end.is_none() && !self.at_end && bytes.len() <= LONGEST_LINE {
            let before = bytes.len();
            let read = (&mut self.input).take(SIZE).read_to_end(bytes);
            let read = read.map_err(|e| Error::unpacking(&self.file, e, TABLE))?;
            self.at_end = (read as u64) < SIZE;
            end = memrchr(b'\n', &bytes[before..]).map(|end| before + end + 1);
        }
        if !self.at_end {
            self.rest.extend_from_slice(&bytes[end.unwrap_or(bytes.len())..]);
            bytes.truncate(end.unwrap_or(bytes.len()));
        }
        text.lines = 0..bytes.len();
        if first {
            text.skip_mark();
        }
        Ok(true)
    }
}

/// Bytes of a source up to the end of its last complete line, where these bytes end a line.
pub(crate) fn complete_lines(source: &Source, newline: &[u8]) -> io::Result<u64> {
    let width = newline.len() as u64;
    let (mut end, mut bytes) = (source.length() / width * width, Vec::new());
    while end > 0 {
        let start = end.saturating_sub(SIZE);
        bytes.clear();
        source.reader_at(start).take(end - start).read_to_end(&mut bytes)?;
        if let Some(last) = bytes.chunks_exact(newline.len()).rposition(|unit| unit == newline) {
            return Ok(start + width * (last as u64 + 1));
        }
        end = start;
    }
    Ok(0)
}

/// What a text is expected to be.
pub(super) const TABLE: &str = "a table of numbers as text";

/// A line with its number, from 0.
pub(super) type Line<'a> = (u64, &'a [u8]);

/// The lines of a text without their ends.
pub(super) fn numbered(text: &[u8]) -> impl Iterator<Item = Line<'_>> {
    let mut rest = text;
    let next = move || {
        let line;
        (line, rest) = if rest.is_empty() { return None } else { split_line(rest) };
        Some(line)
    };
    (0..).zip(std::iter::from_fn(next))
}

/// What the beginning of a text holds if its lines end with CR alone, as those of some old loggers do.
pub(super) fn ends_of_lines(text: &[u8]) -> Option<(u64, String)> {
    let is_alone = memchr(b'\n', text).is_none() && memchr_iter(b'\r', text).nth(1).is_some();
    is_alone.then(|| (0, "lines that end with CR alone; LF or CR LF end a line".to_owned()))
}

/// The last line, counted from 0, if it is longer than any line of a table.
pub(super) fn endless_line(text: &[u8]) -> Option<(u64, String)> {
    let start = memrchr(b'\n', &text[..text.len().saturating_sub(1)]).map_or(0, |end| end + 1);
    let line = || memchr_iter(b'\n', &text[..start]).count() as u64;
    (text.len() - start > LONGEST_LINE).then(|| (line(), format!("a line longer than {LONGEST_LINE} bytes")))
}

/// Length of the first `count` lines.
pub(super) fn before_line(text: &[u8], count: u64) -> usize {
    let last = usize::try_from(count).ok().and_then(|count| count.checked_sub(1));
    last.and_then(|last| memchr_iter(b'\n', text).nth(last)).map_or(0, |end| end + 1)
}

/// The first line without its end, and the rest.
#[inline]
pub(super) fn split_line(text: &[u8]) -> (&[u8], &[u8]) {
    let (line, rest) = match memchr(b'\n', text) {
        Some(end) => (&text[..end], &text[end + 1..]),
        None => (text, &text[text.len()..]),
    };
    (line.strip_suffix(b"\r").unwrap_or(line), rest)
}

/// Whether a line is neither blank nor a comment.
#[inline]
pub(super) fn is_data(line: &[u8]) -> bool {
    match line.first() {
        None => false,
        Some(b'#') => is_failed_cell(line),
        // A row of a spreadsheet in which nothing stands.
        Some(b';' | b',' | b'"') => !is_empty_row(line),
        Some(b' ' | b'\t') => {
            let text = line.trim_ascii_start();
            !text.is_empty() && (text[0] != b'#' || is_failed_cell(text)) && !is_empty_row(text)
        }
        Some(_) => true,
    }
}

/// Whether a line holds delimiters alone.
fn is_empty_row(line: &[u8]) -> bool {
    line.iter().all(|byte| matches!(byte, b';' | b',' | b'\t' | b' ' | b'"'))
}

/// Whether a text that starts with `#` is not a comment but a row whose first cell a spreadsheet could not compute, as its first word alone
/// shows; `Layout::is_failed_row` knows the other ones.
#[cold]
fn is_failed_cell(text: &[u8]) -> bool {
    const FAILED: [&[u8]; 8] = [b"#N/A", b"#NUM!", b"#VALUE!", b"#DIV/0!", b"#REF!", b"#NAME?", b"#NULL!", b"#CALC!"];
    let begins = |cell: &[u8]| {
        let rest = text.get(..cell.len()).filter(|start| start.eq_ignore_ascii_case(cell)).map(|_| &text[cell.len()..]);
        rest.is_some_and(|rest| rest.first().is_none_or(|next| matches!(next, b',' | b';' | b'\t' | b' ' | b'"')))
    };
    FAILED.into_iter().any(begins)
}
