//! A piece of text: from its lines to rows of numbers, up to the first fault.

use memchr::{memchr_iter, memrchr};
#[cfg(target_arch = "x86_64")]
use pulp::x86::V3;

use super::fields::Fault;
use super::layout::Layout;
use super::lines::{self, Text, is_data, numbered, split_line};
use super::number::{self, Batch, ROWS};
use crate::column::{Backwards, Field, Rows, runs_backwards};
use crate::stamp::Stamps;

/// Bytes that are looked through together for separators.
const STEP: usize = 64;

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
            let most = if from < number::REACH { 1 } else { ROWS };
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
        for (k, column) in rows.iter().enumerate().filter(|(k, _)| fields[*k].rule.ascends()) {
            if runs_backwards(column)
                && let Some(row) = column.windows(2).position(|pair| pair[1] < pair[0])
            {
                let fault = Fault::of(Backwards::new(k, column[row + 1], column[row]), fields);
                self.fault = Some((self.line_of(row + 1, skipped), fault));
            }
        }
    }

    /// The line of a row, both counted from 0.
    #[cold]
    fn line_of(&self, row: usize, skipped: u64) -> u64 {
        let mut rows = numbered(&self.text).filter(|(line, text)| *line >= skipped && is_data(text));
        rows.nth(row).map_or_else(|| numbered(&self.text).count() as u64, |(line, _)| line)
    }
}

/// The delimiters and the ends of lines of a text.
#[derive(Default)]
struct Separators {
    /// All of them; of 64 bytes at most ten as a rule.
    all: Places<10>,
    /// The ends of lines.
    ends: Places<3>,
    is_ascii: bool,
}

/// Places in a text, in ascending order. `OFTEN` of them are written in every step, as most steps have no more; later ones
/// overwrite the superfluous ones. A loop over the exact number would end where the processor does not expect it.
#[derive(Default)]
struct Places<const OFTEN: usize> {
    /// The places, and room for more.
    places: Vec<u32>,
    count: usize,
}

impl Separators {
    /// Finds those of a text of less than 4 GB; whether all of it is ASCII.
    pub fn find(&mut self, text: &[u8], delimiter: u8) -> bool {
        (self.all.count, self.ends.count, self.is_ascii) = (0, 0, true);
        let (steps, rest) = text.as_chunks::<STEP>();
        self.find_in_steps(steps, delimiter);
        let mut last = [0; STEP];
        last[..rest.len()].copy_from_slice(rest);
        self.is_ascii &= rest.is_ascii();
        // A delimiter may be the byte that stands for nothing here.
        let there = (1_u64 << rest.len()) - 1;
        self.all.take(marks(&last, |byte| byte == delimiter || byte == b'\n') & there, steps.len() * STEP);
        self.ends.take(marks(&last, |byte| byte == b'\n') & there, steps.len() * STEP);
        self.is_ascii
    }

    /// All of them, and the ends of lines among them.
    pub fn places(&self) -> [&[u32]; 2] {
        [self.all.get(), self.ends.get()]
    }

    fn find_in_steps(&mut self, steps: &[[u8; STEP]], delimiter: u8) {
        #[cfg(target_arch = "x86_64")]
        if let Some(simd) = V3::try_new() {
            simd.vectorize(Wide { simd, steps, delimiter, found: self });
            return;
        }
        for (k, step) in steps.iter().enumerate() {
            self.is_ascii &= step.is_ascii();
            self.all.take(marks(step, |byte| byte == delimiter || byte == b'\n'), k * STEP);
            self.ends.take(marks(step, |byte| byte == b'\n'), k * STEP);
        }
    }
}

impl<const OFTEN: usize> Places<OFTEN> {
    fn get(&self) -> &[u32] {
        &self.places[..self.count]
    }

    /// Adds the marked ones of a step.
    #[expect(
        clippy::inline_always,
        reason = "what is not inlined is compiled without the instructions that count bits"
    )]
    #[inline(always)]
    fn take(&mut self, mut marks: u64, step: usize) {
        if self.places.len() < self.count + STEP {
            self.places.resize(2 * self.count + STEP, 0);
        }
        let Some(room) = self.places[self.count..].first_chunk_mut::<STEP>() else { return };
        let count = marks.count_ones() as usize;
        #[expect(clippy::cast_possible_truncation, reason = "the text is shorter than 4 GB")]
        let step = step as u32;
        let mut next = || {
            let place = step + marks.trailing_zeros();
            marks &= marks.wrapping_sub(1);
            place
        };
        for place in &mut room[..OFTEN] {
            *place = next();
        }
        if count > OFTEN {
            for place in &mut room[OFTEN..count] {
                *place = next();
            }
        }
        self.count += count;
    }
}

