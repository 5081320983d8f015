//! Tables of numbers as text.

use std::io::{self, Write};

/// Decimals kept, trailing zeros left out: a nanosecond, a ten-thousandth of a microgravity.
const DECIMALS: usize = 9;

/// 10 to the [`DECIMALS`].
const UNITS: f64 = 1e9;

/// Above this a number times [`UNITS`] is no 64-bit integer any more, and far from what is measured.
const LARGEST: f64 = 9e9;

/// A table that is written row after row.
pub(super) struct CsvTable<'a> {
    output: &'a mut dyn Write,
    text: Vec<u8>,
}

impl<'a> CsvTable<'a> {
    /// Begins the table with its header.
    pub fn new(output: &'a mut dyn Write, names: &[String]) -> io::Result<Self> {
        let header: Vec<String> = names.iter().map(|name| field(name)).collect();
        writeln!(output, "{}", header.join(","))?;
        Ok(Self { output, text: Vec::new() })
    }

    /// Adds rows, given as columns of equal length.
    pub fn write(&mut self, columns: &[Vec<f64>]) -> io::Result<()> {
        self.text.clear();
        for row in 0..columns[0].len() {
            for (k, column) in columns.iter().enumerate() {
                if k > 0 {
                    self.text.push(b',');
                }
                push_number(&mut self.text, column[row]);
            }
            self.text.push(b'\n');
        }
        self.output.write_all(&self.text)
    }
}

/// A name as a field of the header, quoted where it must be.
fn field(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name.to_owned() }
}

/// A number to [`DECIMALS`] decimals.
fn push_number(text: &mut Vec<u8>, value: f64) {
    if value.abs() >= LARGEST || !value.is_finite() {
        text.extend_from_slice(value.to_string().as_bytes());
        return;
    }
    // Rounded, and within i64 by the test above.
    #[expect(clippy::cast_possible_truncation)]
    let units = (value * UNITS).round() as i64;
    if units < 0 {
        text.push(b'-');
    }
    let mut digits = [b'0'; 20];
    let mut rest = units.unsigned_abs();
    let mut first = digits.len();
    while rest > 0 || first > digits.len() - DECIMALS - 1 {
        first -= 1;
        digits[first] = b'0' + (rest % 10) as u8;
        rest /= 10;
    }
    let point = digits.len() - DECIMALS;
    text.extend_from_slice(&digits[first..point]);
    let decimals = digits[point..].iter().rposition(|digit| *digit != b'0').map_or(0, |last| last + 1);
    if decimals > 0 {
        text.push(b'.');
        text.extend_from_slice(&digits[point..point + decimals]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(value: f64) -> String {
        let mut text = Vec::new();
        push_number(&mut text, value);
        String::from_utf8(text).unwrap()
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
            (123_456_789.123, "123456789.123"),
            (8_388_607.0, "8388607"),
            (1e12, "1000000000000"),
        ];
        for (value, text) in cases {
            assert_eq!(written(value), text);
        }
    }

    #[test]
    fn names_are_quoted_where_they_must_be() {
        assert_eq!(field("f1"), "f1");
        assert_eq!(field("f1, \"raw\""), "\"f1, \"\"raw\"\"\"");
    }
}
