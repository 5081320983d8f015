//! Records as CSV.

use std::io::{self, Write};

use rayon::prelude::*;

use super::Table;
use super::output::{Output, Piece};
use crate::text_lines::{Decimals, ROWS, write_lines};
use centrical::reduction::RecordSlice;

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
        let written = lines.into_par_iter().map(|(mut piece, rows)| {
            piece.start = write_lines(&mut piece.text, decimals, rows);
            piece
        });
        let lines: Vec<Piece> = written.collect();
        lines.into_iter().try_for_each(|lines| self.output.send(lines))
    }

    fn finish(self: Box<Self>) -> io::Result<()> {
        self.output.finish()
    }
}
