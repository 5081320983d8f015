//! A text in pieces of whole lines: of a file any piece by its number, of a packed one each after the other.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use memchr::{memchr, memchr_iter, memrchr};

use super::Piece;
use crate::error::{Error, quoted};

/// Bytes in a piece, more or less a line: several make up a plateau, and each is worth the way to it.
pub(super) const SIZE: u64 = 1 << 17;

/// The longest line [bytes].
const LONGEST_LINE: usize = 1 << 20;

/// A text that comes in pieces.
pub(in crate::table) trait Lines {
    /// Fills pieces from the one of that number on, or leaves it to whoever has use for them; how many there are.
    fn fill(&mut self, number: u64, pieces: &mut [Piece]) -> Result<usize, Error>;

    /// Who fills the pieces that were left, each for itself and in any order.
    fn any_piece(&self) -> Option<&Plain> {
        None
    }
}

/// A text in an ordinary file. A piece has the lines that begin in its range of bytes.
pub(in crate::table) struct Plain {
    file: PathBuf,
    input: File,
    length: u64,
}

/// A text that is read from its start to its end.
pub(in crate::table) struct Packed<'a> {
    file: &'a Path,
    input: Box<dyn Read + 'a>,
    /// Begin of a line that goes on.
    rest: Vec<u8>,
    at_end: bool,
}

impl Plain {
    /// Opens a file, as long as it is now.
    pub fn open(file: &Path) -> io::Result<Self> {
        let input = File::open(file)?;
        let length = input.metadata()?.len();
        Ok(Self { file: file.to_owned(), input, length })
    }

    /// The same, ending after so many bytes.
    pub fn up_to(mut self, length: u64) -> Self {
        self.length = length;
        self
    }

    /// Fills the piece of that number, with the file opened for it alone.
    pub(super) fn fill_alone(&self, number: u64, piece: &mut Piece) -> Result<(), Error> {
        let read = Self::open(&self.file).and_then(|file| file.up_to(self.length).read(number, &mut piece.text));
        read.map_err(|e| Error::reading(&self.file, e, TABLE))
    }

    /// Reads the piece of that number into `text`, without a mark of the byte order.
    pub(super) fn read(&mut self, number: u64, text: &mut Vec<u8>) -> io::Result<()> {
        text.clear();
        let end = ((number + 1) * SIZE).min(self.length);
        let Some(begin) = self.first_line(number * SIZE, end)? else { return Ok(()) };
        self.input.seek(SeekFrom::Start(begin))?;
        (&mut self.input).take(end - begin).read_to_end(text)?;
        if text.last() != Some(&b'\n') {
            self.complete(begin + text.len() as u64, text)?;
        }
        let mark = "\u{feff}".as_bytes();
        if number == 0 && text.starts_with(mark) {
            text.drain(..mark.len());
        }
        Ok(())
    }

    /// Where the first line begins from `begin` on, if one does before `end`.
    fn first_line(&mut self, begin: u64, end: u64) -> io::Result<Option<u64>> {
        const STEP: u64 = 256;
        // The byte before: if it ends a line, the next line begins here.
        let Some(mut at) = begin.checked_sub(1) else { return Ok(Some(0)) };
        self.input.seek(SeekFrom::Start(at))?;
        let mut step = Vec::new();
        while at < end {
            step.clear();
            (&mut self.input).take(STEP.min(end - at)).read_to_end(&mut step)?;
            if let Some(end_of_line) = memchr(b'\n', &step) {
                let begin = at + end_of_line as u64 + 1;
                return Ok(Some(begin).filter(|begin| *begin < end));
            }
            if step.is_empty() {
                break;
            }
            at += step.len() as u64;
        }
        Ok(None)
    }

