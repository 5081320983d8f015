//! Records as CSV: numbers to a fixed number of decimals, or in the shortest form that reads back the same.

#![allow(
    clippy::inline_always,
    reason = "what is not inlined into the function with the wide vectors is compiled for the narrow ones"
)]

use std::io::{self, Write};

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use super::Table;
use super::decimal::{self, Decimals, Digits, ROOM};
use super::output::{Output, Piece};
use centrical::reduction::RecordSlice;

/// Rows that are turned into text together: some 250 KB.
const ROWS: usize = 4096;

/// What most stamps and many readings have no more decimals than. They need no search for the shortest form.
const NANO: Decimals = Decimals::exact(9);

/// A CSV file in the making.
pub(super) struct TextTable {
    output: Output,
    /// Of time and of the specific forces.
    decimals: [Decimals; 4],
}

impl TextTable {
    /// Begins the file; the specific forces in their shortest form unless decimals are given.
    pub fn new(mut output: Output, decimals: Option<Decimals>) -> io::Result<Self> {
        output.write_all(b"t,f1,f2,f3\n")?;
        output.flush()?;
        let of_force = decimals.unwrap_or(NANO);
        Ok(Self { output, decimals: [NANO, of_force, of_force, of_force] })
    }
}

impl Table for TextTable {
    /// On all threads; in order, whatever their number.
    fn write(&mut self, blocks: &[RecordSlice]) -> io::Result<()> {
        let rows = blocks.iter().flat_map(|block| {
            let [f1, f2, f3] = block.f_z.map(|f| f.chunks(ROWS));
            block.t.chunks(ROWS).zip(f1).zip(f2).zip(f3).map(|(((t, f1), f2), f3)| [t, f1, f2, f3])
        });
        let (decimals, output) = (self.decimals, &self.output);
        let lines: Vec<(Piece, [&[f64]; 4])> = rows.map(|rows| (output.room(), rows)).collect();
        let lines: Vec<Piece> = lines.into_par_iter().map(|(room, rows)| lines_of(room, decimals, &rows)).collect();
        lines.into_iter().try_for_each(|lines| self.output.send(lines))
    }

    fn finish(self: Box<Self>) -> io::Result<()> {
        self.output.finish()
    }
}

/// The lines of rows, given by columns.
fn lines_of(mut room: Piece, decimals: [Decimals; 4], columns: &[&[f64]; 4]) -> Piece {
    let most = (columns[0].len() * columns.len() + 1) * ROOM;
    room.text.resize(room.text.len().max(most), 0);
    room.start = Arch::new().dispatch(Fill { text: &mut room.text, decimals, columns });
    room
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
