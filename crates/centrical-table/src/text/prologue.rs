//! The lines before the first row: lines above the header, the header, a row of units.
//!
//! The header is the first line that has the names of all columns that are asked for, in whatever encoding it is. Lines above it
//! are skipped. Without names the table begins with the first line that has numbers in those columns. No line that could be a row is
//! ever skipped.

use std::borrow::Cow;

use super::encoding::TextEncoding;
use super::fields::{Delimiter, Fault, number};
use super::layout::{DateColumn, Layout};
use super::lines::{Line, is_data, numbered};
use super::shape::{Shape, after_preamble, is_number};
use super::unit_words::name_and_unit;
use crate::column::{ColumnName, Field, TableLines, UnitsFound};
use crate::error::quoted;

/// Lines in which a header is looked for.
const MOST_ABOVE: usize = 1000;

/// The lines before the first row.
pub(super) struct Prologue {
    /// The last comment without its `#`: some programs write the header so.
    comment: Vec<u8>,
    /// Where the header and the first row are, if settings say so.
    said: TableLines,
}

/// What stands before the first row.
pub(super) struct Start {
    pub layout: Layout,
    /// Whether one of the lines before the first row holds the names.
    has_header: bool,
    /// Lines of the text before the first row.
    pub skipped: u64,
    pub units: Option<UnitsFound>,
}

/// The header, or the first row of a text without a header.
struct FirstLine {
    layout: Layout,
    /// Whether that line holds the names rather than the first row.
    is_header: bool,
    /// Units beside the names.
    units: Vec<Option<&'static str>>,
}

impl Prologue {
    /// The lines before the first row, or before the row that settings name.
    pub fn at(said: TableLines) -> Self {
        Self { comment: Vec::new(), said }
    }

    /// Reads the lines before the first row, `first` lines of the file being before the text; nothing if there are only comments.
    pub fn read(&mut self, text: &[u8], first: u64, fields: &[Field]) -> Result<Option<Start>, (u64, Fault)> {
        let mut lines: Vec<Line> = Vec::new();
        for (number, line) in numbered(text) {
            if lines.len() > MOST_ABOVE {
                break;
            }
            if is_data(line) {
                lines.push((number, line));
            } else if lines.is_empty() {
                self.comment(line);
            }
        }
        if lines.is_empty() {
            return Ok(None);
        }
        let start = self.start(&lines, first, fields)?;
        if !start.has_header {
            start.layout.check_comments(text, start.skipped, fields)?;
        }
        Ok(Some(start))
    }

    /// Notes a comment.
    fn comment(&mut self, line: &[u8]) {
        if let Some(text) = line.trim_ascii_start().strip_prefix(b"#") {
            self.comment = text.to_vec();
        }
    }

    /// Finds the first row of a text from its first lines. `first` is the number of the first of all lines in the file, from 0.
    fn start(&self, lines: &[Line], first: u64, fields: &[Field]) -> Result<Start, (u64, Fault)> {
        let lines = &lines[..lines.len().min(MOST_ABOVE)];
        let at = |index: usize| move |fault| (lines[index].0, fault);
        let begin = self.begin(lines, first, fields)?;
        let mut start = self.first_line(lines[begin].1, fields).map_err(at(begin))?;
        let (mut units, mut skipped) = (None, lines[begin].0 + u64::from(start.is_header));
        if start.is_header {
            if start.units.iter().any(Option::is_some) {
                units = Some(UnitsFound { line: first + lines[begin].0 + 1, units: std::mem::take(&mut start.units) });
            }
            let below = lines.get(begin + 1);
            if let Some((line, found)) = below.and_then(|(line, text)| Some((line, start.layout.units(text)?))) {
                units = Some(UnitsFound { line: first + line + 1, units: found });
                skipped = line + 1;
            }
            if let Some(row) = self.said.first_row {
                skipped = row.saturating_sub(first + 1).max(skipped);
            }
            if let Some((_, row)) = lines.iter().find(|(line, _)| *line >= skipped) {
                start.layout.fit(row);
            }
        }
        Ok(Start { layout: start.layout, has_header: start.is_header, skipped, units })
    }

    /// The index of the header, or of the first row.
    fn begin(&self, lines: &[Line], first: u64, fields: &[Field]) -> Result<usize, (u64, Fault)> {
        if let Some(said) = self.said.header.or(self.said.first_row) {
            let is_there = |(line, _): &Line| first + line + 1 == said;
            return lines.iter().position(is_there).ok_or_else(|| {
                let found = format!("no line {said} with text in it among the first {MOST_ABOVE}");
                let expected = "the line that header_line or first_row of [columns] names".to_owned();
                (0, Fault { column: None, found, expected })
            });
        }
        let texts: Vec<&[u8]> = lines.iter().map(|(_, line)| *line).collect();
        if fields.iter().any(|field| field.name.is_named()) {
            return Ok(self.header(&texts, fields));
        }
        let above = after_preamble(&texts);
        let row = |line: &&[u8]| could_be_row(line, fields);
        Ok(texts[above..].iter().position(row).map_or(0, |place| above + place))
    }

    /// The index of the line with the names; of the line that is most like it if none has all of them.
    fn header(&self, lines: &[&[u8]], fields: &[Field]) -> usize {
        let count = |line: &[u8]| {
            let Ok(names) = Delimiter::of(line).texts(line) else { return 0 };
            decodings(&names)
                .map(|names| fields.iter().filter(|field| field.name.is_among(&names)).count())
                .max()
                .unwrap_or(0)
        };
        let wanted = fields.iter().filter(|field| field.name.is_named()).count();
        if let Some(header) = lines.iter().position(|line| count(line) == wanted) {
            return header;
        }
        if count(&self.comment) > 0 {
            return 0;
        }
        // For the message: what is wrong with this line is what is wrong with the file.
        let most = lines.iter().enumerate().rev().max_by_key(|(_, line)| count(line));
        match most.filter(|(_, line)| count(line) > 0) {
            Some((header, _)) => header,
            None => Shape::of(lines).and_then(|shape| shape.header).unwrap_or(0),
        }
    }

