//! Where the wanted numbers stand in a line, told by the first line of the table.

use std::borrow::Cow;

use memchr::{memchr, memchr2, memchr3};

use super::batch::{Batch, ROWS};
use super::number::plain;
use crate::column::{ColumnName, Field, LARGEST, Rule};
use crate::error::quoted;
use crate::rows::Rows;
use crate::stamp;

/// What stands wrong in a line.
pub(super) struct Fault {
    /// Name of the column, where one is meant.
    pub column: Option<String>,
    pub found: String,
    pub expected: String,
}

/// The lines before the first row.
#[derive(Default)]
pub(super) struct Prologue {
    /// The last comment without its `#`: some programs write the header so.
    comment: Vec<u8>,
}

/// What the first line tells.
pub(super) struct FirstLine {
    pub layout: Layout,
    /// Whether that line holds the names rather than the first row.
    pub is_header: bool,
}

/// Where the wanted numbers stand in a line.
#[derive(Debug, Clone)]
pub(super) struct Layout {
    delimiter: Delimiter,
    /// For every column of the file, the wanted field that it is.
    wanted: Vec<Option<usize>>,
}

/// What divides the fields of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Delimiter {
    Byte(u8),
    /// Any number of spaces and tabs.
    Blanks,
}

impl Prologue {
    /// Notes a line that is a comment, or blank.
    pub fn comment(&mut self, line: &[u8]) {
        if let Some(text) = line.trim_ascii_start().strip_prefix(b"#") {
            self.comment = text.to_vec();
        }
    }

    /// What the first line that is neither blank nor a comment tells of the table.
    pub fn first_line(&self, line: &[u8], fields: &[Field]) -> Result<FirstLine, Fault> {
        let delimiter = Delimiter::of(line);
        let names = delimiter.texts(line)?;
        let by_name = fields.iter().any(|field| matches!(field.name, ColumnName::Name(_)));
        let named = |names: &[Cow<[u8]>]| names.iter().any(|name| fields.iter().any(|field| field.is(name)));
        let is_header = named(&names) || !names.iter().any(|name| number(name).is_some());
        let names = if by_name && !is_header { Delimiter::of(&self.comment).texts(&self.comment)? } else { names };
        let columns = if by_name && !is_header { delimiter.texts(line)?.len() } else { names.len() };
        if by_name && !is_header && !named(&names) {
            let expected = "the names of the columns (for a file without them give [columns] by number)";
            return Err(Fault { column: None, found: quoted(line), expected: expected.to_owned() });
        }
        let mut wanted = vec![None; columns];
        for (k, field) in fields.iter().enumerate() {
            let place = field.find(&names, columns)?;
            if wanted[place].is_some() {
                let found = format!("column {} asked for twice", place + 1);
                return Err(field.fault(found, "a column of its own for every quantity"));
            }
            wanted[place] = Some(k);
        }
        Ok(FirstLine { layout: Layout { delimiter, wanted }, is_header })
    }
}

impl Field {
    fn is(&self, name: &[u8]) -> bool {
        matches!(&self.name, ColumnName::Name(own) if own.as_bytes() == name)
    }

    /// The only place of this field among the names of the columns.
    fn find(&self, names: &[Cow<[u8]>], columns: usize) -> Result<usize, Fault> {
        if let ColumnName::Number(number) = self.name {
            let found = format!("{columns} columns");
            return number
                .checked_sub(1)
                .filter(|i| *i < columns)
                .ok_or_else(|| self.fault(found, "that many columns"));
        }
        let list = || quoted(&names.join(&b", "[..]));
        let mut places = (0..columns.min(names.len())).filter(|i| self.is(&names[*i]));
        match (places.next(), places.next()) {
            (Some(place), None) => Ok(place),
            (Some(_), Some(_)) => Err(self.fault(format!("two such columns in {}", list()), "one")),
            (None, _) => Err(self.fault(format!("columns {}", list()), "a column of this name")),
        }
    }