/// What is asked for among some bytes, a bit each.
fn marks(step: &[u8; STEP], is_asked: impl Fn(u8) -> bool) -> u64 {
    step.iter().enumerate().map(|(k, byte)| u64::from(is_asked(*byte)) << k).sum()
}

/// Steps to be looked through by a processor with AVX2, 32 bytes at once.
#[cfg(target_arch = "x86_64")]
struct Wide<'a> {
    simd: V3,
    steps: &'a [[u8; STEP]],
    delimiter: u8,
    found: &'a mut Separators,
}

#[cfg(target_arch = "x86_64")]
impl pulp::NullaryFnOnce for Wide<'_> {
    type Output = ();

    #[expect(clippy::inline_always, reason = "what is not inlined is compiled for narrower vectors")]
    #[inline(always)]
    fn call(self) {
        let Self { simd: V3 { avx, avx2, .. }, steps, delimiter, found } = self;
        let delimiters = avx._mm256_set1_epi8(delimiter.cast_signed());
        let ends = avx._mm256_set1_epi8(b'\n'.cast_signed());
        let mut all = avx._mm256_setzero_si256();
        for (k, step) in steps.iter().enumerate() {
            let [mut all_marks, mut end_marks] = [0; 2];
            for half in step.as_chunks::<32>().0.iter().rev() {
                let half = pulp::cast(*half);
                let (delimiters, ends) = (avx2._mm256_cmpeq_epi8(half, delimiters), avx2._mm256_cmpeq_epi8(half, ends));
                let delimiters = avx2._mm256_movemask_epi8(delimiters).cast_unsigned();
                let ends = avx2._mm256_movemask_epi8(ends).cast_unsigned();
                all_marks = all_marks << 32 | u64::from(delimiters | ends);
                end_marks = end_marks << 32 | u64::from(ends);
                all = avx2._mm256_or_si256(all, half);
            }
            found.all.take(all_marks, k * STEP);
            found.ends.take(end_marks, k * STEP);
        }
        // The top bits.
        found.is_ascii &= avx2._mm256_movemask_epi8(all) == 0;
    }
}

#[cfg(test)]
mod tests {
    use super::{STEP, Separators, marks};

    #[test]
    fn every_separator_is_found() {
        let texts: [&[u8; 8]; 2] = [b"01;\n,.5-", b";;\n;;\n;1"];
        for bytes in texts {
            let text: Vec<u8> = (0..1000_u32).map(|i| bytes[(i * i / 7 % 8) as usize]).collect();
            let mut separators = Separators::default();
            for length in [1000, 3, 640, 999, 0] {
                assert!(separators.find(&text[..length], b';'));
                let expected: Vec<u32> = (0..)
                    .zip(&text[..length])
                    .filter(|(_, byte)| matches!(byte, b';' | b'\n'))
                    .map(|(i, _)| i)
                    .collect();
                let [all, ends] = separators.places();
                assert_eq!(all, expected);
                assert_eq!(ends, expected.into_iter().filter(|i| text[*i as usize] == b'\n').collect::<Vec<u32>>());
            }
            separators.find(&text, b';');
            for (k, step) in text.as_chunks::<STEP>().0.iter().enumerate() {
                let count = |places: &[u32]| places.iter().filter(|place| **place as usize / STEP == k).count();
                let expected = [marks(step, |byte| matches!(byte, b';' | b'\n')), marks(step, |byte| byte == b'\n')];
                assert_eq!(separators.places().map(count), expected.map(|marks| marks.count_ones() as usize));
            }
        }
    }

    #[test]
    fn other_letters_are_seen() {
        let mut separators = Separators::default();
        for place in [0, 63, 64, 100, 129] {
            let mut text = vec![b'1'; 130];
            text[place] = 0xb5;
            assert!(!separators.find(&text, b','), "{place}");
        }
    }
}