    /// What the header, or the first row, shows of the table.
    fn first_line(&self, line: &[u8], fields: &[Field]) -> Result<FirstLine, Fault> {
        let delimiter = Delimiter::of(line);
        let names = delimiter.texts(line)?;
        let by_name = fields.iter().any(|field| field.name.is_named());
        let named =
            |names: &[Cow<[u8]>]| decodings(names).any(|names| fields.iter().any(|field| field.name.is_among(&names)));
        let is_header = named(&names) || !names.iter().any(|name| number(name).is_some());
        let of_comment = Delimiter::of(&self.comment).texts(&self.comment);
        let (names, columns) =
            if by_name && !is_header { (of_comment?, names.len()) } else { (names.clone(), names.len()) };
        if by_name && !is_header && !named(&names) {
            let expected = "the names of the columns (for a file without them give [columns] by number)";
            return Err(Fault { column: None, found: quoted(line), expected: expected.to_owned() });
        }
        let names = best_decoding(&names, fields);
        let mut wanted = vec![None; columns];
        let mut units = vec![None; fields.len()];
        let mut date = None;
        for (k, field) in fields.iter().enumerate() {
            let (date_name, name) = field.name.date_and_column();
            let place = field.find(name, &names, columns)?;
            if let Some(name) = date_name {
                date = Some(DateColumn { place: field.find(name, &names, columns)?, field: k });
            }
            if wanted[place].is_some() || date.is_some_and(|date| date.place == place) {
                let found = format!("column {} asked for twice", place + 1);
                return Err(field.fault(found, "a column of its own for every quantity"));
            }
            wanted[place] = Some(k);
            units[k] = names.get(place).and_then(|name| Some(name_and_unit(name)?.1));
        }
        Ok(FirstLine { layout: Layout::new(delimiter, wanted, date), is_header, units })
    }
}

/// Whether a line without names can be a row: the first column that is asked for, or all others, are numbers there.
fn could_be_row(line: &[u8], fields: &[Field]) -> bool {
    let Ok(texts) = Delimiter::of(line).texts(line) else { return false };
    let mut places = fields.iter().map(|field| match field.name.date_and_column().1 {
        ColumnName::Number(number) => texts.get(number.wrapping_sub(1)).is_some_and(|text| is_number(text)),
        _ => false,
    });
    let first = places.next().unwrap_or(false);
    first || fields.len() > 1 && places.all(|is_number| is_number)
}

/// The names in every encoding in which they can be.
fn decodings<'a>(names: &'a [Cow<[u8]>]) -> impl Iterator<Item = Vec<Cow<'a, str>>> {
    let guess = TextEncoding::of_bytes(&names.join(&b' '));
    let others = TextEncoding::OF_BYTES.into_iter().filter(move |other| guess != TextEncoding::Utf8 && *other != guess);
    std::iter::once(guess).chain(others).map(|encoding| names.iter().map(|name| encoding.decode(name)).collect())
}

/// The names in the encoding in which most of the fields are among them.
fn best_decoding<'a>(names: &'a [Cow<[u8]>], fields: &[Field]) -> Vec<Cow<'a, str>> {
    let found = |names: &Vec<Cow<str>>| fields.iter().filter(|field| field.name.is_among(names)).count();
    let mut best: Option<(usize, Vec<Cow<str>>)> = None;
    for names in decodings(names) {
        let found = found(&names);
        if best.as_ref().is_none_or(|(most, _)| found > *most) {
            best = Some((found, names));
        }
    }
    best.map(|(_, names)| names).unwrap_or_default()
}

impl ColumnName {
    /// Whether the column of this name is there.
    fn is_among(&self, names: &[Cow<str>]) -> bool {
        if let Self::DateAndTime(parts) = self {
            return parts.iter().all(|part| part.is_among(names));
        }
        names.iter().any(|name| self.is(name)) || names.iter().any(|name| self.is_base_of(name))
    }

    fn is(&self, name: &str) -> bool {
        matches!(self, Self::Name(own) if own == name)
    }

    /// Whether a name is this one with a unit behind it.
    fn is_base_of(&self, name: &str) -> bool {
        name_and_unit(name).is_some_and(|(name, _)| self.is(name))
    }
}

impl Field {
    /// The only place of a column of this field among the names of the columns.
    fn find(&self, column: &ColumnName, names: &[Cow<str>], columns: usize) -> Result<usize, Fault> {
        let wrong =
            |found: String, expected: &str| Fault { column: Some(column.to_string()), ..self.fault(found, expected) };
        if let ColumnName::Number(number) = column {
            let found = format!("{columns} columns");
            return number.checked_sub(1).filter(|i| *i < columns).ok_or_else(|| wrong(found, "that many columns"));
        }
        let list = || quoted(names.join(", ").as_bytes());
        let all = 0..columns.min(names.len());
        let mut places = all.clone().filter(|i| column.is(&names[*i])).collect::<Vec<_>>();
        if places.is_empty() {
            places = all.filter(|i| column.is_base_of(&names[*i])).collect();
        }
        match places.as_slice() {
            [place] => Ok(*place),
            [] => Err(wrong(format!("columns {}", list()), "a column of this name")),
            _ => Err(wrong(format!("two such columns in {}", list()), "one")),
        }
    }
}
