//! Where the wanted numbers stand in a line, from the first line of the table.

use std::borrow::Cow;

use memchr::memchr3;

use super::fields::{Delimiter, Fault, number, unquoted};
use super::lines::{is_data, numbered};
use super::number::plain;
use super::shape::{are_units, is_number};
use super::unit_words::unit_in_any;
use crate::column::{ColumnName, Field, LARGEST_NUMBER, Rule, is_missing};
use crate::error::quoted;
use crate::stamp;

/// Where the wanted numbers stand in a line.
#[derive(Debug, Clone)]
pub(super) struct Layout {
    delimiter: Delimiter,
    /// The same where rows may be of bare numbers.
    of_numbers: Option<u8>,
    /// For every column of the file, the wanted field that it is.
    wanted: Vec<Option<usize>>,
    date: Option<DateColumn>,
}

/// A column of dates, to which another one has the times of the day.
#[derive(Debug, Clone, Copy)]
pub(super) struct DateColumn {
    /// Which column of the file it is, from 0.
    pub place: usize,
    /// The field that the times of the day are.
    pub field: usize,
}

impl Field {
    /// The value of this field from a field of a line.
    fn value(&self, text: &[u8]) -> Result<f64, Fault> {
        let text = unquoted(text);
        let stamp = || if self.rule == (Rule::Ascending { stamps: true }) { stamp::seconds(&text) } else { None };
        match number(&text).or_else(stamp).and_then(plausible) {
            Some(number) => Ok(number),
            None if self.rule == Rule::OrMissing && std::str::from_utf8(&text).is_ok_and(is_missing) => Ok(f64::NAN),
            None => Err(self.fault(quoted(&text), &self.expected)),
        }
    }
}

impl Layout {
    /// Of every column of the file, divided so, the field that it is; beside one of them may be dates.
    pub fn new(delimiter: Delimiter, wanted: Vec<Option<usize>>, date: Option<DateColumn>) -> Self {
        let of_numbers = match delimiter {
            Delimiter::Byte(byte) if date.is_none() => Some(byte),
            _ => None,
        };
        Self { delimiter, of_numbers, wanted, date }
    }

