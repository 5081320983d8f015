//! Records as CSV.

use std::io::{self, Write};

use rayon::prelude::*;

use super::Table;
use super::output::{Output, Sink, SteadyFile};
use crate::text_lines::{Decimals, ROWS, write_lines};
use centrical::reduction::RecordSlice;

/// What most stamps and many readings have no more decimals than. They need no search for the shortest form.
const NANO: Decimals = Decimals::exact(9);

/// Pieces of lines that may wait to be written.
const AHEAD: usize = 32;

/// A CSV file in the making.
pub(super) struct TextTable {
    output: Output<Lines>,
    /// Of time and of the specific forces.
    decimals: [Decimals; 4],
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
    /// Begins the file; the specific forces in their shortest form unless decimals are given.
    pub fn new(mut file: SteadyFile, decimals: Option<Decimals>) -> io::Result<Self> {
        file.write_all(b"t,f1,f2,f3\n")?;
        let of_force = decimals.unwrap_or(NANO);
        Ok(Self { output: Output::new(TextFile(file), AHEAD), decimals: [NANO, of_force, of_force, of_force] })
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
        let rooms: Vec<(Lines, [&[f64]; 4])> = rows.map(|rows| (output.room(), rows)).collect();
        let written = rooms.into_par_iter().map(|(mut lines, rows)| {
            lines.start = write_lines(&mut lines.text, decimals, rows);
            lines
        });
        let written: Vec<Lines> = written.collect();
        written.into_iter().try_for_each(|lines| self.output.send(lines))
    }

    fn finish(self: Box<Self>) -> io::Result<()> {
        self.output.finish()
    }
}
