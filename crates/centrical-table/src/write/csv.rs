//! Tables of numbers as text.

use std::io::{self, Write};

use super::text_lines::{Decimals, ROWS, write_lines};

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
        let rows = columns.first().map_or(0, Vec::len);
        for from in (0..rows).step_by(ROWS) {
            let columns: Vec<&[f64]> = columns.iter().map(|column| &column[from..rows.min(from + ROWS)]).collect();
            let decimals: Vec<Decimals> = columns.iter().map(|column| Decimals::at_most(9, column)).collect();
            let start = write_lines(&mut self.text, &decimals, &columns);
            self.output.write_all(&self.text[start..])?;
        }
        Ok(())
    }
}

/// The first line of a table with these columns.
pub(super) fn header(names: &[&str]) -> String {
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
