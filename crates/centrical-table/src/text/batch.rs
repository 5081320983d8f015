//! A column of bare numbers, many rows at a time.
//!
//! A number of at most 16 bytes stands at the end of two words of eight. What is before it is masked out, its sign and its
//! point are taken out, and what is before the point moves up; then neighbouring digits are joined to pairs, pairs to fours,
//! fours to eights, as in [`super::number`]. As there, such a number is a whole one divided by a power of ten, and its last
//! bit that of any correctly rounding parser: so it is the same one however it is read.

mod places;
#[cfg(target_arch = "x86_64")]
mod wide;
mod words;

use self::places::Places;
pub(super) use self::places::{REACH, ROWS};
use self::words::Texts;

/// Rows that are read together, a column after the other.
#[derive(Default)]
pub(super) struct Batch {
    pub column: Places,
    texts: Texts,
}

impl Batch {
    /// The numbers of the column, its texts being without their last `left_out` bytes. Whether there are any: none of the texts is
    /// another one than a bare number, of more than 15 digits or of more than 7 decimals.
    pub fn read(&mut self, text: &[u8], left_out: u32, numbers: &mut [f64; ROWS]) -> bool {
        self.column.leave_out(left_out);
        #[cfg(target_arch = "x86_64")]
        if let Some(is_read) = wide::read(text, &self.column, numbers) {
            return is_read;
        }
        self.texts.read(text, &self.column, numbers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A column of numbers, read in a text without anything around it, and in one that vectors may reach over.
    fn read(texts: &[&str]) -> Option<Vec<f64>> {
        let column = format!("{},", texts.join(","));
        let separators: Vec<usize> = column.match_indices(',').map(|(at, _)| at).collect();
        let [short, long] = [0, 100_000].map(|after| {
            let text = format!("{}{column}{}", "0".repeat(REACH), "0".repeat(after));
            let ends: Vec<u32> = separators.iter().map(|at| u32::try_from(REACH + at).unwrap()).collect();
            let (mut batch, mut numbers) = (Batch::default(), [0.0; ROWS]);
            batch.column.begin(u32::try_from(REACH).unwrap(), &ends);
            batch.column.go_on(ends.iter().copied());
            let is_read = batch.read(text.as_bytes(), 0, &mut numbers);
            assert!(!is_read || numbers[texts.len()..].iter().all(|number| *number == numbers[texts.len() - 1]));
            is_read.then(|| numbers[..texts.len()].to_vec())
        });
        let bits =
            |numbers: &Option<Vec<f64>>| numbers.as_ref().map(|n| n.iter().map(|n| n.to_bits()).collect::<Vec<_>>());
        assert_eq!(bits(&short), bits(&long), "{texts:?}");
        long
    }

    /// A small generator, of whole numbers below a limit.
    fn generator() -> impl FnMut(u64) -> u64 {
        let mut seed = 1_u64;
        move |end| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) % end
        }
    }

    /// A random number of a length at most.
    fn random(longest: usize, below: &mut impl FnMut(u64) -> u64) -> String {
        loop {
            let decimals = below(8);
            let whole = 1 + below(15 - decimals);
            let mut digits = |count: u64| -> String {
                (0..count).map(|_| char::from_digit(u32::try_from(below(10)).unwrap(), 10).unwrap()).collect()
            };
            let part = if decimals == 0 { String::new() } else { format!(".{}", digits(decimals)) };
            let sign = if digits(1).as_str() < "5" { "-" } else { "" };
            let text = format!("{sign}{}{part}", digits(whole));
            if text.len() <= longest {
                return text;
            }
        }
    }

    #[test]
    fn bare_numbers_are_read_to_the_last_bit() {
        let mut below = generator();
        for round in 0..3000 {
            let longest = [16, 8, 4][round % 3];
            let texts: Vec<String> = (0..=below(ROWS as u64 - 1)).map(|_| random(longest, &mut below)).collect();
            let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
            let numbers = read(&texts).unwrap_or_else(|| panic!("{texts:?}"));
            for (text, number) in texts.iter().zip(numbers) {
                assert_eq!(number.to_bits(), text.parse::<f64>().unwrap().to_bits(), "{text}");
            }
        }
    }

    /// Texts that differ from numbers in some bytes: what is read is what a parser of any number reads.
    #[test]
    fn what_is_read_of_other_texts_is_right() {
        let mut below = generator();
        let mut read_ones = 0;
        for round in 0..20_000 {
            let longest = [16, 8, 4][round % 3];
            let mut other = random(longest, &mut below).into_bytes();
            for _ in 0..=below(2) {
                let at = usize::try_from(below(other.len() as u64)).unwrap();
                let any = b' ' + u8::try_from(below(95)).unwrap();
                other[at] = [any, b'.', b'-', b'0'][usize::try_from(below(4)).unwrap()];
            }
            let other = String::from_utf8(other).unwrap().replace(',', ";");
            let mut texts = vec!["1"; ROWS];
            let row = round % ROWS;
            texts[row] = &other;
            if let Some(numbers) = read(&texts) {
                assert_eq!(numbers[row].to_bits(), other.parse::<f64>().unwrap().to_bits(), "{other}");
                read_ones += 1;
            }
        }
        assert!(read_ones > 1000, "{read_ones}");
    }

    /// The number, in every row of a batch of others of its own length and of other ones.
    fn read_among_others(text: &str) -> Option<f64> {
        let read = |other: &str, row: usize| {
            let texts: Vec<&str> = (0..ROWS).map(|k| if k == row { text } else { other }).collect();
            let numbers = read(&texts)?;
            let expected: f64 = other.parse().unwrap();
            assert!(numbers.iter().enumerate().all(|(k, number)| k == row || *number == expected), "{text}");
            Some(numbers[row])
        };
        let others = ["1", "-0.5", "1234567.25", "-123456.7890123"];
        let all: Vec<Option<f64>> = others.iter().flat_map(|other| (0..ROWS).map(|row| read(other, row))).collect();
        assert!(all.iter().all(|number| number.map(f64::to_bits) == all[0].map(f64::to_bits)), "{text}");
        all[0]
    }

    #[test]
    fn other_texts_are_left() {
        for text in
            ["", "-", "+1", ".5", "-.5", ".", "-.", "1.", "1.12345678", "1e5", "1.5e-3", "nan", "--1", "a", "1.2.3"]
        {
            assert_eq!(read_among_others(text), None, "{text}");
        }
        for text in [
            " 1",
            "1 ",
            "1\r",
            "\"1\"",
            "1-",
            "1234567890123456",
            "12345678901234567",
            "1-345678901234567",
            "1/2",
            "1:2",
        ] {
            assert_eq!(read_among_others(text), None, "{text}");
        }
        assert_eq!(read_among_others("123456789012345"), Some(123_456_789_012_345.0));
        assert_eq!(read_among_others("-123456789012345"), Some(-123_456_789_012_345.0));
        assert_eq!(read_among_others("12345678.1234567"), Some(12_345_678.123_456_7));
        assert_eq!(read_among_others("-12345678.1234567"), None);
        assert_eq!(read_among_others("-1234567.1234567"), Some(-1_234_567.123_456_7));
    }
}
