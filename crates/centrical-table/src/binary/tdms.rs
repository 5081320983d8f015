//! TDMS, the format of National Instruments: channels in segments, read by channel.
//!
//! A column is a channel by its name, or by `group/channel` where several groups have one of that name. A column of time that is
//! not a channel is made of the properties of the first reading: `wf_start_time`, `wf_start_offset` and `wf_increment`.

mod metadata;
mod scaling;

use std::collections::BTreeSet;
use std::io::{self, Read};
use std::path::Path;
use std::rc::Rc;

use self::metadata::{Kind, Layout, Listed, Metadata, Properties, Segment, Value};
use self::scaling::Scaling;
use super::columnar::Column;
use crate::column::{ColumnName, Field, ROWS, Rule};
use crate::error::{Error, Place, quoted};
use crate::source::Source;

/// Bytes that are read at a time.
const BUFFER: u64 = 1 << 18;

/// The index file beside a TDMS file, which has no numbers.
pub(super) const INDEX_MAGIC: &[u8] = b"TDSh";

/// Values of a channel in equal steps, in chunks that come in equal steps.
#[derive(Debug, Clone, Copy)]
struct Run {
    kind: Kind,
    big_endian: bool,
    /// Of the first value, from one to the next in a chunk, and from one chunk to the next.
    offset: u64,
    stride: u64,
    chunk: u64,
    of_chunk: u64,
    /// Values in all chunks, and those before the next to be read.
    count: u64,
    read: u64,
}

impl Run {
    /// Where a value is.
    fn place(&self, value: u64) -> u64 {
        self.offset + value / self.of_chunk * self.chunk + value % self.of_chunk * self.stride
    }
}

/// A channel with numbers.
struct Channel<'a> {
    object: usize,
    group: String,
    name: String,
    properties: &'a Properties,
}

/// The wanted columns, in the order of the fields.
pub(super) fn columns(source: &Source, fields: &[Field]) -> Result<Vec<Column>, Error> {
    let file = source.name();
    let metadata = Metadata::read(source).map_err(|e| damaged(file, Place::Whole, &e))?;
    let channels = channels(&metadata);
    let places = fields.iter().map(|field| find(file, &channels, field)).collect::<Result<Vec<_>, _>>()?;
    let reading = places.iter().flatten().next();
    let column = |(field, place): (&Field, &Option<usize>)| match place {
        Some(place) => channel_column(source, &metadata, &channels[*place], field),
        None => time_column(file, &metadata, reading.map(|place| &channels[*place]), field),
    };
    fields.iter().zip(&places).map(column).collect()
}

/// The names of the channels, with their group where several have one.
pub(super) fn names(source: &Source) -> Result<Vec<String>, Error> {
    let metadata = Metadata::read(source).map_err(|e| damaged(source.name(), Place::Whole, &e))?;
    let channels = channels(&metadata);
    let is_alone = |name: &str| channels.iter().filter(|channel| channel.name == name).count() == 1;
    let name = |channel: &Channel| {
        if is_alone(&channel.name) { channel.name.clone() } else { format!("{}/{}", channel.group, channel.name) }
    };
    Ok(channels.iter().map(name).collect())
}

/// All channels that have numbers.
fn channels(metadata: &Metadata) -> Vec<Channel<'_>> {
    let mut numbers = BTreeSet::new();
    let mut before: Option<&Segment> = None;
    for segment in &metadata.segments {
        if !before.is_some_and(|before| Rc::ptr_eq(&before.list, &segment.list)) {
            let is_number = |listed: &&Listed| {
                let (Layout::Plain { kind, .. } | Layout::Daqmx { kind, .. }) = &listed.layout;
                kind.is_some()
            };
            numbers.extend(segment.list.iter().filter(is_number).map(|listed| listed.object));
        }
        before = Some(segment);
    }
    let mut channels = Vec::new();
    for (object, path) in metadata.paths.iter().enumerate() {
        if let [group, name] = parts(path).as_slice()
            && numbers.contains(&object)
        {
            let properties = &metadata.properties[object];
            channels.push(Channel { object, group: group.clone(), name: name.clone(), properties });
        }
    }
    channels
}

