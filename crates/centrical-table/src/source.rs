//! The one door by which files are read: a source is a file, or bytes in memory that stand for one.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::Arc;

use bytes::Bytes;

use crate::error::{Error, Place};

/// A regular file, or bytes in memory: read from any place by any number of readers at a time.
#[derive(Debug, Clone)]
pub struct Source {
    name: Arc<Path>,
    origin: Origin,
    length: u64,
}

#[derive(Debug, Clone)]
enum Origin {
    File(Arc<File>),
    Memory(Bytes),
}

impl Source {
    /// Opens a regular file, which should be what `expected` says: a pipe or a device could keep the reader for ever.
    ///
    /// # Errors
    /// [`Error`] if it is not there, is anything else, or may not be read.
    pub fn open(file: &Path, expected: &str) -> Result<Self, Error> {
        let failed = |e| Error::reading(file, e, expected);
        let kind = std::fs::metadata(file).map_err(failed)?.file_type();
        if !kind.is_file() {
            let found = if kind.is_dir() { "a folder" } else { "a path that is not a regular file" };
            return Err(Error::content(file, Place::Whole, found, expected));
        }
        let input = File::open(file).map_err(failed)?;
        let length = input.metadata().map_err(failed)?.len();
        // A file of the kernel's has no length, whatever can be read from it.
        if length == 0 && file_at(&input, &mut [0], 0).map_err(failed)? > 0 {
            return Err(Error::content(file, Place::Whole, "a file without a length", expected));
        }
        Ok(Self { name: file.into(), origin: Origin::File(Arc::new(input)), length })
    }

    /// Bytes in memory, which messages name like a file.
    pub fn in_memory(name: &Path, bytes: Bytes) -> Self {
        Self { name: name.into(), length: bytes.len() as u64, origin: Origin::Memory(bytes) }
    }

    /// The path of the file, or the name of the bytes, for messages.
    pub fn name(&self) -> &Path {
        &self.name
    }

    /// Length [bytes]; of a file as it was when it was opened.
    pub fn length(&self) -> u64 {
        self.length
    }

    /// Reads bytes at a place, wherever others read: how many, none at the end.
    ///
    /// # Errors
    /// If the operating system refuses.
    pub fn read_at(&self, bytes: &mut [u8], place: u64) -> io::Result<usize> {
        let left = usize::try_from(self.length.saturating_sub(place)).unwrap_or(usize::MAX);
        let count = bytes.len().min(left);
        match &self.origin {
            Origin::File(file) => file_at(file, &mut bytes[..count], place),
            Origin::Memory(_) if count == 0 => Ok(0),
            Origin::Memory(whole) => {
                let from = whole.len() - left;
                bytes[..count].copy_from_slice(&whole[from..from + count]);
                Ok(count)
            }
        }
    }

    /// A reader that begins at a place.
    pub fn reader_at(&self, place: u64) -> SourceReader {
        SourceReader { source: self.clone(), place }
    }

    /// All bytes, `most` at most, of what should be what `expected` says.
    ///
    /// # Errors
    /// [`Error`] if there are more, or the operating system refuses.
    pub fn bytes(&self, most: u64, expected: &str) -> Result<Vec<u8>, Error> {
        if self.length > most {
            return Err(Error::content(&self.name, Place::Whole, format!("more than {most} bytes"), expected));
        }
        let mut bytes = Vec::new();
        self.reader_at(0).read_to_end(&mut bytes).map_err(|e| Error::reading(&self.name, e, expected))?;
        Ok(bytes)
    }

    /// The same as text.
    ///
    /// # Errors
    /// As [`Source::bytes`]; and if it is not text in UTF-8.
    pub fn text(&self, most: u64, expected: &str) -> Result<String, Error> {
        String::from_utf8(self.bytes(most, expected)?).map_err(|error| {
            let bad = error.utf8_error().valid_up_to();
            let line = 1 + memchr::memchr_iter(b'\n', &error.as_bytes()[..bad]).count() as u64;
            let found = format!("byte 0x{:02x}", error.as_bytes()[bad]);
            Error::content(&self.name, Place::Line { line, column: None }, found, "text in UTF-8")
        })
    }
}

/// Reads at a place in a file.
#[cfg(unix)]
fn file_at(file: &File, bytes: &mut [u8], place: u64) -> io::Result<usize> {
    std::os::unix::fs::FileExt::read_at(file, bytes, place)
}

/// Reads at a place in a file.
#[cfg(windows)]
fn file_at(file: &File, bytes: &mut [u8], place: u64) -> io::Result<usize> {
    std::os::windows::fs::FileExt::seek_read(file, bytes, place)
}

/// A source that is read on from a place.
#[derive(Debug)]
pub struct SourceReader {
    source: Source,
    place: u64,
}

impl Read for SourceReader {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let read = self.source.read_at(bytes, self.place)?;
        self.place += read as u64;
        Ok(read)
    }
}

impl Seek for SourceReader {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let place = match to {
            SeekFrom::Start(place) => Some(place),
            SeekFrom::End(offset) => self.source.length.checked_add_signed(offset),
            SeekFrom::Current(offset) => self.place.checked_add_signed(offset),
        };
        self.place = place.ok_or_else(|| io::Error::from(io::ErrorKind::InvalidInput))?;
        Ok(self.place)
    }
}