    /// The value of this field from a field of a line.
    fn value(&self, text: &[u8]) -> Result<f64, Fault> {
        let text = unquoted(text);
        let stamp = || if self.rule == (Rule::Ascending { stamps: true }) { stamp::seconds(&text) } else { None };
        match number(&text).or_else(stamp).and_then(plausible) {
            Some(number) => Ok(number),
            None if self.rule == Rule::OrMissing && text.is_empty() => Ok(f64::NAN),
            None => Err(self.fault(quoted(&text), &self.expected)),
        }
    }

    fn fault(&self, found: String, expected: &str) -> Fault {
        Fault { column: Some(self.name.to_string()), found, expected: expected.to_owned() }
    }
}

impl Layout {
    /// Reads the wanted numbers of a line into `row`, in the order of the fields.
    pub fn row(&self, line: &[u8], row: &mut [f64], fields: &[Field]) -> Result<(), Fault> {
        match self.plain_row(line, row) {
            Some(_) => Ok(()),
            None => self.any_row(line, row, fields),
        }
    }

    /// What divides the fields, if it is one byte.
    pub fn delimiter(&self) -> Option<u8> {
        match self.delimiter {
            Delimiter::Byte(delimiter) => Some(delimiter),
            Delimiter::Blanks => None,
        }
    }

    /// Fields in a row.
    pub fn fields(&self) -> usize {
        self.wanted.len()
    }

    /// Reads rows of bare numbers, [`ROWS`] at most, that begin at `from`, have these separators and end at these; nothing where
    /// one of them is anything else, right or wrong.
    pub fn batch(
        &self,
        text: &[u8],
        from: usize,
        separators: &[u32],
        ends: &[u32],
        batch: &mut Batch,
        rows: &mut Rows,
    ) -> Option<()> {
        let all = &text[from..*separators.last()? as usize];
        // A delimiter within quotes divides nothing.
        if text[from] == b'#' || self.wanted.contains(&None) && memchr2(b'"', b'#', all).is_some() {
            return None;
        }
        // All of the lines end alike, or this is not for numbers that are taken together.
        let with_return = all.ends_with(b"\r");
        let is_return = |end: &u32| text[(*end as usize).wrapping_sub(1)] == b'\r';
        if with_return && !ends.iter().all(is_return) {
            return None;
        }
        let before = rows[0].len();
        batch.column.begin(u32::try_from(from).ok()?, ends);
        for (column, field) in self.wanted.iter().enumerate() {
            batch.column.go_on(separators.chunks_exact(self.wanted.len()).map(|line| line[column]));
            let is_last = column + 1 == self.wanted.len();
            // If each line's last separator ends it, no other one does.
            let mut is_plain = !is_last || batch.column.ends_at(ends);
            if let Some(field) = field {
                let values = &mut rows[*field];
                values.resize(before + ROWS, 0.0);
                let left_out = u32::from(is_last && with_return);
                let numbers = values[before..].first_chunk_mut();
                is_plain = is_plain && numbers.is_some_and(|numbers| batch.read(text, left_out, numbers));
                values.truncate(before + ends.len());
            }
            if !is_plain {
                for values in rows.iter_mut() {
                    values.truncate(before);
                }
                return None;
            }
        }
        Some(())
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

    /// The row of any line: quotes, blanks, decimal commas, empty fields.
    #[cold]
    fn any_row(&self, line: &[u8], row: &mut [f64], fields: &[Field]) -> Result<(), Fault> {
        let mut rest = Some(self.delimiter.trimmed(line));
        for (i, wanted) in self.wanted.iter().enumerate() {
            let Some(text) = rest else { return Err(self.wrong_count(line, i)) };
            let field;
            (field, rest) = self.delimiter.split(text)?;
            if let Some(k) = wanted {
                row[*k] = fields[*k].value(field)?;
            }
        }
        // Some loggers end every row, but not the header, with a delimiter.
        match rest {
            None | Some([]) => Ok(()),
            Some(_) => Err(self.wrong_count(line, self.delimiter.texts(line)?.len())),
        }
    }

    fn wrong_count(&self, line: &[u8], found: usize) -> Fault {
        let expected = format!("{} as in the first line", self.wanted.len());
        Fault { column: None, found: format!("{found} fields in {}", quoted(line)), expected }
    }
}

impl Delimiter {
    /// The delimiter of a line: the first of `;`, tab, `,` that occurs outside quotes, or else blanks.
    fn of(line: &[u8]) -> Self {
        let mut inside = false;
        let outside: Vec<u8> = line
            .iter()
            .copied()
            .filter(|byte| {
                inside ^= *byte == b'"';
                !inside
            })
            .collect();
        let decimal_commas =
            || outside.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty()).all(|w| number(w).is_some());
        match [b';', b'\t', b','].into_iter().find(|byte| outside.trim_ascii().contains(byte)) {
            Some(b',') if outside.trim_ascii().contains(&b' ') && decimal_commas() => Self::Blanks,
            Some(byte) => Self::Byte(byte),
            None => Self::Blanks,
        }
    }

