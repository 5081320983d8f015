//! A piece of text: from its lines to rows of numbers, up to the first fault.

use memchr::{memchr, memchr_iter, memrchr};

use super::batch::{self, Batch, ROWS};
use super::fields::Fault;
use super::layout::Layout;
use super::lines::{self, Text};
use super::prologue::{Line, MOST_ABOVE, Prologue, Start};
use super::separators::Separators;
use crate::column::{ASCENDING, Field, Rows, runs_backwards};
use crate::stamp::Stamps;

/// A piece on its way from the file to the rows.
#[derive(Default)]
pub(super) struct Piece {
    pub text: Text,
    /// Lines read without a fault.
    pub lines: u64,
    /// The line of the first row, counted within the piece from 0.
    pub first_row: u64,
    /// What stands wrong, and in which line of the piece.
    pub fault: Option<(u64, Fault)>,
    /// Stamps as they are written, if they are kept.
    pub stamps: Stamps,
    pub keeps_stamps: bool,
    separators: Separators,
    batch: Batch,
}

impl Piece {
    /// Reads the rows of the text after its first `skipped` lines, up to the first fault.
    pub fn read(&mut self, layout: &Layout, skipped: u64, fields: &[Field], rows: &mut Rows) {
        rows.iter_mut().for_each(Vec::clear);
        let whole = std::mem::take(&mut self.text);
        let mut text = &*whole;
        for _ in 0..skipped {
            text = split_line(text).1;
        }
        (self.lines, self.first_row, self.fault) = (skipped, skipped, None);
        self.stamps = Stamps::default();
        if let Some(delimiter) = layout.delimiter() {
            self.separators.find(text, delimiter);
        }
        if let Some((at, found)) = lines::endless_line(text) {
            self.fault = Some((skipped + at, Fault::no_table(found)));
            text = &text[..lines::before_line(text, at)];
        }
        self.fault = self.read_batches(text, layout, fields, rows).err().or(self.fault.take());
        self.text = whole;
        self.check_times(skipped, fields, rows);
    }

    /// Reads rows of bare numbers, many at a time, and others one by one, up to the first fault.
    fn read_batches(
        &mut self,
        text: &[u8],
        layout: &Layout,
        fields: &[Field],
        rows: &mut Rows,
    ) -> Result<(), (u64, Fault)> {
        if layout.delimiter().is_none() {
            return self.read_rows(text, layout, fields, rows);
        }
        let of_text = std::mem::take(&mut self.separators);
        let [mut separators, mut ends] = of_text.places();
        let mut from = 0;
        let read = loop {
            // A number is taken with what is before it: the first ones of all are left to be read one by one.
            let most = if from < batch::REACH { 1 } else { ROWS };
            let blank = self.skip_blank(&text[from..], rows);
            if blank > 0 {
                from += blank;
                let passed = |places: &[u32]| places.partition_point(|place| (*place as usize) < from);
                (separators, ends) = (&separators[passed(separators)..], &ends[passed(ends)..]);
            }
            let count = most.min(separators.len() / layout.fields()).min(ends.len());
            let (of_batch, ends_of_batch) = (&separators[..count * layout.fields()], &ends[..count]);
            // Of a text that is read up to a fault, some are beyond it.
            if of_batch.last().is_none_or(|last| *last as usize >= text.len()) {
                break self.read_rows(&text[from..], layout, fields, rows);
            }
            if layout.batch(text, from, of_batch, ends_of_batch, &mut self.batch, rows).is_some() {
                self.lines += count as u64;
                from = of_batch[of_batch.len() - 1] as usize + 1;
                (separators, ends) = (&separators[of_batch.len()..], &ends[count..]);
                continue;
            }
            // As many lines: one may have more separators than it should, or fewer.
            let rest = text.len().min(ends_of_batch[count - 1] as usize + 1);
            if let Err(fault) = self.read_rows(&text[from..rest], layout, fields, rows) {
                break Err(fault);
            }
            let left = |places: &[u32]| places.partition_point(|place| (*place as usize) < rest);
            (separators, ends) = (&separators[left(separators)..], &ends[left(ends)..]);
            from = rest;
        };
        self.separators = of_text;
        read
    }

    /// Passes the blank lines that a text begins with, and returns their bytes. Many at once: a packed file may have billions.
    fn skip_blank(&mut self, text: &[u8], rows: &Rows) -> usize {
        let is_blank = |byte: &u8| matches!(byte, b'\n' | b'\r' | b' ' | b'\t');
        let blank = text.iter().position(|byte| !is_blank(byte)).unwrap_or(text.len());
        let bytes = memrchr(b'\n', &text[..blank]).map_or(0, |end| end + 1);
        let lines = memchr_iter(b'\n', &text[..bytes]).count() as u64;
        self.lines += lines;
        self.first_row += if rows[0].is_empty() { lines } else { 0 };
        bytes
    }

    /// Reads the rows of a text one by one, up to the first fault.
    fn read_rows(
        &mut self,
        mut text: &[u8],
        layout: &Layout,
        fields: &[Field],
        rows: &mut Rows,
    ) -> Result<(), (u64, Fault)> {
        let mut row = vec![0.0; fields.len()];
        while !text.is_empty() {
            text = &text[self.skip_blank(text, rows)..];
            if text.is_empty() {
                break;
            }
            let (line, rest) = split_line(text);
            if let Some(length) = layout.plain_row(text, &mut row) {
                text = &text[length..];
            } else if is_data(line) || layout.is_failed_row(line) {
                layout.row(line, &mut row, fields).map_err(|fault| (self.lines, fault))?;
                if self.keeps_stamps
                    && let Some(stamp) = layout.stamp(line)
                {
                    self.stamps.push(rows[0].len(), &stamp);
                }
                text = rest;
            } else {
                self.first_row += u64::from(rows[0].is_empty());
                self.lines += 1;
                text = rest;
                continue;
            }
            self.lines += 1;
            rows.iter_mut().zip(&row).for_each(|(column, value)| column.push(*value));
        }
        Ok(())
    }