/// The names in a path such as `/'group'/'it''s'`.
fn parts(path: &str) -> Vec<String> {
    let inner = path.strip_prefix("/'").and_then(|rest| rest.strip_suffix('\'')).unwrap_or_default();
    inner.split("'/'").filter(|part| !part.is_empty()).map(|part| part.replace("''", "'")).collect()
}

/// The channel of a field; none where its time is that of a waveform.
fn find(file: &Path, channels: &[Channel], field: &Field) -> Result<Option<usize>, Error> {
    let wrong = |found: String, expected: &str| {
        Err(Error::content(file, Place::Column(field.name.to_string()), found, expected))
    };
    let list = || {
        let names: Vec<String> = channels.iter().map(|channel| format!("{}/{}", channel.group, channel.name)).collect();
        format!("channels {}", quoted(names.join(", ").as_bytes()))
    };
    match &field.name {
        ColumnName::Number(number) => match number.checked_sub(1).filter(|place| *place < channels.len()) {
            Some(place) => Ok(Some(place)),
            None => wrong(format!("{} channels of numbers", channels.len()), "that many"),
        },
        ColumnName::Name(name) => {
            let is =
                |channel: &Channel| channel.name == *name || format!("{}/{}", channel.group, channel.name) == *name;
            let mut places = (0..channels.len()).filter(|place| is(&channels[*place]));
            match (places.next(), places.next()) {
                (Some(place), None) => Ok(Some(place)),
                (Some(_), Some(_)) => wrong(format!("several such {}", list()), "one, or its name as group/channel"),
                (None, _) if field.rule.ascends() && channels.iter().any(|c| increment(c.properties).is_some()) => {
                    Ok(None)
                }
                (None, _) => wrong(list(), "a channel of this name"),
            }
        }
        ColumnName::Row | ColumnName::DateAndTime(_) => {
            wrong("no such channel".to_owned(), "a channel by name or number")
        }
    }
}

/// A reader of a channel.
fn channel_column(source: &Source, metadata: &Metadata, channel: &Channel, field: &Field) -> Result<Column, Error> {
    let (file, place) = (source.name(), Place::Column(field.name.to_string()));
    let runs = runs(metadata, channel.object).map_err(|e| damaged(file, place.clone(), &e))?;
    let daqmx = metadata.scale_of_driver(channel.object);
    let scaling = scaling(metadata, channel, daqmx).map_err(|found| {
        let expected = "linear and polynomial scales, or data that are scaled already";
        Error::content(file, place.clone(), found, expected)
    })?;
    let is_stamps = field.rule == (Rule::Ascending { stamps: true })
        && scaling == Scaling::default()
        && runs.iter().all(|run| run.kind == Kind::Stamp);
    let (runs, source) = (runs.into_iter(), source.clone());
    let mut reader = RunReader { place, source, runs, run: None, buffer: Vec::new() };
    if is_stamps {
        return Ok(Column::Stamps(
            metadata::STAMPS,
            Box::new(move |values, ticks| {
                reader.next(|run, bytes| {
                    values.push(run.kind.value(bytes, run.big_endian));
                    ticks.extend(metadata::nanoseconds(bytes, run.big_endian));
                })
            }),
        ));
    }
    Ok(Column::Numbers(Box::new(move |values: &mut Vec<f64>| {
        let begin = values.len();
        reader.next(|run, bytes| values.push(run.kind.value(bytes, run.big_endian)))?;
        scaling.apply(&mut values[begin..]);
        Ok(())
    })))
}

/// The values of a channel, run after run.
struct RunReader {
    place: Place,
    source: Source,
    runs: std::vec::IntoIter<Run>,
    /// The run that is being read.
    run: Option<Run>,
    buffer: Vec<u8>,
}

