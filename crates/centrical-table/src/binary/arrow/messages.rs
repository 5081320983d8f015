//! Messages of Arrow IPC, in a stream or a file.

use std::io::Read;
use std::path::Path;

use polars_arrow_format::ipc::MessageRef;
use polars_arrow_format::ipc::planus::ReadAsRoot;

use super::super::arrays::{Bytes, Packing};
use crate::error::{Error, Place};
use crate::source::Source;

/// What a stream begins with, or a message in it.
pub(crate) const CONTINUATION: [u8; 4] = [0xff; 4];

/// The messages of a stream.
pub(super) struct Messages {
    pub source: Source,
    /// Where the next one is.
    pub at: u64,
}

/// A message: its metadata, and where its body is.
pub(super) struct Message<'a> {
    pub source: &'a Source,
    bytes: Vec<u8>,
    body: std::ops::Range<u64>,
}

impl Messages {
    /// The messages of a file or a stream.
    pub fn new(source: &Source) -> Self {
        Self { source: source.clone(), at: 0 }
    }

    /// Whether they are a stream.
    pub fn is_stream(&self) -> Result<bool, Error> {
        Ok(self.source.length() >= 4 && self.word(0)? == CONTINUATION_WORD)
    }

    /// The footer of a file: before its length and the letters at the end.
    pub fn footer(&self) -> Result<Vec<u8>, Error> {
        let mut end = [0; 10];
        let at = self
            .source
            .length()
            .checked_sub(end.len() as u64)
            .ok_or_else(|| damaged(self.source.name(), "no footer"))?;
        self.read(at, &mut end)?;
        let length = u64::from(u32::from_le_bytes([end[0], end[1], end[2], end[3]]));
        match at.checked_sub(length) {
            Some(start) if end.ends_with(b"ARROW1") => {
                let mut bytes = vec![0; usize::try_from(length).unwrap_or(usize::MAX)];
                self.read(start, &mut bytes)?;
                Ok(bytes)
            }
            _ => Err(damaged(self.source.name(), "no footer")),
        }
    }

    /// The next message; none at the end of the stream.
    pub fn next(&mut self) -> Result<Option<Message<'_>>, Error> {
        if self.source.length() < self.at.saturating_add(8) {
            return Ok(None);
        }
        let [mark, length] = [self.word(0)?, self.word(4)?];
        if length == 0 {
            return Ok(None);
        }
        let start = self.at + 8;
        let end = start.saturating_add(u64::from(length));
        if mark != CONTINUATION_WORD || end > self.source.length() {
            return Err(damaged(self.source.name(), format!("a message of {length} bytes at byte {}", self.at)));
        }
        let mut bytes = vec![0; usize::try_from(length).unwrap_or(usize::MAX)];
        self.read(start, &mut bytes)?;
        let mut message = Message { source: &self.source, bytes, body: end..end };
        let body = message.metadata()?.body_length().map_err(|e| damaged(message.source.name(), e))?;
        let after =
            u64::try_from(body).ok().and_then(|body| end.checked_add(body)).filter(|end| *end <= self.source.length());
        message.body.end = after.ok_or_else(|| damaged(message.source.name(), format!("a body of {body} bytes")))?;
        self.at = message.body.end;
        Ok(Some(message))
    }

    fn word(&self, after: u64) -> Result<u32, Error> {
        let mut word = [0; 4];
        self.read(self.at + after, &mut word)?;
        Ok(u32::from_le_bytes(word))
    }

    fn read(&self, from: u64, bytes: &mut [u8]) -> Result<(), Error> {
        self.source.reader_at(from).read_exact(bytes).map_err(|e| Error::reading(self.source.name(), e, ARROW))
    }
}

const CONTINUATION_WORD: u32 = u32::from_le_bytes(CONTINUATION);

impl Message<'_> {
    /// The flat buffer that says what the body is.
    pub fn metadata(&self) -> Result<MessageRef<'_>, Error> {
        MessageRef::read_as_root(&self.bytes).map_err(|e| damaged(self.source.name(), e))
    }

    /// Where the bytes of a buffer are. A packed one opens with its length unpacked, or -1 if it is plain after all.
    pub fn bytes_of(&self, offset: i64, length: i64, packing: Option<fn(u64) -> Packing>) -> Result<Bytes, Error> {
        let wrong = || damaged(self.source.name(), format!("a buffer of {length} bytes from {offset}"));
        let offset = u64::try_from(offset).map_err(|_| wrong())?.checked_add(self.body.start).ok_or_else(wrong)?;
        let length = u64::try_from(length).map_err(|_| wrong())?;
        if offset.checked_add(length).is_none_or(|end| end > self.body.end) {
            return Err(wrong());
        }
        let plain = Bytes { packing: Packing::Plain, offset, length, skip: 0, crc_32: None };
        let Some(packing) = packing.filter(|_| length >= 8) else { return Ok(plain) };
        let mut prefix = [0; 8];
        plain.open(self.source, 0).and_then(|mut input| input.read_exact(&mut prefix)).map_err(|_| wrong())?;
        let packing = if prefix == [0xff; 8] { Packing::Plain } else { packing(u64::from_le_bytes(prefix)) };
        Ok(Bytes { packing, offset: offset + 8, length: length - 8, skip: 0, crc_32: None })
    }
}

const ARROW: &str = "a whole Arrow file or stream";

/// What does not hang together.
pub(super) fn damaged(file: &Path, why: impl std::fmt::Display) -> Error {
    Error::content(file, Place::Whole, format!("damaged Arrow ({why})"), ARROW)
}

pub(super) fn contradiction(file: &Path) -> Error {
    damaged(file, "a message that contradicts itself")
}
