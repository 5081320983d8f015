//! Records as CSV: numbers to a fixed number of decimals, or in the shortest form that reads back the same.

#![allow(
    clippy::inline_always,
    reason = "what is not inlined into the function with the wide vectors is compiled for the narrow ones"
)]

use std::fs::File;
use std::io::{self, Write};

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use super::Table;
use super::decimal::{self, Decimals, Digits, ROOM};
use centrical::reduction::RecordSlice;

/// Rows that are turned into text together: some 250 KB.
const ROWS: usize = 4096;

/// What most stamps and many readings have no more decimals than. They need no search for the shortest form.
const NANO: Decimals = Decimals::exact(9);

/// A CSV file in the making.
pub(super) struct TextTable {
    output: File,
    /// Of time and of the specific forces.
    decimals: [Decimals; 4],
    /// The lines of a block, [`ROWS`] of them in each.
    pieces: Vec<Lines>,
}

impl TextTable {
    /// Begins the file; the specific forces in their shortest form unless decimals are given.
    pub fn new(mut output: File, decimals: Option<Decimals>) -> io::Result<Self> {
        output.write_all(b"t,f1,f2,f3\n")?;
        let of_force = decimals.unwrap_or(NANO);
        Ok(Self { output, decimals: [NANO, of_force, of_force, of_force], pieces: Vec::new() })
    }
}

impl Table for TextTable {
    /// On all threads; in order, whatever their number.
    fn write(&mut self, block: RecordSlice) -> io::Result<()> {
        let [f1, f2, f3] = block.f_z.map(|f| f.chunks(ROWS));
        let rows: Vec<[&[f64]; 4]> =
            block.t.chunks(ROWS).zip(f1).zip(f2).zip(f3).map(|(((t, f1), f2), f3)| [t, f1, f2, f3]).collect();
        self.pieces.resize_with(self.pieces.len().max(rows.len()), Lines::default);
        let decimals = self.decimals;
        self.pieces.par_iter_mut().zip(&rows).for_each(|(lines, rows)| lines.set(decimals, rows));
        self.pieces[..rows.len()].iter().try_for_each(|lines| self.output.write_all(&lines.text[lines.start..]))
    }

    fn finish(self: Box<Self>) -> io::Result<()> {
        self.output.sync_all()
    }
}

/// Lines of text.
#[derive(Default)]
struct Lines {
    /// Room, and the text from `start` on.
    text: Vec<u8>,
    start: usize,
}

impl Lines {
    /// The lines of rows, given by columns.
    fn set(&mut self, decimals: [Decimals; 4], columns: &[&[f64]; 4]) {
        let room = (columns[0].len() * columns.len() + 1) * ROOM;
        self.text.resize(self.text.len().max(room), 0);
        self.start = Arch::new().dispatch(Fill { text: &mut self.text, decimals, columns });
    }
}

/// Fills a text from its end with the lines of rows, and tells where they start.
struct Fill<'a> {
    text: &'a mut [u8],
    decimals: [Decimals; 4],
    columns: &'a [&'a [f64]; 4],
}

impl WithSimd for Fill<'_> {
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> usize {
        let Self { text, decimals, columns } = self;
        let mut digits = decimals.map(Digits::new);
        let mut start = text.len();
        for end in (1..=columns[0].len()).rev().step_by(decimal::ROWS) {
            let rows = end.saturating_sub(decimal::ROWS)..end;
            for (digits, column) in digits.iter_mut().zip(columns) {
                digits.take(&column[rows.clone()]);
            }
            for row in rows.clone().rev() {
                let mut after = b'\n';
                for (digits, column) in digits.iter().zip(columns).rev() {
                    start -= 1;
                    text[start] = after;
                    after = b',';
                    if let Some(room) = text[..start].last_chunk_mut() {
                        start -= digits.put(row - rows.start, room).unwrap_or_else(|| put_shortest(column[row], room));
                    }
                }
            }
        }
        start
    }
}

/// Writes a number to the end of `text` in the shortest form that reads back the same, and tells its length.
#[cold]
fn put_shortest(number: f64, text: &mut [u8; ROOM]) -> usize {
    let mut buffer = zmij::Buffer::new();
    let digits = if number.is_nan() { "nan" } else { buffer.format(number) };
    text[ROOM - digits.len()..].copy_from_slice(digits.as_bytes());
    digits.len()
}