impl RunReader {
    /// Hands out the bytes of the next values, [`ROWS`] at most.
    fn next(&mut self, mut push: impl FnMut(Run, &[u8])) -> Result<(), Error> {
        let mut left = ROWS as u64;
        while left > 0 {
            let Some(run) = self.run.take().or_else(|| self.runs.next()) else { break };
            let before = left;
            let push = |bytes: &[u8]| {
                left -= 1;
                push(run, bytes);
            };
            let read = read(&self.source, run, before, &mut self.buffer, push);
            self.run = read.map_err(|e| damaged(self.source.name(), self.place.clone(), &e))?;
        }
        Ok(())
    }
}

/// The scaling of a channel, of its group or of the file.
fn scaling(metadata: &Metadata, channel: &Channel, daqmx: Option<u32>) -> Result<Scaling, String> {
    let group = format!("/'{}'", channel.group.replace('\'', "''"));
    let of_path = |path: &str| metadata.paths.iter().position(|own| own == path).map(|k| &metadata.properties[k]);
    for properties in [Some(channel.properties), of_path(&group), of_path("/")].into_iter().flatten() {
        if let Some(scaling) = Scaling::of(properties, daqmx)? {
            return Ok(scaling);
        }
    }
    Ok(Scaling::default())
}

/// Where the values of an object are in every chunk of a segment.
#[derive(Debug, Clone, Copy)]
struct InChunk {
    kind: Kind,
    /// Bytes before the first value, from one to the next, and of the whole chunk.
    before: u64,
    stride: u64,
    chunk: u64,
    count: u64,
}

/// The values of an object in all segments.
fn runs(metadata: &Metadata, object: usize) -> io::Result<Vec<Run>> {
    let mut runs = Vec::new();
    let mut before: Option<(&Segment, Option<InChunk>)> = None;
    for segment in &metadata.segments {
        // Most segments are like the one before.
        let in_chunk = match before {
            Some((before, in_chunk))
                if Rc::ptr_eq(&before.list, &segment.list) && before.is_interleaved == segment.is_interleaved =>
            {
                in_chunk
            }
            _ => in_chunk(segment, object)?,
        };
        before = Some((segment, in_chunk));
        runs.extend(in_chunk.and_then(|in_chunk| run(segment, in_chunk)));
    }
    Ok(runs)
}

/// Where the values of an object are in every chunk of a segment; nothing if it has none there.
fn in_chunk(segment: &Segment, object: usize) -> io::Result<Option<InChunk>> {
    let Some(place) = segment.list.iter().position(|listed| listed.object == object) else { return Ok(None) };
    let in_chunk = match &segment.list[place].layout {
        Layout::Plain { kind: None, .. } | Layout::Daqmx { kind: None, .. } => {
            return Err(metadata::wrong("numbers in one segment and something else in another"));
        }
        Layout::Daqmx { kind: Some(kind), buffer, offset, count, widths, .. } => {
            let before = widths[..*buffer].iter().sum::<u64>().saturating_mul(*count).saturating_add(*offset);
            let chunk = widths.iter().sum::<u64>().saturating_mul(*count);
            InChunk { kind: *kind, before, stride: widths[*buffer], chunk, count: *count }
        }
        Layout::Plain { kind: Some(kind), count, .. } => {
            let mut sums = [0_u64; 2];
            for (k, listed) in segment.list.iter().enumerate() {
                let Layout::Plain { kind, bytes, .. } = &listed.layout else {
                    return Err(metadata::wrong("DAQmx data beside others in one segment"));
                };
                let bytes = if segment.is_interleaved { kind.map_or(0, Kind::size) } else { *bytes };
                sums[0] = sums[0].saturating_add(if k < place { bytes } else { 0 });
                sums[1] = sums[1].saturating_add(bytes);
            }
            let [before, chunk] = sums;
            // Of interleaved data, every row is a chunk.
            let (stride, count) = if segment.is_interleaved { (chunk, 1) } else { (kind.size(), *count) };
            InChunk { kind: *kind, before, stride, chunk, count }
        }
    };
    Ok(Some(in_chunk).filter(|in_chunk| in_chunk.chunk > 0 && in_chunk.stride > 0 && in_chunk.count > 0))
}

