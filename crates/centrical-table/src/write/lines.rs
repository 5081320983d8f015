//! Tables as CSV, written behind.

use std::io::{self, Write};

use memchr::memchr;
use rayon::prelude::*;

use super::csv::{csv_field, header};
use super::output::{Output, Sink, SteadyFile};
use super::text_lines::{Decimals, ROWS, write_lines};
use crate::stamp::Stamps;

/// Pieces of lines that may wait to be written.
const AHEAD: usize = 32;

/// A CSV file in the making.
pub(super) struct TextTable {
    output: Output<Lines>,
    /// Of each column.
    decimals: Vec<Decimals>,
}

/// Lines on their way to the file: the text from `start` on.
#[derive(Debug, Default)]
struct Lines {
    text: Vec<u8>,
    start: usize,
}

/// Where they go.
struct TextFile(SteadyFile);

impl Sink<Lines> for TextFile {
    fn write(&mut self, lines: &mut Lines) -> io::Result<()> {
        self.0.write_all(&lines.text[lines.start..])
    }

    fn finish(self) -> io::Result<()> {
        self.0.finish()
    }
}

impl TextTable {
    /// Begins the file.
    pub fn new(mut file: SteadyFile, names: &[&str], decimals: &[Decimals]) -> io::Result<Self> {
        file.write_all(header(names).as_bytes())?;
        Ok(Self { output: Output::new(TextFile(file), AHEAD), decimals: decimals.to_vec() })
    }

    /// Adds rows, piece after piece, on all threads; in order, whatever their number.
    pub fn write(&mut self, pieces: &[&[&[f64]]]) -> io::Result<()> {
        let rows = pieces.iter().flat_map(|columns| (0..count(columns)).step_by(ROWS).map(|from| part(columns, from)));
        let (decimals, output) = (&self.decimals, &self.output);
        let rooms: Vec<(Lines, Vec<&[f64]>)> = rows.map(|rows| (output.room(), rows)).collect();
        let written = rooms.into_par_iter().map(|(mut lines, rows)| {
            lines.start = write_lines(&mut lines.text, decimals, &rows);
            lines
        });
        let written: Vec<Lines> = written.collect();
        written.into_iter().try_for_each(|lines| self.output.send(lines))
    }

    /// Adds the rows of a piece with these stamps in place of the numbers of the first column, on all threads.
    pub fn write_stamped(&mut self, stamps: &Stamps, columns: &[&[f64]]) -> io::Result<()> {
        let (decimals, output) = (&self.decimals, &self.output);
        let rooms: Vec<(usize, Lines)> = (0..count(columns)).step_by(ROWS).map(|from| (from, output.room())).collect();
        let written = rooms.into_par_iter().map(|(from, mut numbers)| {
            numbers.start = write_lines(&mut numbers.text, decimals, &part(columns, from));
            let mut text = Vec::with_capacity(2 * (numbers.text.len() - numbers.start));
            for (row, line) in numbers.text[numbers.start..].split_inclusive(|byte| *byte == b'\n').enumerate() {
                let after = memchr(b',', line).unwrap_or(line.len() - 1);
                match stamps.text(from + row) {
                    Some(stamp) => text.extend_from_slice(csv_field(&String::from_utf8_lossy(&stamp)).as_bytes()),
                    None => text.extend_from_slice(&line[..after]),
                }
                text.extend_from_slice(&line[after..]);
            }
            Lines { text, start: 0 }
        });
        let written: Vec<Lines> = written.collect();
        written.into_iter().try_for_each(|lines| self.output.send(lines))
    }

    /// Writes the rest and sees it to the disk.
    pub fn finish(self) -> io::Result<()> {
        self.output.finish()
    }
}

/// Rows of a piece, given by columns of equal length.
fn count(columns: &[&[f64]]) -> usize {
    columns.first().map_or(0, |column| column.len())
}

/// At most [`ROWS`] rows of a piece.
fn part<'a>(columns: &[&'a [f64]], from: usize) -> Vec<&'a [f64]> {
    columns.iter().map(|column| &column[from..column.len().min(from + ROWS)]).collect()
}
