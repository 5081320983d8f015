//! Tables as Arrow IPC, files (Feather too) and streams, a block of rows at a time.
//!
//! A stream is a row of messages: `ff ff ff ff`, the length of the metadata, the metadata as a flat buffer, a body. A file
//! has such messages between the letters `ARROW1` and a footer that says where they are. In a body each column of numbers is an
//! array, plain or packed, so that it can be read in parts however long it is.

mod schema;

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use polars_arrow_format::ipc::planus::ReadAsRoot;
use polars_arrow_format::ipc::{CompressionType, FooterRef, MessageHeaderRef, MessageRef, RecordBatchRef};

use self::schema::{ArrowColumn, find};
use super::arrays::{self, Array, Bytes, Packing};
use super::columnar;
use super::panics::caught;
use crate::error::{Error, Place};
use crate::rows::Rows;

/// What a stream begins with, or a message in it.
pub(crate) const CONTINUATION: [u8; 4] = [0xff; 4];

/// Reads the table of `file`.
pub(crate) fn read(file: &Path, input: &File, rows: &mut Rows) -> Result<(), Error> {
    let mut messages = Messages::new(file, input)?;
    if messages.is_stream()? { read_stream(&mut messages, rows) } else { read_blocks(&mut messages, rows) }
}

/// A stream: the schema first, then batches of rows; dictionaries are of columns that are no numbers.
fn read_stream(messages: &mut Messages, rows: &mut Rows) -> Result<(), Error> {
    let file = messages.file;
    let mut columns = None;
    let mut first_row = 0;
    while !rows.is_too_long()
        && let Some(message) = messages.next()?
    {
        let header = message.metadata()?.header().map_err(|e| damaged(file, e))?;
        match (header, &columns) {
            (Some(MessageHeaderRef::Schema(schema)), None) => columns = Some(find(file, schema, rows.fields)?),
            (Some(MessageHeaderRef::RecordBatch(batch)), Some(columns)) => {
                read_batch(&message, batch, columns, &mut first_row, rows)?;
            }
            (Some(MessageHeaderRef::RecordBatch(_)), None) => return Err(damaged(file, "rows before the schema")),
            _ => {}
        }
    }
    Ok(())
}

/// A file: its footer has the schema and says where the batches are. Not every writer puts a whole stream before it.
fn read_blocks(messages: &mut Messages, rows: &mut Rows) -> Result<(), Error> {
    let file = messages.file;
    let failed = |e| damaged(file, e);
    let bytes = messages.footer()?;
    let footer = FooterRef::read_as_root(&bytes).map_err(failed)?;
    let schema = footer.schema().map_err(failed)?.ok_or_else(|| contradiction(file))?;
    let columns = find(file, schema, rows.fields)?;
    let mut first_row = 0;
    for block in footer.record_batches().map_err(failed)?.into_iter().flatten() {
        messages.at = u64::try_from(block.offset()).map_err(|_| contradiction(file))?;
        let message = messages.next()?.ok_or_else(|| contradiction(file))?;
        let Some(MessageHeaderRef::RecordBatch(batch)) = message.metadata()?.header().map_err(failed)? else {
            return Err(contradiction(file));
        };
        read_batch(&message, batch, &columns, &mut first_row, rows)?;
        if rows.is_too_long() {
            break;
        }
    }
    Ok(())
}

/// The rows of a batch.
fn read_batch(
    message: &Message,
    batch: RecordBatchRef,
    columns: &[ArrowColumn],
    first_row: &mut u64,
    rows: &mut Rows,
) -> Result<(), Error> {
    let file = message.file;
    let arrays = caught(|| message.arrays(batch, columns)).map_err(|e| e.unwrap_or_else(|| contradiction(file)))?;
    let mut of_batch = Vec::with_capacity(arrays.len());
    for ((array, column), field) in arrays.iter().zip(columns).zip(rows.fields) {
        let numbers = arrays::column(file, (array, &array.columns[0]), field)?;
        of_batch.push(schema::in_seconds(numbers, column.unit));
    }
    columnar::read(file, &mut of_batch, first_row, rows)
}

/// The messages of a stream.
struct Messages<'a> {
    file: &'a Path,
    input: &'a File,
    at: u64,
    length: u64,
}

/// A message: its metadata, and where its body is.
struct Message<'a> {
    file: &'a Path,
    bytes: Vec<u8>,
    body: std::ops::Range<u64>,
}

impl<'a> Messages<'a> {
    fn new(file: &'a Path, input: &'a File) -> Result<Self, Error> {
        let length = input.metadata().map_err(|e| Error::reading(file, e, ARROW))?.len();
        Ok(Self { file, input, at: 0, length })
    }

    fn is_stream(&mut self) -> Result<bool, Error> {
        Ok(self.length >= 4 && self.word(0)? == CONTINUATION_WORD)
    }

    /// The footer of a file: before its length and the letters at the end.
    fn footer(&mut self) -> Result<Vec<u8>, Error> {
        let mut end = [0; 10];
        let at = self.length.checked_sub(end.len() as u64).ok_or_else(|| damaged(self.file, "no footer"))?;
        self.read(at, &mut end)?;
        let length = u64::from(u32::from_le_bytes([end[0], end[1], end[2], end[3]]));
        match at.checked_sub(length) {
            Some(start) if end.ends_with(b"ARROW1") => {
                let mut bytes = vec![0; usize::try_from(length).unwrap_or(usize::MAX)];
                self.read(start, &mut bytes)?;
                Ok(bytes)
            }
            _ => Err(damaged(self.file, "no footer")),
        }
    }