/// The values in a segment.
fn run(segment: &Segment, in_chunk: InChunk) -> Option<Run> {
    let InChunk { kind, before, stride, chunk, count: of_chunk } = in_chunk;
    let chunks = segment.length / chunk;
    // Of the last chunk, the recorder may have written a part.
    let left = (segment.length - chunks * chunk).saturating_sub(before);
    let rest = if left < kind.size() { 0 } else { ((left - kind.size()) / stride + 1).min(of_chunk) };
    let (big_endian, offset) = (segment.big_endian, segment.offset.saturating_add(before));
    let count = chunks.saturating_mul(of_chunk) + rest;
    (count > 0).then_some(Run { kind, big_endian, offset, stride, chunk, of_chunk, count, read: 0 })
}

/// Reads values of a run, `wanted` at most and a buffer full, and hands out the bytes of each. Returns the run with its unread
/// values.
fn read(
    source: &Source,
    mut run: Run,
    wanted: u64,
    buffer: &mut Vec<u8>,
    mut push: impl FnMut(&[u8]),
) -> io::Result<Option<Run>> {
    let (begin, size) = (run.place(run.read), run.kind.size());
    let most = run.count.min(run.read + wanted);
    let mut end = run.read + 1;
    while end < most && run.place(end) + size - begin <= BUFFER {
        end += 1;
    }
    let length = run.place(end - 1) + size - begin;
    buffer.resize(usize::try_from(length).unwrap_or(0), 0);
    source.reader_at(begin).read_exact(buffer)?;
    for value in run.read..end {
        let at = usize::try_from(run.place(value) - begin).unwrap_or(usize::MAX);
        let bytes = buffer.get(at..).ok_or_else(|| metadata::wrong("values that are not in order"))?;
        push(bytes);
    }
    run.read = end;
    Ok((run.read < run.count).then_some(run))
}

/// The time of the waveform of a reading: `wf_start_time + wf_start_offset + k wf_increment`.
fn time_column(file: &Path, metadata: &Metadata, reading: Option<&Channel>, field: &Field) -> Result<Column, Error> {
    let wrong =
        |found: &str, expected: &str| Error::content(file, Place::Column(field.name.to_string()), found, expected);
    let reading = reading.ok_or_else(|| wrong("no channel of readings", "one, whose waveform has the time"))?;
    let expected = "wf_increment, the time from one sample to the next, or a channel of time";
    let step = increment(reading.properties)
        .ok_or_else(|| wrong(&format!("no increment in the waveform of {}", reading.name), expected))?;
    let number = |name: &str| match reading.properties.get(name) {
        Some(Value::Number(number)) => *number,
        _ => 0.0,
    };
    let start = number("wf_start_time") + number("wf_start_offset");
    let runs = runs(metadata, reading.object).map_err(|e| damaged(file, Place::Whole, &e))?;
    let count: u64 = runs.iter().map(|run| run.count).sum();
    let mut next = 0;
    Ok(Column::Numbers(Box::new(move |values| {
        let end = count.min(next + ROWS as u64);
        values.extend((next..end).map(|k| start + k as f64 * step));
        next = end;
        Ok(())
    })))
}

/// The time from one sample of a waveform to the next [s].
fn increment(properties: &Properties) -> Option<f64> {
    match properties.get("wf_increment") {
        Some(Value::Number(step)) if *step > 0.0 && step.is_finite() => Some(*step),
        _ => None,
    }
}

fn damaged(file: &Path, place: Place, error: &io::Error) -> Error {
    Error::content(file, place, format!("a damaged TDMS file ({error})"), "a TDMS file that is whole")
}
