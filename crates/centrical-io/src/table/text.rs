//! Tables as text: CSV and its kin.
//!
//! The delimiter (`;`, tab, `,` or blanks) is told by the first line; any order of columns, more columns than
//! asked for, quoted fields, CRLF, lines starting with `#` and blank lines are welcome. Where the comma does not
//! divide the fields it is the decimal comma.

mod layout;

use std::io::Read;
use std::path::Path;

use memchr::{memchr, memrchr};

use self::layout::{Fault, Layout, Prologue};
use super::{ASCENDING, Rows};
use crate::error::{Error, Place, quoted};

/// Bytes read at a time, and so the longest line.
const CHUNK: usize = 1 << 20;

/// Reads the table of `file` from `input`.
pub(super) fn read(file: &Path, input: &mut dyn Read, rows: &mut Rows) -> Result<(), Error> {
    let mut chunks = Chunks { file, input, buffer: vec![0; CHUNK], filled: 0, used: 0, lines: 0 };
    let mut prologue = Prologue::default();
    let mut layout = None;
    let mut row = vec![0.0; rows.fields.len()];
    while !rows.is_too_long()
        && let Some(chunk) = chunks.next()?
    {
        let (mut text, mut number) = (chunk.text, chunk.first_line);
        while !text.is_empty() {
            let line;
            (line, text) = split_line(text);
            if is_data(line) {
                let fail = |fault: Fault| located(file, number, fault);
                if let Some(layout) = &layout {
                    one_row(layout, line, &mut row, rows).map_err(fail)?;
                } else {
                    let first = prologue.first_line(line, rows.fields).map_err(fail)?;
                    if !first.is_header {
                        one_row(&first.layout, line, &mut row, rows).map_err(fail)?;
                    }
                    layout = Some(first.layout);
                }
            } else if layout.is_none() {
                prologue.comment(line);
            }
            number += 1;
        }
    }
    Ok(())
}

/// Reads one row.
#[inline]
fn one_row(layout: &Layout, line: &[u8], row: &mut [f64], rows: &mut Rows) -> Result<(), Fault> {
    layout.row(line, row, rows.fields)?;
    rows.push(row).map_err(|backwards| Fault {
        column: Some(rows.fields[backwards.field].name.to_string()),
        found: backwards.found,
        expected: ASCENDING.to_owned(),
    })
}

/// A fault on a line of a file.
fn located(file: &Path, line: u64, fault: Fault) -> Error {
    Error::content(file, Place::Line { line, column: fault.column }, fault.found, fault.expected)
}

/// The first line without its end, and the rest.
#[inline]
fn split_line(text: &[u8]) -> (&[u8], &[u8]) {
    let (line, rest) = match memchr(b'\n', text) {
        Some(end) => (&text[..end], &text[end + 1..]),
        None => (text, &text[text.len()..]),
    };
    (line.strip_suffix(b"\r").unwrap_or(line), rest)
}

/// Whether a line is neither blank nor a comment.
#[inline]
fn is_data(line: &[u8]) -> bool {
    match line.first() {
        None | Some(b'#') => false,
        Some(b' ' | b'\t') => !matches!(line.trim_ascii_start().first(), None | Some(b'#')),
        Some(_) => true,
    }
}

/// A text in pieces of whole lines.
struct Chunks<'a> {
    file: &'a Path,
    input: &'a mut dyn Read,
    buffer: Vec<u8>,
    /// Bytes in the buffer, of which `used` were handed out.
    filled: usize,
    used: usize,
    /// Lines handed out.
    lines: u64,
}

/// Whole lines.
struct Chunk<'a> {
    text: &'a [u8],
    /// Number of the first line, from 1.
    first_line: u64,
}

impl Chunks<'_> {
    /// The next whole lines, or nothing at the end of the file.
    fn next(&mut self) -> Result<Option<Chunk<'_>>, Error> {
        self.buffer.copy_within(self.used..self.filled, 0);
        self.filled -= self.used;
        let at_end = self.fill()?;
        let first_line = self.lines + 1;
        self.used = match memrchr(b'\n', &self.buffer[..self.filled]) {
            _ if at_end => self.filled,
            Some(end) => end + 1,
            None => {
                let place = Place::Line { line: first_line, column: None };
                let found = format!("a line longer than {CHUNK} bytes");
                return Err(Error::content(self.file, place, found, "a table of numbers as text"));
            }
        };
        let mut text = &self.buffer[..self.used];
        check_utf8(self.file, text, first_line)?;
        self.lines += memchr::memchr_iter(b'\n', text).count() as u64;
        if first_line == 1 {
            text = text.strip_prefix("\u{feff}".as_bytes()).unwrap_or(text);
        }
        Ok((self.used > 0).then_some(Chunk { text, first_line }))
    }

    /// Fills the buffer; whether the file ended.
    fn fill(&mut self) -> Result<bool, Error> {
        while self.filled < self.buffer.len() {
            match self.input.read(&mut self.buffer[self.filled..]) {
                Ok(0) => return Ok(true),
                Ok(read) => self.filled += read,
                Err(e) if e.kind() == std::io::ErrorKind::Interrupted => {}
                Err(e) => return Err(Error::unpacking(self.file, e, "a table of numbers as text")),
            }
        }
        Ok(false)
    }
}

/// Text must be UTF-8: in any other encoding the names of columns would not be found.
fn check_utf8(file: &Path, text: &[u8], first_line: u64) -> Result<(), Error> {
    let Err(error) = std::str::from_utf8(text) else { return Ok(()) };
    let bad = error.valid_up_to();
    let line = first_line + memchr::memchr_iter(b'\n', &text[..bad]).count() as u64;
    let start = memrchr(b'\n', &text[..bad]).map_or(0, |end| end + 1);
    let found = format!("byte 0x{:02x} after {}", text[bad], quoted(&text[start..bad]));
    Err(Error::content(file, Place::Line { line, column: None }, found, "text in UTF-8"))
}
