//! Tables of numbers as text.

use std::io::{self, Write};

use memchr::memchr;
use rayon::prelude::*;

use super::decimal::Decimals;
use super::output::{Output, Sink, SteadyFile};
use super::text_lines::{ROWS, write_lines};
use crate::stamp::Stamps;

/// Pieces of lines that may wait to be written.
const AHEAD: usize = 32;

/// A table that is written row after row. A number keeps nine decimals, trailing zeros left out: a nanosecond, a
/// ten-thousandth of a microgravity.
pub(super) struct CsvTable<'a> {
    output: &'a mut dyn Write,
    text: Vec<u8>,
}

impl<'a> CsvTable<'a> {
    /// Begins the table with its header.
    pub fn new(output: &'a mut dyn Write, names: &[&str]) -> io::Result<Self> {
        output.write_all(header(names).as_bytes())?;
        Ok(Self { output, text: Vec::new() })
    }

    /// Adds rows, given as columns of equal length.
    pub fn write(&mut self, columns: &[Vec<f64>]) -> io::Result<()> {
        let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        for from in (0..count(&columns)).step_by(ROWS) {
            let columns = part(&columns, from);
            let decimals: Vec<Decimals> = columns.iter().map(|column| Decimals::at_most(9, column)).collect();
            let start = write_lines(&mut self.text, &decimals, &columns);
            self.output.write_all(&self.text[start..])?;
        }
        Ok(())
    }
}

/// A CSV file in the making, written behind.
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
        Ok(Self { output: Output::new(TextFile(file), AHEAD)?, decimals: decimals.to_vec() })
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

/// The first line of a table with these columns.
fn header(names: &[&str]) -> String {
    names.iter().map(|name| csv_field(name)).collect::<Vec<_>>().join(",") + "\n"
}

/// A text as a field of CSV, quoted where it must be (RFC 4180).
pub fn csv_field(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(value: f64) -> String {
        let mut text = Vec::new();
        CsvTable::new(&mut text, &[]).and_then(|mut table| table.write(&[vec![value]])).unwrap();
        String::from_utf8(text).unwrap().trim().to_owned()
    }

    #[test]
    fn numbers_are_decimal_and_short() {
        let cases = [
            (0.0, "0"),
            (-0.0, "0"),
            (1.0, "1"),
            (-1984.9047, "-1984.9047"),
            (0.004, "0.004"),
            (-0.05, "-0.05"),
            (1e-9, "0.000000001"),
            (-4e-10, "0"),
            (123_456.789, "123456.789"),
            (-999_999.25, "-999999.25"),
            (123_456_789.123, "123456789.123"),
            (-8_388_607.25, "-8388607.25"),
            (8_388_607.0, "8388607"),
            (-4_000_000_001.0, "-4000000001"),
            (1e12, "1000000000000"),
            (f64::NAN, "nan"),
        ];
        for (value, text) in cases {
            assert_eq!(written(value), text);
        }
    }

    #[test]
    fn what_no_laboratory_measures_reads_back() {
        for value in [1e300, -1.5e17, f64::NEG_INFINITY] {
            assert_eq!(written(value).parse::<f64>().unwrap().to_bits(), value.to_bits());
        }
    }

    #[test]
    fn names_are_quoted_where_they_must_be() {
        assert_eq!(csv_field("f1"), "f1");
        assert_eq!(csv_field("f1, \"raw\""), "\"f1, \"\"raw\"\"\"");
    }
}
