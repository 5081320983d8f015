//! Tables of numbers as text.

use std::io::{self, Write};

use crate::digits::{ZEROS, eight_digits};

/// A number keeps nine decimals, trailing zeros left out: a nanosecond, a ten-thousandth of a microgravity.
const UNITS: u64 = 1_000_000_000;

/// Above this a number times [`UNITS`] is no 64-bit integer any more, and far from what is measured.
const LARGEST: f64 = 9e9;

/// Bytes that a number below [`LARGEST`] and what follows it take at most: a sign, ten digits, a point, nine decimals; and
/// room for eight digits to be written at once.
const LONGEST: usize = 32;

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
        let mut end = 0;
        for row in 0..columns[0].len() {
            for column in columns {
                end = self.put(end, column[row]);
                self.text[end] = b',';
                end += 1;
            }
            self.text[end - 1] = b'\n';
        }
        self.output.write_all(&self.text[..end])
    }

    /// Writes a number at `start`, with room for a character after it, and tells where it ends.
    fn put(&mut self, start: usize, value: f64) -> usize {
        if value.abs() >= LARGEST || !value.is_finite() {
            self.text.truncate(start);
            self.text.extend_from_slice(value.to_string().as_bytes());
            self.text.push(0);
            return self.text.len() - 1;
        }
        if self.text.len() < start + LONGEST {
            self.text.resize(2 * start + LONGEST, 0);
        }
        start + self.text[start..].first_chunk_mut().map_or(0, |place| put_number(place, value))
    }
}

/// A name as a field of the header, quoted where it must be.
fn field(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name.to_owned() }
}

/// Writes a number below [`LARGEST`] to nine decimals and tells its length.
fn put_number(text: &mut [u8; LONGEST], value: f64) -> usize {
    let units = rounded(value * UNITS as f64);
    let (whole, decimals) = (units.unsigned_abs() / UNITS, units.unsigned_abs() % UNITS);
    // What is not to be there is written over: branches that cannot be foreseen would cost more.
    text[0] = b'-';
    let mut end = usize::from(units < 0);
    end += put_whole(&mut text[end..], whole);
    let (first, last) = (eight_digits(decimals / 10), (decimals % 10) as u8);
    text[end] = b'.';
    text[end + 1..end + 9].copy_from_slice(&(first | ZEROS).to_le_bytes());
    text[end + 9] = b'0' + last;
    // The last digits are in the highest bytes: those that are zero are not counted.
    let shown = if last > 0 { 9 } else { 8 - first.leading_zeros() as usize / 8 };
    end + shown + usize::from(shown > 0)
}

/// To the nearest integer, halves away from zero, as [`f64::round`], which older processors have no instruction for.
#[expect(clippy::cast_possible_truncation)]
fn rounded(value: f64) -> i64 {
    let whole = value as i64;
    // Exact: both are multiples of the last place of `value`.
    let rest = value - whole as f64;
    whole + i64::from(rest >= 0.5) - i64::from(rest <= -0.5)
}

/// Writes an integer below 10^10 and tells its length.
fn put_whole(text: &mut [u8], number: u64) -> usize {
    const EIGHT: u64 = 100_000_000;
    if let Some(short) = u32::try_from(number).ok().filter(|short| *short < 10_000) {
        let digits = four_digits(short);
        // The first digits are in the lowest bytes; of a short number they are zero and left out, all but the last.
        let leading = (digits.trailing_zeros() / 8).min(3);
        text[..4].copy_from_slice(&((digits | FOUR_ZEROS) >> (8 * leading)).to_le_bytes());
        return 4 - leading as usize;
    }
    let mut length = 0;
    for digit in [number / (10 * EIGHT), number / EIGHT % 10] {
        if digit > 0 || length > 0 {
            text[length] = b'0' + (digit % 10) as u8;
            length += 1;
        }
    }
    let digits = eight_digits(number % EIGHT);
    let leading = if length > 0 { 0 } else { (digits.trailing_zeros() / 8).min(7) };
    let shown = (digits | ZEROS) >> (8 * leading);
    text[length..length + 8].copy_from_slice(&shown.to_le_bytes());
    length + 8 - leading as usize
}

/// Four times the character 0.
const FOUR_ZEROS: u32 = 0x3030_3030;

/// The four digits of a number below 10^4, as [`eight_digits`] has eight.
fn four_digits(number: u32) -> u32 {
    let hundreds = (number * 5243) >> 19;
    let quarters = hundreds | ((number - 100 * hundreds) << 16);
    let tens = ((quarters * 103) >> 10) & 0x000F_000F;
    tens | ((quarters - 10 * tens) << 8)
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
            (123_456_789.123, "123456789.123"),
            (8_388_607.0, "8388607"),
            (99_999_999.0, "99999999"),
            (100_000_000.0, "100000000"),
            (-4_000_000_001.0, "-4000000001"),
            (1e12, "1000000000000"),
            (-8_388_607.25, "-8388607.25"),
            (1e300, &format!("1{}", "0".repeat(300))),
            (f64::NAN, "NaN"),
            (f64::NEG_INFINITY, "-inf"),
        ];
        for (value, text) in cases {
            assert_eq!(written(value), text);
        }
    }

    /// As the standard library writes them to nine decimals, less the zeros at the end.
    #[test]
    fn numbers_are_those_of_the_standard_library() {
        let mut state = 1_u64;
        for k in 0..200_000 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            // Quantised as records are, and with decimals for which the product with 10^9 is exact.
            let integer = (state >> 32) as u32;
            let value = f64::from(integer.cast_signed()) / f64::from(1_u32 << (k % 10));
            let digits = format!("{value:.9}");
            let short = digits.trim_end_matches('0').trim_end_matches('.');
            assert_eq!(written(value), if short == "-0" { "0" } else { short });
        }
    }

    #[test]
    fn all_digits_are_split() {
        for number in 0..10_000 {
            let bytes = (four_digits(number) | FOUR_ZEROS).to_le_bytes();
            assert_eq!(bytes, format!("{number:04}").as_bytes());
            assert_eq!(written(f64::from(number)), number.to_string());
        }
    }

    #[test]
    fn rounding_is_that_of_the_standard_library() {
        for value in [0.5, -0.5, 0.499_999_999_999_999_94, 1.5, 2.5, -2.5, 4_503_599_627_370_495.5, 1e18, -1e18, 0.0] {
            assert_eq!(rounded(value) as f64, f64::round(value), "{value}");
        }
    }

    #[test]
    fn names_are_quoted_where_they_must_be() {
        assert_eq!(field("f1"), "f1");
        assert_eq!(field("f1, \"raw\""), "\"f1, \"\"raw\"\"\"");
    }
}
