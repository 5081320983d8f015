//! Records as CSV: every number in its shortest form that reads back the same.

use std::fs::File;
use std::io::{self, Write};

use rayon::prelude::*;

use super::Table;
use centrical::reduction::RecordSlice;

/// Rows that are turned into text together: some 300 KB.
const ROWS: usize = 4096;

/// Bytes of the longest number and what follows it.
const LONGEST: usize = 25;

/// A CSV file in the making.
pub(super) struct TextTable {
    output: File,
    /// The lines of a block, [`ROWS`] of them in each.
    pieces: Vec<Lines>,
}

impl TextTable {
    pub fn new(mut output: File) -> io::Result<Self> {
        output.write_all(b"t,f1,f2,f3\n")?;
        Ok(Self { output, pieces: Vec::new() })
    }
}

impl Table for TextTable {
    /// On all threads, since this is the slowest part of a compensation; in order, whatever their number.
    fn write(&mut self, block: RecordSlice) -> io::Result<()> {
        let [f1, f2, f3] = block.f_z.map(|f| f.chunks(ROWS));
        let rows: Vec<[&[f64]; 4]> =
            block.t.chunks(ROWS).zip(f1).zip(f2).zip(f3).map(|(((t, f1), f2), f3)| [t, f1, f2, f3]).collect();
        self.pieces.resize_with(self.pieces.len().max(rows.len()), Lines::default);
        self.pieces.par_iter_mut().zip(&rows).for_each(|(lines, rows)| lines.set(rows));
        self.pieces[..rows.len()].iter().try_for_each(|lines| self.output.write_all(&lines.text[..lines.length]))
    }

    fn finish(self: Box<Self>) -> io::Result<()> {
        self.output.sync_all()
    }
}

/// Lines of text.
#[derive(Default)]
struct Lines {
    /// The text, and room behind it.
    text: Vec<u8>,
    length: usize,
}

impl Lines {
    /// The lines of rows, given by columns.
    fn set(&mut self, columns: &[&[f64]; 4]) {
        let rows = columns[0].len();
        self.text.resize(self.text.len().max(rows * columns.len() * LONGEST), 0);
        let mut number = zmij::Buffer::new();
        let mut end = 0;
        for row in 0..rows {
            for column in columns {
                let value = column[row];
                let digits = if value.is_nan() { "nan" } else { number.format(value) };
                end += put(&mut self.text[end..], digits.as_bytes());
                self.text[end] = b',';
                end += 1;
            }
            self.text[end - 1] = b'\n';
        }
        self.length = end;
    }
}

/// Copies a number to the start of `text` and tells its length. Most have 16 digits or more, and two copies of 16 bytes,
/// which overlap, are no call; one of a length that is not known is.
#[inline]
fn put(text: &mut [u8], digits: &[u8]) -> usize {
    let length = digits.len();
    match (digits.first_chunk::<16>(), digits.last_chunk::<16>()) {
        (Some(first), Some(last)) => {
            text[..16].copy_from_slice(first);
            text[length - 16..length].copy_from_slice(last);
        }
        _ => text[..length].copy_from_slice(digits),
    }
    length
}