    /// A line without what stands before its first field and after its last.
    #[inline]
    fn trimmed(self, line: &[u8]) -> &[u8] {
        if self == Self::Blanks { line.trim_ascii() } else { line }
    }

    /// The first field as it is written, and the rest of the line, if there is any.
    fn split(self, text: &[u8]) -> Result<(&[u8], Option<&[u8]>), Fault> {
        let start = text.len() - text.trim_ascii_start().len();
        let quote = if text[start..].first() == Some(&b'"') { end_of_quote(text, start)? } else { 0 };
        let open = &text[quote..];
        let end = match self {
            Self::Byte(delimiter) => memchr(delimiter, open),
            Self::Blanks => open.iter().position(u8::is_ascii_whitespace),
        };
        let (field, after) = text.split_at(end.map_or(text.len(), |end| quote + end));
        let rest = after.get(1..).map(|rest| if self == Self::Blanks { rest.trim_ascii_start() } else { rest });
        Ok((field, rest))
    }

    /// All fields of a line, without quotes and blanks around.
    fn texts(self, line: &[u8]) -> Result<Vec<Cow<'_, [u8]>>, Fault> {
        let mut texts = Vec::new();
        let mut rest = Some(self.trimmed(line));
        while let Some(text) = rest {
            let field;
            (field, rest) = self.split(text)?;
            texts.push(unquoted(field));
        }
        Ok(texts)
    }
}

/// Place after the quote that closes the one at `start`; a quote inside is doubled.
fn end_of_quote(text: &[u8], start: usize) -> Result<usize, Fault> {
    let mut at = start + 1;
    while let Some(quote) = memchr(b'"', &text[at..]) {
        at += quote + 1;
        if text.get(at) != Some(&b'"') {
            return Ok(at);
        }
        at += 1;
    }
    Err(Fault { column: None, found: quoted(text), expected: "a closing quote".to_owned() })
}

/// A field without quotes and blanks around it.
fn unquoted(field: &[u8]) -> Cow<'_, [u8]> {
    let field = field.trim_ascii();
    match field.strip_prefix(b"\"").and_then(|f| f.strip_suffix(b"\"")) {
        Some(inner) => {
            let text = String::from_utf8_lossy(inner).replace("\"\"", "\"");
            Cow::Owned(text.trim().as_bytes().to_vec())
        }
        None => Cow::Borrowed(field),
    }
}

/// The number in a record that a text starts with, and its length.
fn any_number(text: &[u8]) -> Option<(f64, usize)> {
    let (number, length) = fast_float2::parse_partial(text).ok()?;
    Some((plausible(number)?, length))
}

/// A number that can stand in a record: finite, and of a size that can be squared.
#[inline]
fn plausible(number: f64) -> Option<f64> {
    (number.abs() <= LARGEST).then_some(number)
}

/// A number with a decimal point or, as the delimiter can not be inside a field, a decimal comma.
fn number(text: &[u8]) -> Option<f64> {
    if !text.contains(&b',') {
        return fast_float2::parse(text).ok();
    }
    let point: Vec<u8> = text.iter().map(|byte| if *byte == b',' { b'.' } else { *byte }).collect();
    fast_float2::parse(point).ok()
}