    /// Sees that what should ascend does, row after row.
    fn check_times(&mut self, skipped: u64, fields: &[Field], rows: &Rows) {
        for (field, column) in fields.iter().zip(rows).filter(|(field, _)| field.rule.ascends()) {
            if runs_backwards(column)
                && let Some(row) = column.windows(2).position(|pair| pair[1] < pair[0])
            {
                let found = format!("{} after {}", column[row + 1], column[row]);
                let fault = Fault { column: Some(field.name.to_string()), found, expected: ASCENDING.to_owned() };
                self.fault = Some((self.line_of(row + 1, skipped), fault));
            }
        }
    }

    /// The line of a row, both counted from 0.
    #[cold]
    fn line_of(&self, row: usize, skipped: u64) -> u64 {
        let (mut text, mut line) = (&*self.text, 0);
        let mut left = row;
        while !text.is_empty() {
            let (this, rest) = split_line(text);
            if line >= skipped && is_data(this) {
                if left == 0 {
                    break;
                }
                left -= 1;
            }
            (text, line) = (rest, line + 1);
        }
        line
    }
}

impl Fault {
    pub fn no_table(found: String) -> Self {
        Self { column: None, found, expected: lines::TABLE.to_owned() }
    }
}

impl Prologue {
    /// Reads the lines before the first row, `first` lines of the file being before the text; nothing if there are only comments.
    pub fn read(&mut self, text: &[u8], first: u64, fields: &[Field]) -> Result<Option<Start>, (u64, Fault)> {
        let (mut rest, mut number) = (text, 0);
        let mut lines = Vec::new();
        while !rest.is_empty() && lines.len() <= MOST_ABOVE {
            let line;
            (line, rest) = split_line(rest);
            if is_data(line) {
                lines.push((number, line));
            } else if lines.is_empty() {
                self.comment(line);
            }
            number += 1;
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
}

impl Layout {
    /// Refuses a row whose first cell a spreadsheet could not compute among the `above` lines before the first row, which looks like a comment.
    fn check_comments(&self, text: &[u8], above: u64, fields: &[Field]) -> Result<(), (u64, Fault)> {
        let (mut rest, mut row) = (text, vec![0.0; fields.len()]);
        for number in 0..above {
            let line;
            (line, rest) = split_line(rest);
            if !is_data(line) && self.is_failed_row(line) {
                self.row(line, &mut row, fields).map_err(|fault| (number, fault))?;
            }
        }
        Ok(())
    }
}

/// The first lines of a text that are neither blank nor comments, with their numbers from 0.
pub(super) fn data_lines(text: &[u8]) -> Vec<Line<'_>> {
    let (mut rest, mut number) = (text, 0);
    let mut lines = Vec::new();
    while !rest.is_empty() {
        let line;
        (line, rest) = split_line(rest);
        lines.extend(is_data(line).then_some((number, line)));
        number += 1;
    }
    lines
}

/// The first line without its end, and the rest.
#[inline]
fn split_line(text: &[u8]) -> (&[u8], &[u8]) {
    let (line, rest) = match memchr(b'\n', text) {
        Some(end) => (&text[..end], &text[end + 1..]),
        None => (text, &text[text.len()..]),
    };
    (line.strip_suffix(b"\r").unwrap_or(line), rest)
}

/// Whether a line is neither blank nor a comment.
#[inline]
fn is_data(line: &[u8]) -> bool {
    match line.first() {
        None => false,
        Some(b'#') => is_failed_cell(line),
        // A row of a spreadsheet in which nothing stands.
        Some(b';' | b',' | b'"') => !is_empty_row(line),
        Some(b' ' | b'\t') => {
            let text = line.trim_ascii_start();
            !text.is_empty() && (text[0] != b'#' || is_failed_cell(text)) && !is_empty_row(text)
        }
        Some(_) => true,
    }
}

/// Whether nothing but delimiters stands in a line.
fn is_empty_row(line: &[u8]) -> bool {
    line.iter().all(|byte| matches!(byte, b';' | b',' | b'\t' | b' ' | b'"'))
}

/// Whether a text that starts with `#` is not a comment but a row whose first cell a spreadsheet could not compute, as its first word alone
/// shows; [`Layout::is_failed_row`] knows the other ones.
#[cold]
fn is_failed_cell(text: &[u8]) -> bool {
    const FAILED: [&[u8]; 8] = [b"#N/A", b"#NUM!", b"#VALUE!", b"#DIV/0!", b"#REF!", b"#NAME?", b"#NULL!", b"#CALC!"];
    let begins = |cell: &[u8]| {
        let rest = text.get(..cell.len()).filter(|start| start.eq_ignore_ascii_case(cell)).map(|_| &text[cell.len()..]);
        rest.is_some_and(|rest| rest.first().is_none_or(|next| matches!(next, b',' | b';' | b'\t' | b' ' | b'"')))
    };
    FAILED.into_iter().any(begins)
}