    /// The next message; none at the end of the stream.
    fn next(&mut self) -> Result<Option<Message<'a>>, Error> {
        if self.length < self.at.saturating_add(8) {
            return Ok(None);
        }
        let [mark, length] = [self.word(0)?, self.word(4)?];
        if length == 0 {
            return Ok(None);
        }
        let start = self.at + 8;
        let end = start.saturating_add(u64::from(length));
        if mark != CONTINUATION_WORD || end > self.length {
            return Err(damaged(self.file, format!("a message of {length} bytes at byte {}", self.at)));
        }
        let mut bytes = vec![0; usize::try_from(length).unwrap_or(usize::MAX)];
        self.read(start, &mut bytes)?;
        let mut message = Message { file: self.file, bytes, body: end..end };
        let body = message.metadata()?.body_length().map_err(|e| damaged(self.file, e))?;
        let after = u64::try_from(body).ok().and_then(|body| end.checked_add(body)).filter(|end| *end <= self.length);
        message.body.end = after.ok_or_else(|| damaged(self.file, format!("a body of {body} bytes")))?;
        self.at = message.body.end;
        Ok(Some(message))
    }

    fn word(&mut self, after: u64) -> Result<u32, Error> {
        let mut word = [0; 4];
        self.read(self.at + after, &mut word)?;
        Ok(u32::from_le_bytes(word))
    }

    fn read(&mut self, from: u64, bytes: &mut [u8]) -> Result<(), Error> {
        let mut input = self.input;
        let read = input.seek(SeekFrom::Start(from)).and_then(|_| input.read_exact(bytes));
        read.map_err(|e| Error::reading(self.file, e, ARROW))
    }
}

const CONTINUATION_WORD: u32 = u32::from_le_bytes(CONTINUATION);

impl Message<'_> {
    fn metadata(&self) -> Result<MessageRef<'_>, Error> {
        MessageRef::read_as_root(&self.bytes).map_err(|e| damaged(self.file, e))
    }

    /// The arrays of the wanted columns in a batch of rows.
    fn arrays(&self, batch: RecordBatchRef, columns: &[ArrowColumn]) -> Result<Vec<Array>, Error> {
        let failed = |e| damaged(self.file, e);
        let rows = batch.length().map_err(failed)?;
        let packing = match batch.compression().map_err(failed)?.map(|c| c.codec()).transpose().map_err(failed)? {
            None => None,
            Some(CompressionType::Lz4Frame) => Some(Packing::Lz4),
            Some(CompressionType::Zstd) => Some(Packing::Zstd),
        };
        let (nodes, buffers) = (batch.nodes().map_err(failed)?, batch.buffers().map_err(failed)?);
        let array = |column: &ArrowColumn| {
            let node = nodes.as_ref().and_then(|nodes| nodes.get(column.node));
            let buffer = buffers.as_ref().and_then(|buffers| buffers.get(column.buffer + 1));
            let (Some(node), Some(buffer)) = (node, buffer) else { return Err(contradiction(self.file)) };
            if node.null_count() != 0 {
                let place = Place::Column(column.name.clone());
                let found = format!("{} values missing", node.null_count());
                return Err(Error::content(self.file, place, found, "a value in every row"));
            }
            let count = u64::try_from(rows).ok().filter(|_| node.length() == rows);
            let bytes = self.bytes_of(buffer.offset(), buffer.length(), packing)?;
            let rows = count.ok_or_else(|| contradiction(self.file))?;
            Ok(column.array(rows, bytes))
        };
        columns.iter().map(array).collect()
    }

    /// Where the bytes of a buffer are. A packed one opens with its length unpacked, or -1 if it is plain after all.
    fn bytes_of(&self, offset: i64, length: i64, packing: Option<Packing>) -> Result<Bytes, Error> {
        let wrong = || damaged(self.file, format!("a buffer of {length} bytes from {offset}"));
        let offset = u64::try_from(offset).map_err(|_| wrong())?.checked_add(self.body.start).ok_or_else(wrong)?;
        let length = u64::try_from(length).map_err(|_| wrong())?;
        if offset.checked_add(length).is_none_or(|end| end > self.body.end) {
            return Err(wrong());
        }
        let plain = Bytes { packing: Packing::Plain, offset, length, skip: 0 };
        let Some(packing) = packing.filter(|_| length >= 8) else { return Ok(plain) };
        let mut prefix = [0; 8];
        plain.open(self.file, 0).and_then(|mut input| input.read_exact(&mut prefix)).map_err(|_| wrong())?;
        let packing = if prefix == [0xff; 8] { Packing::Plain } else { packing };
        Ok(Bytes { packing, offset: offset + 8, length: length - 8, skip: 0 })
    }
}

const ARROW: &str = "a whole Arrow file or stream";

fn damaged(file: &Path, why: impl std::fmt::Display) -> Error {
    Error::content(file, Place::Whole, format!("damaged Arrow ({why})"), ARROW)
}

fn contradiction(file: &Path) -> Error {
    damaged(file, "a message that contradicts itself")
}
