//! What the segments of a TDMS file say: channels, their properties, and where their numbers are.
//!
//! A segment is a lead-in of 28 bytes, metadata and raw data. Metadata list objects (the file, groups, channels), each with an index of
//! its raw data and properties. What a segment does not say is as in the one before (NI, "TDMS File Format Internal Structure").

use std::collections::BTreeMap;
use std::io::{self, Read};
use std::rc::Rc;

use crate::binary::arrays::{Scalar, ScalarKind};
use crate::source::Source;
use crate::stamp::{TickForm, TickUnit};

/// First bytes of a segment.
const TAG: &[u8; 4] = b"TDSm";
const LEAD_IN_BYTES: usize = 28;
const LEAD_IN: u64 = LEAD_IN_BYTES as u64;

/// Bits of the table of contents.
const METADATA: u32 = 1 << 1;
const NEW_LIST: u32 = 1 << 2;
const RAW_DATA: u32 = 1 << 3;
const INTERLEAVED: u32 = 1 << 5;
const BIG_ENDIAN: u32 = 1 << 6;

/// What a file may say at most: objects, and objects of all its different lists together.
const MOST_OBJECTS: usize = 2000;
const MOST_LISTED: usize = 1_000_000;

/// The longest metadata of a segment, and the longest text in it [bytes].
const LONGEST_METADATA: u64 = 64 << 20;

/// Properties of an object that matter here: numbers and short texts.
pub(super) type Properties = BTreeMap<String, Value>;

/// The value of a property.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    Number(f64),
    Text(String),
}

/// A type of numbers in the raw data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    Number(ScalarKind, usize),
    /// Seconds since 1904 and a fraction, 16 bytes.
    Stamp,
}

/// Where the values of a channel are in a chunk of raw data.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Layout {
    /// A count of values and their bytes; `None` where they are not numbers.
    Plain { kind: Option<Kind>, count: u64, bytes: u64 },
    /// In a buffer of the recorder's driver, whose rows have widths; a count of rows.
    Daqmx { kind: Option<Kind>, buffer: usize, offset: u64, count: u64, widths: Vec<u64>, scale: u32 },
}

/// An object in the list of a segment.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Listed {
    /// Among all objects.
    pub object: usize,
    pub layout: Layout,
}

/// Raw data of a segment.
pub(super) struct Segment {
    pub offset: u64,
    pub length: u64,
    pub is_interleaved: bool,
    pub big_endian: bool,
    pub list: Rc<Vec<Listed>>,
}

/// All that a file says of itself.
#[derive(Default)]
pub(super) struct Metadata {
    /// Paths such as `/'group'/'channel'`.
    pub paths: Vec<String>,
    pub properties: Vec<Properties>,
    pub segments: Vec<Segment>,
    /// The last layout of each object.
    layouts: Vec<Option<Layout>>,
    numbers: BTreeMap<String, usize>,
    listed: usize,
}

impl Metadata {
    /// Reads the lead-ins and metadata of all segments. A segment that the recorder did not end is read as far as it came.
    pub fn read(source: &Source) -> io::Result<Self> {
        let length = source.length();
        let mut metadata = Self::default();
        let mut list = Rc::new(Vec::new());
        let mut at = 0;
        while at + LEAD_IN <= length {
            let lead_in = LeadIn::read(source, at)?;
            let begin = at + LEAD_IN;
            let end = if lead_in.next == u64::MAX { length } else { begin.saturating_add(lead_in.next).min(length) };
            let raw = begin.saturating_add(lead_in.raw).min(end);
            if lead_in.contents & METADATA != 0 {
                if raw - begin > LONGEST_METADATA {
                    return Err(wrong(format!("{} bytes of metadata", raw - begin)));
                }
                let mut bytes = vec![0; usize::try_from(raw - begin).unwrap_or(0)];
                source.reader_at(begin).read_exact(&mut bytes)?;
                let big_endian = lead_in.contents & BIG_ENDIAN != 0;
                let kept = if lead_in.contents & NEW_LIST == 0 { list.as_ref().clone() } else { Vec::new() };
                let read = metadata.read_list(&mut Cursor { bytes: &bytes, big_endian }, kept)?;
                if read != *list {
                    metadata.listed += read.len();
                    list = Rc::new(read);
                }
                if metadata.listed > MOST_LISTED {
                    return Err(wrong(format!("more than {MOST_LISTED} channels in all segments together")));
                }
            }
            if lead_in.contents & RAW_DATA != 0 && end > raw {
                metadata.segments.push(Segment {
                    offset: raw,
                    length: end - raw,
                    is_interleaved: lead_in.contents & INTERLEAVED != 0,
                    big_endian: lead_in.contents & BIG_ENDIAN != 0,
                    list: Rc::clone(&list),
                });
            }
            if end <= at {
                break;
            }
            at = end;
        }
        Ok(metadata)
    }

