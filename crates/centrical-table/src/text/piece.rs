//! A piece of text: from its lines to rows of numbers, up to the first fault.

use memchr::{memchr_iter, memchr2, memrchr};

use super::fields::Fault;
use super::layout::Layout;
use super::lines::{self, Text, is_data, numbered, split_line};
use super::number::{self, Batch, ROWS};
use super::separators::Separators;
use crate::column::{Backwards, Field, Rows, runs_backwards};
use crate::stamp::{self, StampKind, Stamps};

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
        self.check_times(layout, skipped, fields, rows);
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
        let (mut from, wanted) = (0, layout.wanted());
        let read = loop {
            // A number is taken with what is before it: the first ones of all are left to be read one by one.
            let most = if from < number::REACH { 1 } else { ROWS };
            let blank = self.skip_blank(&text[from..], rows);
            if blank > 0 {
                from += blank;
                let passed = |places: &[u32]| places.partition_point(|place| (*place as usize) < from);
                (separators, ends) = (&separators[passed(separators)..], &ends[passed(ends)..]);
            }
            let count = most.min(separators.len() / wanted.len()).min(ends.len());
            let (of_batch, ends_of_batch) = (&separators[..count * wanted.len()], &ends[..count]);
            // Of a text that is read up to a fault, some are beyond it.
            if of_batch.last().is_none_or(|last| *last as usize >= text.len()) {
                break self.read_rows(&text[from..], layout, fields, rows);
            }
            if self.read_batch(wanted, text, from, of_batch, ends_of_batch, rows).is_some() {
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

    /// Reads rows of bare numbers, [`ROWS`] at most, that begin at `from`, have these separators and end at these; nothing where
    /// one of them is anything else, right or wrong.
    fn read_batch(
        &mut self,
        wanted: &[Option<usize>],
        text: &[u8],
        from: usize,
        separators: &[u32],
        ends: &[u32],
        rows: &mut Rows,
    ) -> Option<()> {
        let all = &text[from..*separators.last()? as usize];
        // A delimiter within quotes divides nothing.
        if text[from] == b'#' || wanted.contains(&None) && memchr2(b'"', b'#', all).is_some() {
            return None;
        }
        // All of the lines end alike, or this is not for numbers that are taken together.
        let with_return = all.ends_with(b"\r");
        let is_return = |end: &u32| text[(*end as usize).wrapping_sub(1)] == b'\r';
        if with_return && !ends.iter().all(is_return) {
            return None;
        }
        let before = rows[0].len();
        self.batch.column.begin(u32::try_from(from).ok()?, ends);
        for (column, field) in wanted.iter().enumerate() {
            self.batch.column.go_on(separators.chunks_exact(wanted.len()).map(|line| line[column]));
            let is_last = column + 1 == wanted.len();
            // If each line's last separator ends it, no other one does.
            let mut is_plain = !is_last || self.batch.column.ends_at(ends);
            if let Some(field) = field {
                let values = &mut rows[*field];
                values.resize(before + ROWS, 0.0);
                let left_out = u32::from(is_last && with_return);
                let numbers = values[before..].first_chunk_mut();
                is_plain = is_plain && numbers.is_some_and(|numbers| self.batch.read(text, left_out, numbers));
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
    fn check_times(&mut self, layout: &Layout, skipped: u64, fields: &[Field], rows: &Rows) {
        for (k, column) in rows.iter().enumerate().filter(|(k, _)| fields[*k].rule.ascends()) {
            if runs_backwards(column)
                && let Some(row) = column.windows(2).position(|pair| pair[1] < pair[0])
            {
                let backwards = Backwards { field: k, value: column[row + 1], before: column[row] };
                let line = self.line_of(row + 1, skipped);
                self.fault = Some((line, Fault::of(&backwards, fields, self.stamp_kind(line, layout))));
            }
        }
    }

    /// How the first field of a line is written, if it is a stamp.
    #[cold]
    pub fn stamp_kind(&self, line: u64, layout: &Layout) -> Option<StampKind> {
        let (_, text) = numbered(&self.text).find(|(number, _)| *number == line)?;
        stamp::kind(&layout.stamp(text)?)
    }

    /// The line of a row, both counted from 0.
    #[cold]
    fn line_of(&self, row: usize, skipped: u64) -> u64 {
        let mut rows = numbered(&self.text).filter(|(line, text)| *line >= skipped && is_data(text));
        rows.nth(row).map_or_else(|| numbered(&self.text).count() as u64, |(line, _)| line)
    }
}
