//! What a table as text looks like: for whoever writes down how it is to be read.

use super::encoding::TextEncoding;
use super::fields::{Delimiter, number};
use super::lines::{Line, is_data, numbered};
use super::shape::{Shape, is_number};
use super::unit_words::{name_and_unit, unit_of_word};
use crate::column::is_missing;
use crate::stamp::{self, StampKind};

/// What a table as text looks like, from its first lines.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TextForm {
    /// The encoding of names and other words. Numbers are read in any of them.
    pub encoding: TextEncoding,
    /// What divides the fields: `;`, `,`, a tab, or a blank for any number of blanks.
    pub delimiter: char,
    /// The sign before the decimals.
    pub decimal: DecimalSign,
    /// The lines above the header, or above the first row; comments and blank lines are not among them.
    pub above: Vec<String>,
    /// The line of the header, counted from 1; none where there are only numbers.
    pub header_line: Option<u64>,
    /// The names of the columns in UTF-8, as settings may write them.
    pub names: Vec<String>,
    /// The line of a row of units, counted from 1.
    pub units_line: Option<u64>,
    /// Units of the columns, in the spelling of settings, from the row of units or behind the names; `None` where it is absent or
    /// not understood.
    pub units: Vec<Option<&'static str>>,
    /// The line of the first row, counted from 1.
    pub first_row_line: u64,
    /// The fields of the first row as they are written.
    pub first_row: Vec<String>,
    /// The first column of stamps, counted from 0, and their kind.
    pub stamps: Option<StampColumn>,
    /// The first column of dates, counted from 0, where the stamps are times of the day.
    pub dates: Option<usize>,
}

/// The sign before the decimals of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DecimalSign {
    /// 0.5
    Point,
    /// 0,5
    Comma,
    /// There are only whole numbers.
    Unseen,
}

/// A column of stamps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StampColumn {
    /// Counted from 0.
    pub column: usize,
    /// How they are written.
    pub kind: StampKind,
}

impl TextForm {
    /// The form that the first lines show, turned into UTF-8 if `encoding` is UTF-16; `None` unless they are a table of numbers.
    pub(crate) fn of(text: &[u8], encoding: Option<TextEncoding>) -> Option<Self> {
        let lines: Vec<Line> = numbered(text).filter(|(_, line)| is_data(line)).collect();
        let texts: Vec<&[u8]> = lines.iter().map(|(_, line)| *line).collect();
        let shape = Shape::of(&texts)?;
        let start = &texts[..=shape.first_row];
        let encoding = encoding.unwrap_or_else(|| TextEncoding::of_bytes(&start.join(&b'\n')));
        let fields = |index: usize| -> Vec<String> {
            let texts = shape.delimiter.texts(texts[index]).unwrap_or_default();
            texts.iter().map(|text| encoding.decode(text).into_owned()).collect()
        };
        let names = shape.header.map(fields).unwrap_or_default();
        let units = match shape.units.map(fields) {
            Some(row) => row.iter().map(|text| unit_of_word(text)).collect(),
            None => names.iter().map(|name| name_and_unit(name).map(|(_, unit)| unit)).collect(),
        };
        let first_row = fields(shape.first_row);
        let line = |index: usize| lines[index].0 + 1;
        let above = shape.header.unwrap_or(shape.first_row);
        let stamp =
            |(column, text): (usize, &String)| Some(StampColumn { column, kind: stamp::kind(text.as_bytes())? });
        let words = || first_row.iter().enumerate().filter(|(_, text)| number(text.as_bytes()).is_none());
        let times = words().filter_map(stamp).find(|stamps| stamps.kind == StampKind::TimeOfDay);
        let is_date = |text: &str| stamp::dated_seconds(&stamp::joined(text.as_bytes(), b"00:00:00")).is_some();
        let dates = times.and_then(|_| Some(words().find(|(_, text)| is_date(text))?.0));
        let stamps = times.filter(|_| dates.is_some()).or_else(|| words().find_map(stamp));
        Some(Self {
            encoding,
            delimiter: match shape.delimiter {
                Delimiter::Byte(byte) => char::from(byte),
                Delimiter::Blanks => ' ',
            },
            decimal: DecimalSign::of(&texts[shape.first_row..], shape.delimiter),
            above: texts[..above].iter().map(|line| encoding.decode(line).into_owned()).collect(),
            header_line: shape.header.map(line),
            names,
            units_line: shape.units.map(line),
            units,
            first_row_line: line(shape.first_row),
            stamps,
            dates,
            first_row,
        })
    }
}

impl TextForm {
    /// Whether the first row has a word in that column, counted from 0: neither a number, nor a stamp, nor a value that is missing.
    pub fn has_word(&self, column: usize) -> bool {
        self.first_row.get(column).is_some_and(|text| !is_number(text.as_bytes()) && !is_missing(text))
    }
}

impl DecimalSign {
    /// The first one in a number of some rows.
    fn of(rows: &[&[u8]], delimiter: Delimiter) -> Self {
        for row in rows {
            for text in delimiter.texts(row).unwrap_or_default().iter().filter(|text| number(text).is_some()) {
                if text.contains(&b',') {
                    return Self::Comma;
                } else if text.contains(&b'.') {
                    return Self::Point;
                }
            }
        }
        Self::Unseen
    }
}