    /// The scale that raw data of the driver stand for, if an object last had such data.
    pub fn scale_of_driver(&self, object: usize) -> Option<u32> {
        match self.layouts.get(object)? {
            Some(Layout::Daqmx { scale, .. }) => Some(*scale),
            _ => None,
        }
    }

    fn read_list(&mut self, input: &mut Cursor, mut list: Vec<Listed>) -> io::Result<Vec<Listed>> {
        for _ in 0..input.u32()? {
            let path = input.text()?;
            let object = self.object(path)?;
            match input.u32()? {
                u32::MAX => list.retain(|listed| listed.object != object),
                index => {
                    let layout = match index {
                        0 => self.layouts[object].clone().ok_or_else(|| wrong("data as before, and none before"))?,
                        0x1269 | 0x126a => daqmx(input, index == 0x126a)?,
                        _ => plain(input)?,
                    };
                    self.layouts[object] = Some(layout.clone());
                    match list.iter_mut().find(|listed| listed.object == object) {
                        Some(listed) => listed.layout = layout,
                        None => list.push(Listed { object, layout }),
                    }
                }
            }
            for _ in 0..input.u32()? {
                let name = input.text()?;
                let value = input.value()?;
                self.properties[object].extend(value.map(|value| (name, value)));
            }
        }
        Ok(list)
    }

    fn object(&mut self, path: String) -> io::Result<usize> {
        if let Some(number) = self.numbers.get(&path) {
            return Ok(*number);
        }
        if self.paths.len() == MOST_OBJECTS {
            return Err(wrong(format!("more than {MOST_OBJECTS} channels")));
        }
        self.numbers.insert(path.clone(), self.paths.len());
        self.paths.push(path);
        self.properties.push(Properties::new());
        self.layouts.push(None);
        Ok(self.paths.len() - 1)
    }
}

/// The first bytes of a segment.
struct LeadIn {
    contents: u32,
    /// From its end to the next segment, and to the raw data.
    next: u64,
    raw: u64,
}

impl LeadIn {
    fn read(source: &Source, at: u64) -> io::Result<Self> {
        let mut bytes = [0; LEAD_IN_BYTES];
        source.reader_at(at).read_exact(&mut bytes)?;
        let Some(rest) = bytes.strip_prefix(TAG) else { return Err(wrong(format!("no segment at byte {at}"))) };
        let contents = Cursor { bytes: rest, big_endian: false }.u32()?;
        let mut input = Cursor { bytes: &rest[8..], big_endian: contents & BIG_ENDIAN != 0 };
        Ok(Self { contents, next: input.u64()?, raw: input.u64()? })
    }
}

/// The index of raw data that are values, one after the other.
fn plain(input: &mut Cursor) -> io::Result<Layout> {
    let (code, dimension, count) = (input.u32()?, input.u32()?, input.u64()?);
    if dimension != 1 {
        return Err(wrong(format!("an array of {dimension} dimensions")));
    }
    let (size, kind) = size_and_kind(code).ok_or_else(|| wrong(format!("values of type {code:#x}")))?;
    // Texts say how many bytes they take.
    let bytes =
        if code == TEXT { input.u64()? } else { size.checked_mul(count).ok_or_else(|| wrong("too many values"))? };
    Ok(Layout::Plain { kind, count, bytes })
}

/// The index of raw data in buffers of the driver.
fn daqmx(input: &mut Cursor, is_digital: bool) -> io::Result<Layout> {
    let (_, dimension, count, scalers) = (input.u32()?, input.u32()?, input.u64()?, input.u32()?);
    if dimension != 1 || scalers == 0 {
        return Err(wrong(format!("DAQmx data of {dimension} dimensions and {scalers} scalers")));
    }
    let mut first = None;
    for _ in 0..scalers {
        let (code, buffer, offset) = (input.u32()?, input.u32()?, input.u32()?);
        if is_digital {
            input.take(1)?;
        } else {
            input.u32()?;
        }
        let scale = input.u32()?;
        first.get_or_insert((code, buffer, offset, scale));
    }
    let count_of_widths = input.u32()?;
    let widths = (0..count_of_widths).map(|_| input.u32().map(u64::from)).collect::<io::Result<Vec<_>>>()?;
    let Some((code, buffer, offset, scale)) = first else { return Err(wrong("DAQmx data without a scaler")) };
    let kind = match code {
        _ if is_digital => None,
        0 | 2 | 4 => Some(Kind::Number(ScalarKind::Unsigned, 1 << (code / 2))),
        1 | 3 | 5 => Some(Kind::Number(ScalarKind::Signed, 1 << (code / 2))),
        _ => None,
    };
    let (buffer, offset) = (buffer as usize, u64::from(offset));
    let size = kind.map_or(0, Kind::size);
    if widths.get(buffer).is_none_or(|width| offset + size > *width) && !is_digital {
        return Err(wrong(format!("DAQmx data at byte {offset} of buffer {buffer}, where there are {widths:?} bytes")));
    }
    Ok(Layout::Daqmx { kind, buffer, offset, count, widths, scale })
}

const TEXT: u32 = 0x20;

