//! Tables as Arrow IPC, files (Feather too) and streams, some rows at a time.
//!
//! A stream is a row of messages: `ff ff ff ff`, the length of the metadata, the metadata as a flat buffer, a body. A file
//! has such messages between the letters `ARROW1` and a footer that says where they are. In a body each column of numbers is an
//! array, plain or packed, so that it can be read in parts however long it is.

mod messages;
mod schema;

use polars_arrow_format::ipc::planus::ReadAsRoot;
use polars_arrow_format::ipc::{CompressionType, FooterRef, MessageHeaderRef, RecordBatchRef};

pub(super) use self::messages::CONTINUATION;
use self::messages::{Message, Messages, contradiction, damaged};
pub(super) use self::schema::durations;
use self::schema::{ArrowColumn, find};
use super::arrays::{self, Array, Packing};
use super::catch_panic::catch_panic;
use super::columnar::{Column, Parts};
use crate::column::Field;
use crate::error::{Error, Place};
use crate::source::Source;

/// The batches of rows of a file or a stream.
pub(super) fn parts(source: &Source, fields: &[Field]) -> Result<Parts, Error> {
    let messages = Messages::new(source);
    let fields = fields.to_vec();
    if messages.is_stream()? { Ok(of_stream(messages, fields)) } else { of_file(messages, fields) }
}

/// The names of the columns.
pub(super) fn names(source: &Source) -> Result<Vec<String>, Error> {
    let mut messages = Messages::new(source);
    let failed = |e| damaged(source.name(), e);
    if !messages.is_stream()? {
        let footer = messages.footer()?;
        let schema = FooterRef::read_as_root(&footer).and_then(|footer| footer.schema()).map_err(failed)?;
        return schema::names(source.name(), schema.ok_or_else(|| contradiction(source.name()))?);
    }
    while let Some(message) = messages.next()? {
        if let Some(MessageHeaderRef::Schema(schema)) = message.metadata()?.header().map_err(failed)? {
            return schema::names(source.name(), schema);
        }
    }
    Ok(Vec::new())
}

/// A stream: the schema first, then batches of rows; dictionaries are of columns that are not numbers.
fn of_stream(mut messages: Messages, fields: Vec<Field>) -> Parts {
    let mut columns = None;
    Box::new(std::iter::from_fn(move || next_of_stream(&mut messages, &mut columns, &fields).transpose()))
}

/// The next batch, the schema before it being noted.
fn next_of_stream(
    messages: &mut Messages,
    columns: &mut Option<Vec<ArrowColumn>>,
    fields: &[Field],
) -> Result<Option<Vec<Column>>, Error> {
    while let Some(message) = messages.next()? {
        let header = message.metadata()?.header().map_err(|e| damaged(message.source.name(), e))?;
        match (header, &*columns) {
            (Some(MessageHeaderRef::Schema(schema)), None) => {
                *columns = Some(find(message.source.name(), schema, fields)?);
            }
            (Some(MessageHeaderRef::RecordBatch(batch)), Some(columns)) => {
                return batch_columns(&message, batch, columns, fields).map(Some);
            }
            (Some(MessageHeaderRef::RecordBatch(_)), None) => {
                return Err(damaged(message.source.name(), "rows before the schema"));
            }
            _ => {}
        }
    }
    Ok(None)
}

/// A file: its footer has the schema and says where the batches are. Not every writer puts a whole stream before it.
fn of_file(mut messages: Messages, fields: Vec<Field>) -> Result<Parts, Error> {
    let bytes = messages.footer()?;
    let source = messages.source.clone();
    let file = source.name();
    let failed = |e| damaged(file, e);
    let footer = FooterRef::read_as_root(&bytes).map_err(failed)?;
    let schema = footer.schema().map_err(failed)?.ok_or_else(|| contradiction(file))?;
    let columns = find(file, schema, &fields)?;
    let blocks = footer.record_batches().map_err(failed)?;
    let places: Vec<i64> = blocks.into_iter().flatten().map(|block| block.offset()).collect();
    Ok(Box::new(places.into_iter().map(move |place| batch_at(&mut messages, place, &columns, &fields))))
}

/// The batch whose message is at a place in the file.
fn batch_at(
    messages: &mut Messages,
    place: i64,
    columns: &[ArrowColumn],
    fields: &[Field],
) -> Result<Vec<Column>, Error> {
    let source = messages.source.clone();
    let file = source.name();
    messages.at = u64::try_from(place).map_err(|_| contradiction(file))?;
    let message = messages.next()?.ok_or_else(|| contradiction(file))?;
    let Some(MessageHeaderRef::RecordBatch(batch)) = message.metadata()?.header().map_err(|e| damaged(file, e))? else {
        return Err(contradiction(file));
    };
    batch_columns(&message, batch, columns, fields)
}

/// The columns of a batch.
fn batch_columns(
    message: &Message,
    batch: RecordBatchRef,
    columns: &[ArrowColumn],
    fields: &[Field],
) -> Result<Vec<Column>, Error> {
    let source = message.source;
    let arrays = catch_panic(|| arrays(message, batch, columns))
        .map_err(|e| e.unwrap_or_else(|| contradiction(source.name())))?;
    let numbers = |((array, column), field): ((&Array, &ArrowColumn), &Field)| {
        let of = (array, &array.columns[0]);
        column
            .stamps
            .map_or_else(|| arrays::column(source, of, field), |counted| arrays::stamps(source, of, field, counted))
    };
    arrays.iter().zip(columns).zip(fields).map(numbers).collect()
}

/// The arrays of the wanted columns in a batch of rows.
fn arrays(message: &Message, batch: RecordBatchRef, columns: &[ArrowColumn]) -> Result<Vec<Array>, Error> {
    let failed = |e| damaged(message.source.name(), e);
    let rows = batch.length().map_err(failed)?;
    let packing = match batch.compression().map_err(failed)?.map(|c| c.codec()).transpose().map_err(failed)? {
        None => None,
        Some(CompressionType::Lz4Frame) => Some(Packing::Lz4 as fn(u64) -> Packing),
        Some(CompressionType::Zstd) => Some(Packing::Zstd as fn(u64) -> Packing),
    };
    let (nodes, buffers) = (batch.nodes().map_err(failed)?, batch.buffers().map_err(failed)?);
    let array = |column: &ArrowColumn| {
        let node = nodes.as_ref().and_then(|nodes| nodes.get(column.node));
        let buffer = buffers.as_ref().and_then(|buffers| buffers.get(column.buffer + 1));
        let (Some(node), Some(buffer)) = (node, buffer) else { return Err(contradiction(message.source.name())) };
        if node.null_count() != 0 {
            let place = Place::Column(column.name.clone());
            let found = format!("{} values missing", node.null_count());
            return Err(Error::content(
                message.source.name(),
                place,
                found,
                "a value in every row, NaN where a reading is missing",
            ));
        }
        let count = u64::try_from(rows).ok().filter(|_| node.length() == rows);
        let bytes = message.bytes_of(buffer.offset(), buffer.length(), packing)?;
        let rows = count.ok_or_else(|| contradiction(message.source.name()))?;
        Ok(column.array(rows, bytes))
    };
    columns.iter().map(array).collect()
}
