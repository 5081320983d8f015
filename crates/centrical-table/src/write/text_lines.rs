//! Lines of text, many at a time: numbers to a fixed number of decimals, or in the shortest form that reads back the same.

#![allow(
    clippy::inline_always,
    reason = "what is not inlined into the function with the wide vectors is compiled for the narrow ones"
)]

use pulp::{Arch, Simd, WithSimd};

use super::decimal::{self, Decimals, Digits, ROOM};

/// Rows that are turned into text together: some 250 KB.
pub(super) const ROWS: usize = 4096;

/// Writes the lines of rows, given by columns, to the end of `text`, which grows where it is too short, and returns where they start.
pub(super) fn write_lines(text: &mut Vec<u8>, decimals: &[Decimals], columns: &[&[f64]]) -> usize {
    let most = (columns[0].len() * columns.len() + 1) * ROOM;
    text.resize(text.len().max(most), 0);
    Arch::new().dispatch(Fill { text, decimals, columns })
}

/// Fills a text from its end with the lines of rows, and returns where they start.
struct Fill<'a> {
    text: &'a mut [u8],
    decimals: &'a [Decimals],
    columns: &'a [&'a [f64]],
}

impl WithSimd for Fill<'_> {
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> usize {
        let Self { text, decimals, columns } = self;
        let mut digits: Vec<Digits> = decimals.iter().copied().map(Digits::new).collect();
        let mut start = text.len();
        for end in (1..=columns[0].len()).rev().step_by(decimal::ROWS) {
            let rows = end.saturating_sub(decimal::ROWS)..end;
            for (digits, column) in digits.iter_mut().zip(columns) {
                digits.take(&column[rows.clone()]);
            }
            for row in rows.clone().rev() {
                let mut ended_by = b'\n';
                for (digits, column) in digits.iter().zip(columns).rev() {
                    let Some(room) = text[..start].last_chunk_mut() else { break };
                    let put = digits.put(row - rows.start, ended_by, room);
                    start -= put.unwrap_or_else(|| put_shortest(column[row], ended_by, room));
                    ended_by = b',';
                }
            }
        }
        start
    }
}

/// Writes a number in the shortest form that reads back the same, and what ends it, to the end of `text`, and returns the length of both.
#[cold]
fn put_shortest(number: f64, ended_by: u8, text: &mut [u8; ROOM]) -> usize {
    let mut buffer = zmij::Buffer::new();
    let digits = if number.is_nan() { "nan" } else { buffer.format(number) };
    text[ROOM - 1 - digits.len()..ROOM - 1].copy_from_slice(digits.as_bytes());
    text[ROOM - 1] = ended_by;
    digits.len() + 1
}
