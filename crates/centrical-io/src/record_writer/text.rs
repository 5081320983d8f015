//! Records as CSV: every number in its shortest form that reads back the same.

use std::fs::File;
use std::io::{self, Write};

use super::Table;
use centrical::reduction::RecordSlice;

/// A CSV file in the making.
pub(super) struct TextTable {
    output: File,
    /// The lines of a block.
    lines: Vec<u8>,
}

impl TextTable {
    pub fn new(mut output: File) -> io::Result<Self> {
        output.write_all(b"t,f1,f2,f3\n")?;
        Ok(Self { output, lines: Vec::new() })
    }
}

impl Table for TextTable {
    fn write(&mut self, block: RecordSlice) -> io::Result<()> {
        let mut number = zmij::Buffer::new();
        self.lines.clear();
        let [f1, f2, f3] = block.f_z;
        for (((t, f1), f2), f3) in block.t.iter().zip(f1).zip(f2).zip(f3) {
            for (value, end) in [(t, b','), (f1, b','), (f2, b','), (f3, b'\n')] {
                self.lines.extend_from_slice(if value.is_nan() { "nan" } else { number.format(*value) }.as_bytes());
                self.lines.push(end);
            }
        }
        self.output.write_all(&self.lines)
    }

    fn finish(self: Box<Self>) -> io::Result<()> {
        self.output.sync_all()
    }
}