    /// Adds the rest of the last line.
    fn complete(&mut self, mut from: u64, text: &mut Vec<u8>) -> io::Result<()> {
        const STEP: u64 = 4096;
        let line = text.len();
        while from < self.length && text.len() - line <= LONGEST_LINE {
            let before = text.len();
            (&mut self.input).take(STEP.min(self.length - from)).read_to_end(text)?;
            if text.len() == before {
                break;
            }
            from += (text.len() - before) as u64;
            if let Some(end) = memchr(b'\n', &text[before..]) {
                text.truncate(before + end + 1);
                break;
            }
        }
        Ok(())
    }
}

impl Lines for Plain {
    fn fill(&mut self, number: u64, pieces: &mut [Piece]) -> Result<usize, Error> {
        let left = self.length.div_ceil(SIZE).saturating_sub(number);
        Ok(usize::try_from(left).unwrap_or(usize::MAX).min(pieces.len()))
    }

    fn any_piece(&self) -> Option<&Plain> {
        Some(self)
    }
}

impl<'a> Packed<'a> {
    /// The text that `input` gives.
    pub fn new(file: &'a Path, input: impl Read + 'a) -> Self {
        Self { file, input: Box::new(input), rest: Vec::new(), at_end: false }
    }

    fn read(&mut self, first: bool, text: &mut Vec<u8>) -> Result<(), Error> {
        text.clear();
        text.append(&mut self.rest);
        let mut end = None;
        while end.is_none() && !self.at_end && text.len() <= LONGEST_LINE {
            let before = text.len();
            let read = (&mut self.input).take(SIZE).read_to_end(text);
            let read = read.map_err(|e| Error::unpacking(self.file, e, TABLE))?;
            self.at_end = (read as u64) < SIZE;
            end = memrchr(b'\n', &text[before..]).map(|end| before + end + 1);
        }
        if !self.at_end {
            self.rest.extend_from_slice(&text[end.unwrap_or(text.len())..]);
            text.truncate(end.unwrap_or(text.len()));
        }
        let mark = "\u{feff}".as_bytes();
        if first && text.starts_with(mark) {
            text.drain(..mark.len());
        }
        Ok(())
    }
}

impl Lines for Packed<'_> {
    fn fill(&mut self, number: u64, pieces: &mut [Piece]) -> Result<usize, Error> {
        let mut count = 0;
        while count < pieces.len() && !(self.at_end && self.rest.is_empty()) {
            self.read(number == 0 && count == 0, &mut pieces[count].text)?;
            count += 1;
        }
        Ok(count)
    }
}

/// What a text is expected to be.
pub(super) const TABLE: &str = "a table of numbers as text";

/// The last line, counted from 0, if it goes on and on: what has such lines is no table.
pub(super) fn endless_line(text: &[u8]) -> Option<(u64, String)> {
    let start = memrchr(b'\n', &text[..text.len().saturating_sub(1)]).map_or(0, |end| end + 1);
    let line = || memchr_iter(b'\n', &text[..start]).count() as u64;
    (text.len() - start > LONGEST_LINE).then(|| (line(), format!("a line longer than {LONGEST_LINE} bytes")))
}

/// Text must be UTF-8: in any other encoding the names of columns would not be found. Of text that is not: the line,
/// counted from 0, and what was found there.
pub(super) fn check_utf8(text: &[u8]) -> Result<(), (u64, Option<String>, String)> {
    let Err(error) = std::str::from_utf8(text) else { return Ok(()) };
    let bad = error.valid_up_to();
    let line = memchr_iter(b'\n', &text[..bad]).count() as u64;
    let start = memrchr(b'\n', &text[..bad]).map_or(0, |end| end + 1);
    Err((line, None, format!("byte 0x{:02x} after {}", text[bad], quoted(&text[start..bad]))))
}

/// Length of the first `count` lines.
pub(super) fn before_line(text: &[u8], count: u64) -> usize {
    let last = usize::try_from(count).ok().and_then(|count| count.checked_sub(1));
    last.and_then(|last| memchr_iter(b'\n', text).nth(last)).map_or(0, |end| end + 1)
}