    /// All fields of a line.
    pub fn texts<'a>(&self, line: &'a [u8]) -> Result<Vec<Cow<'a, [u8]>>, Fault> {
        self.delimiter.texts(line)
    }

    /// The wanted fields of a line, in their order; none where one of them is missing.
    pub fn wanted_texts<'a>(&self, line: &'a [u8]) -> Option<Vec<Cow<'a, [u8]>>> {
        let mut texts = self.texts(line).ok()?;
        let count = self.wanted.iter().flatten().count();
        let place = |field| self.wanted.iter().position(|own| *own == Some(field));
        (0..count).map(|field| Some(std::mem::take(texts.get_mut(place(field)?)?))).collect()
    }

    /// The units of the fields, where a line is a row of units: those that are understood, in the order of the fields.
    pub fn units(&self, line: &[u8]) -> Option<Vec<Option<&'static str>>> {
        let texts = self.wanted_texts(line)?;
        are_units(&texts).then(|| texts.iter().map(|text| unit_in_any(text)).collect())
    }

    /// Takes up how many fields the first row has: names of columns that no row has, and empty fields that have no name, are left
    /// out.
    pub fn fit(&mut self, row: &[u8]) {
        let Ok(texts) = self.texts(row) else { return };
        let is_empty = |text: &Cow<[u8]>| unquoted(text).is_empty();
        self.resize(texts.len(), texts.get(self.wanted.len()..).is_some_and(|rest| rest.iter().all(is_empty)));
    }

    /// Has `columns` fields from now on, if none is lost that is wanted and others may be added.
    fn resize(&mut self, columns: usize, may_grow: bool) {
        let last = self.wanted.iter().rposition(Option::is_some).max(self.date.map(|date| date.place));
        let needed = last.map_or(0, |last| last + 1);
        if (needed..=self.wanted.len()).contains(&columns) || may_grow && columns > self.wanted.len() {
            self.wanted.resize(columns, None);
        }
    }

    /// Reads the wanted numbers of a line into `row`, in the order of the fields.
    pub fn row(&self, line: &[u8], row: &mut [f64], fields: &[Field]) -> Result<(), Fault> {
        match (self.plain_row(line, row), self.date) {
            (Some(_), _) => Ok(()),
            (None, None) => self.any_row(line, row, fields),
            (None, Some(date)) => self.dated_row(date, line, row, fields),
        }
    }

    /// Whether a `#` line is a data row whose first cell is a spreadsheet error, of any language, and not a comment. The `#` adjoins a word,
    /// the number of cells matches, and numeric columns hold numbers or such words. In a row that is commented out a number follows the `#`.
    /// A word alone ends with `!` or `?`.
    #[cold]
    pub fn is_failed_row(&self, line: &[u8]) -> bool {
        // The first bytes show most comments for what they are: a packed file may have a billion of them.
        if !matches!(line.trim_ascii_start(), [b'#', next, ..] if !matches!(next, b' ' | b'\t')) {
            return false;
        }
        let Ok(texts) = self.texts(line) else { return false };
        let Some((first, others)) = texts.split_first().filter(|_| texts.len() == self.wanted.len()) else {
            return false;
        };
        let could_stand = |text: &Cow<[u8]>| is_number(text) || is_glued(text);
        let may_stand = |(text, wanted): (&Cow<[u8]>, &Option<usize>)| wanted.is_none() || could_stand(text);
        let is_row = match others {
            [] => matches!(first.last(), Some(b'!' | b'?')),
            _ => others.iter().any(could_stand) && others.iter().zip(&self.wanted[1..]).all(may_stand),
        };
        is_row && is_glued(first)
    }

    /// Refuses a row whose first cell a spreadsheet could not compute among the `above` lines before the first row, which looks like a comment.
    pub fn check_comments(&self, text: &[u8], above: u64, fields: &[Field]) -> Result<(), (u64, Fault)> {
        let mut row = vec![0.0; fields.len()];
        let above = numbered(text).take_while(|(number, _)| *number < above);
        for (number, line) in above.filter(|(_, line)| !is_data(line) && self.is_failed_row(line)) {
            self.row(line, &mut row, fields).map_err(|fault| (number, fault))?;
        }
        Ok(())
    }

    /// What divides the fields, if it is one byte and rows may be of bare numbers.
    pub fn delimiter(&self) -> Option<u8> {
        self.of_numbers
    }

    /// For every column of the file, the wanted field that it is.
    pub fn wanted(&self) -> &[Option<usize>] {
        &self.wanted
    }

    /// The row of bare numbers that a text begins with, and the length of its line; nothing where the line is anything
    /// else, right or wrong.
    #[inline]
    pub fn plain_row(&self, text: &[u8], row: &mut [f64]) -> Option<usize> {
        let delimiter = self.delimiter().filter(|_| text.first() != Some(&b'#'))?;
        let mut at = 0;
        for (i, wanted) in self.wanted.iter().enumerate() {
            if i > 0 {
                (*text.get(at)? == delimiter).then_some(())?;
                at += 1;
            }
            let rest = text.get(at..)?;
            at += match wanted {
                Some(k) => {
                    let (number, length) = plain(rest).or_else(|| any_number(rest))?;
                    row[*k] = number;
                    length
                }
                None => memchr3(delimiter, b'"', b'\n', rest).unwrap_or(rest.len()),
            };
        }
        match &text[at..] {
            [] | [b'\r'] => Some(text.len()),
            [b'\n', ..] => Some(at + 1),
            [b'\r', b'\n', ..] => Some(at + 2),
            _ => None,
        }
    }

    /// The first field of a line, if it is a stamp.
    pub fn stamp<'a>(&self, line: &'a [u8]) -> Option<Cow<'a, [u8]>> {
        if let Some(date) = self.date.filter(|date| date.field == 0) {
            return self.dated_stamp(date, line).map(Cow::Owned);
        }
        let text = self.wanted_texts(line)?.into_iter().next()?;
        number(&text).is_none().then_some(text)
    }

    /// The row of any line: quotes, blanks, decimal commas, empty fields.
    #[cold]
    fn any_row(&self, line: &[u8], row: &mut [f64], fields: &[Field]) -> Result<(), Fault> {
        let mut rest = Some(self.delimiter.trimmed(line));
        for (i, wanted) in self.wanted.iter().enumerate() {
            let Some(text) = rest else { return Err(self.wrong_count(line, i)) };
            let field;
            (field, rest) = self.delimiter.split(text)?;
            if let Some(k) = wanted {
                row[*k] = fields[*k].value(field).map_err(|fault| self.header_again(line, fields).unwrap_or(fault))?;
            }
        }
        // Some loggers end every row, but not the header, with a delimiter.
        match rest {
            None | Some([]) => Ok(()),
            Some(_) => Err(self.wrong_count(line, self.delimiter.texts(line)?.len())),
        }
    }

    /// The row of any line with a date: its time of the day is on that date.
    fn dated_row(&self, date: DateColumn, line: &[u8], row: &mut [f64], fields: &[Field]) -> Result<(), Fault> {
        self.any_row(line, row, fields)?;
        let stamp = self.dated_stamp(date, line).unwrap_or_default();
        let expected = "a date and a time of the day, such as 2026-10-05 and 10:00:00.25";
        let wrong = || fields[date.field].fault(quoted(&stamp), expected);
        row[date.field] = stamp::dated_seconds(&stamp).ok_or_else(wrong)?;
        Ok(())
    }

    /// The date and the time of the day of a line as one stamp.
    fn dated_stamp(&self, date: DateColumn, line: &[u8]) -> Option<Vec<u8>> {
        let texts = self.texts(line).ok()?;
        let time = self.wanted.iter().position(|own| *own == Some(date.field))?;
        Some(stamp::joined(texts.get(date.place)?, texts.get(time)?))
    }

    /// What is wrong with a line that has the names of the columns in place of their numbers, as where files were put together.
    fn header_again(&self, line: &[u8], fields: &[Field]) -> Option<Fault> {
        let texts = self.wanted_texts(line.strip_prefix("\u{feff}".as_bytes()).unwrap_or(line))?;
        let is_name = |(field, text): (&Field, &Cow<[u8]>)| match field.name.date_and_column().1 {
            ColumnName::Name(name) => name.as_bytes() == &*unquoted(text),
            _ => false,
        };
        fields.iter().zip(&texts).all(is_name).then(|| Fault {
            column: None,
            found: "the names of the columns again".to_owned(),
            expected: "a row of numbers (two files in one?)".to_owned(),
        })
    }

    fn wrong_count(&self, line: &[u8], found: usize) -> Fault {
        let expected = format!("{} as in the first line", self.wanted.len());
        Fault { column: None, found: format!("{found} fields in {}", quoted(line)), expected }
    }
}

/// Whether a cell is a `#` glued to a word that is no number.
fn is_glued(cell: &[u8]) -> bool {
    let Some(word) = cell.strip_prefix(b"#") else { return false };
    let number = word.iter().position(|byte| *byte != b'#').map_or(&word[..0], |start| &word[start..]);
    !matches!(word.first(), None | Some(b' ' | b'\t')) && !is_number(number)
}

/// The number in a record that a text starts with, and its length.
fn any_number(text: &[u8]) -> Option<(f64, usize)> {
    let (number, length) = fast_float2::parse_partial(text).ok()?;
    Some((plausible(number)?, length))
}

/// A number that can stand in a record: finite, and of a size that can be squared.
#[inline]
fn plausible(number: f64) -> Option<f64> {
    (number.abs() <= LARGEST_NUMBER).then_some(number)
}