/// Bytes of a value of a type, and what it is where it is a number.
fn size_and_kind(code: u32) -> Option<(u64, Option<Kind>)> {
    use ScalarKind::{Float, Signed, Unsigned};
    let number = |kind, size: u8| Some((u64::from(size), Some(Kind::Number(kind, size.into()))));
    match code {
        1 => number(Signed, 1),
        2 => number(Signed, 2),
        3 => number(Signed, 4),
        4 => number(Signed, 8),
        5 => number(Unsigned, 1),
        6 => number(Unsigned, 2),
        7 => number(Unsigned, 4),
        8 => number(Unsigned, 8),
        9 | 0x19 => number(Float, 4),
        10 | 0x1a => number(Float, 8),
        11 | 0x1b => Some((16, None)),
        TEXT => Some((0, None)),
        0x21 => Some((1, None)),
        0x44 => Some((16, Some(Kind::Stamp))),
        0x0008_000c => Some((8, None)),
        0x0010_000d => Some((16, None)),
        _ => None,
    }
}

impl Kind {
    /// Bytes of a value.
    pub fn size(self) -> u64 {
        match self {
            Self::Number(_, size) => size as u64,
            Self::Stamp => 16,
        }
    }

    /// The value in the first bytes.
    pub fn value(self, bytes: &[u8], big_endian: bool) -> f64 {
        match self {
            Self::Number(kind, size) => {
                Scalar::new(kind, size, big_endian).map_or(f64::NAN, |scalar| scalar.read(bytes))
            }
            Self::Stamp => {
                let mut input = Cursor { bytes, big_endian };
                input.stamp().unwrap_or(f64::NAN)
            }
        }
    }
}

/// Stamps are in UTC. Their fractions of 2^-64 s are rounded to the nanosecond, far below any clock.
pub(super) const STAMPS: TickForm = TickForm { unit: TickUnit::Nanosecond, is_utc: true };

/// The stamp in the first bytes, so counted; nothing outside the years 1678 to 2261.
pub(super) fn nanoseconds(bytes: &[u8], big_endian: bool) -> Option<i64> {
    let (seconds, fraction) = Cursor { bytes, big_endian }.seconds_and_fraction().ok()?;
    let rounded = (u128::from(fraction) * 1_000_000_000 + (1 << 63)) >> 64;
    i64::try_from(i128::from(seconds) * 1_000_000_000 + i128::try_from(rounded).ok()?).ok()
}

/// Bytes that are read one value after the other.
struct Cursor<'a> {
    bytes: &'a [u8],
    big_endian: bool,
}

impl<'a> Cursor<'a> {
    fn take(&mut self, count: usize) -> io::Result<&'a [u8]> {
        let (taken, rest) =
            self.bytes.split_at_checked(count).ok_or_else(|| wrong("metadata that end within a value"))?;
        self.bytes = rest;
        Ok(taken)
    }

    fn u32(&mut self) -> io::Result<u32> {
        let mut four = [0; 4];
        four.copy_from_slice(self.take(4)?);
        Ok(if self.big_endian { u32::from_be_bytes(four) } else { u32::from_le_bytes(four) })
    }

    fn u64(&mut self) -> io::Result<u64> {
        let mut eight = [0; 8];
        eight.copy_from_slice(self.take(8)?);
        Ok(if self.big_endian { u64::from_be_bytes(eight) } else { u64::from_le_bytes(eight) })
    }

    fn text(&mut self) -> io::Result<String> {
        let length = self.u32()? as usize;
        Ok(String::from_utf8_lossy(self.take(length)?).into_owned())
    }

    /// Whole seconds since 1970, which are counted from 1904, and a fraction in units of 2^-64 s.
    fn seconds_and_fraction(&mut self) -> io::Result<(i64, u64)> {
        const FROM_1904: i64 = 2_082_844_800;
        let [first, second] = [self.u64()?, self.u64()?];
        let (seconds, fraction) = if self.big_endian { (first, second) } else { (second, first) };
        Ok((seconds.cast_signed().saturating_sub(FROM_1904), fraction))
    }

    /// Seconds since 1970.
    fn stamp(&mut self) -> io::Result<f64> {
        let (seconds, fraction) = self.seconds_and_fraction()?;
        Ok(seconds as f64 + fraction as f64 / 2_f64.powi(64))
    }

    /// The value of a property, if it is a number or a text.
    fn value(&mut self) -> io::Result<Option<Value>> {
        let code = self.u32()?;
        if code == TEXT {
            return Ok(Some(Value::Text(self.text()?)));
        }
        let (size, kind) = size_and_kind(code).ok_or_else(|| wrong(format!("a property of type {code:#x}")))?;
        let bytes = self.take(usize::try_from(size).unwrap_or(0))?;
        Ok(kind.map(|kind| Value::Number(kind.value(bytes, self.big_endian))))
    }
}

/// What is wrong with a file.
pub(super) fn wrong(found: impl Into<String>) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, found.into())
}
