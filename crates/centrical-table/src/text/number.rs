//! Bare decimal numbers, one or a column of many: a sign, digits, a point, more digits.
//!
//! Such a number is a whole one of at most 15 digits divided by a power of ten up to 10^7. Both are doubles without an
//! error, so the quotient is the double nearest to what is written (Clinger 1990): the last bit is that of any
//! correctly rounding parser, however the number is read. What is written otherwise is left to such a parser.

#![allow(
    clippy::inline_always,
    reason = "what is not inlined into the function with the wide vectors is compiled for the narrow ones"
)]

use pulp::{Arch, Simd, WithSimd};

/// Rows of a batch.
pub(super) const ROWS: usize = 64;

/// Bytes up to the end of a number of a batch that are looked at.
pub(super) const REACH: usize = 16;

/// Ones in each of eight bytes.
const ONES: u64 = 0x0101_0101_0101_0101;

/// The top bits of eight bytes.
const TOPS: u64 = 0x80 * ONES;

/// Bytes that are looked at: sign, eight bytes of whole digits and point, eight of decimals, and the byte after.
const SIGHT: usize = 18;

const POWERS: [f64; 8] = [1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7];
const WHOLE_POWERS: [u64; 8] = [1, 10, 100, 1000, 10_000, 100_000, 1_000_000, 10_000_000];

/// The number that a text starts with, and its length; nothing if it has more than seven digits before or after its point, or
/// its end may not be in sight.
#[inline]
pub(super) fn plain(text: &[u8]) -> Option<(f64, usize)> {
    let text: &[u8; SIGHT] = text.first_chunk()?;
    let minus = usize::from(text[0] == b'-');
    let word = eight(text, minus);
    let whole = digits(word);
    if whole == 0 || whole == 8 {
        return None;
    }
    let after = minus + whole as usize;
    let (mut number, mut decimals) = (value(word, whole), 0);
    let mut length = after;
    if text[after] == b'.' {
        let word = eight(text, after + 1);
        decimals = digits(word);
        if decimals == 0 || decimals == 8 {
            return None;
        }
        number = number * WHOLE_POWERS[decimals as usize] + value(word, decimals);
        length = after + 1 + decimals as usize;
    }
    if matches!(text[length], b'e' | b'E') {
        return None;
    }
    // At most 14 digits, below 2^53.
    #[expect(clippy::cast_possible_wrap)]
    let number = number as i64 as f64 / POWERS[decimals as usize];
    // The sign as its bit: a branch on it would be guessed wrong half the time where readings are near zero.
    Some((f64::from_bits(number.to_bits() | (minus as u64) << 63), length))
}

#[inline]
fn eight(text: &[u8; SIGHT], from: usize) -> u64 {
    let mut word = [0; 8];
    word.copy_from_slice(&text[from..from + 8]);
    u64::from_le_bytes(word)
}

/// The number of digits at the start of eight bytes.
#[inline]
fn digits(word: u64) -> u32 {
    // A digit is 0 to 9 after this; anything else gets its top bit set by the sum, or has it. A carry goes to later
    // bytes only.
    let plain = word ^ (ONES * u64::from(b'0'));
    let others = (plain.wrapping_add(ONES * 0x76) | plain) & TOPS;
    others.trailing_zeros() / 8
}

/// The number that the first `count` of eight bytes make, `count` from 1 to 8.
#[inline]
fn value(word: u64, count: u32) -> u64 {
    // The digits to the end, zeros before them.
    joined((word ^ (ONES * u64::from(b'0'))) << (64 - 8 * count))
}

/// The number that eight digits make, the first in the lowest byte: neighbours are joined to pairs, pairs to fours, fours to
/// eight.
#[inline(always)]
fn joined(digits: u64) -> u64 {
    let pairs = (digits.wrapping_mul(10).wrapping_add(digits >> 8)) & 0x00ff_00ff_00ff_00ff;
    let fours = (pairs.wrapping_mul(100).wrapping_add(pairs >> 16)) & 0x0000_ffff_0000_ffff;
    // Of factors below 2^32: one instruction instead of three.
    (fours & 0xffff_ffff) * 10_000 + (fours >> 32)
}

/// Rows that are read together, a column after the other.
///
/// A number of at most 16 bytes stands at the end of two words of eight. What is before it is masked out, its sign and its
/// point are taken out, and what is before the point moves up; then its digits are joined as those of a single number.
#[derive(Default)]
pub(super) struct Batch {
    pub column: Bounds,
    texts: Texts,
}

impl Batch {
    /// The numbers of the column, its texts being without their last `left_out` bytes. Whether there are any: none of the texts is
    /// another one than a bare number, of more than 15 digits or of more than 7 decimals.
    pub fn read(&mut self, text: &[u8], left_out: u32, numbers: &mut [f64; ROWS]) -> bool {
        self.column.leave_out(left_out);
        self.texts.read(text, &self.column, numbers)
    }
}

/// From where to where the numbers of a column stand. Those of rows that are not there stand where the last one does.
pub(super) struct Bounds {
    rows: usize,
    starts: [u32; ROWS],
    ends: [u32; ROWS],
}

impl Default for Bounds {
    fn default() -> Self {
        Self { rows: 0, starts: [0; ROWS], ends: [0; ROWS] }
    }
}

impl Bounds {
    /// Begins before the first column of rows: the first row starts at `from`, and `ends` are their ends, [`ROWS`] at most.
    #[inline]
    pub fn begin(&mut self, from: u32, ends: &[u32]) {
        self.rows = ends.len();
        self.go_on(std::iter::once(from.wrapping_sub(1)).chain(ends.iter().copied()));
    }

    /// Goes on to the column that ends at these separators.
    #[inline]
    pub fn go_on(&mut self, separators: impl Iterator<Item = u32>) {
        let Self { rows, starts, ends } = self;
        *starts = ends.map(|end| end.wrapping_add(1));
        for (end, separator) in ends[..*rows].iter_mut().zip(separators) {
            *end = separator;
        }
        for places in [starts, ends] {
            let last = places[rows.saturating_sub(1)];
            places[*rows..].fill(last);
        }
    }

    /// Whether the column ends where the rows do.
    pub fn ends_at(&self, ends: &[u32]) -> bool {
        self.ends[..self.rows] == *ends
    }

    /// The least and the largest length of the numbers.
    #[inline(always)]
    fn lengths(&self) -> [u32; 2] {
        let [mut shortest, mut longest] = [u32::MAX, 0];
        for row in 0..ROWS {
            let length = self.ends[row].wrapping_sub(self.starts[row]);
            (shortest, longest) = (shortest.min(length), longest.max(length));
        }
        [shortest, longest]
    }

    /// Leaves out the last bytes of each number.
    fn leave_out(&mut self, bytes: u32) {
        for end in &mut self.ends {
            *end = end.wrapping_sub(bytes);
        }
    }
}

/// The texts of the numbers of a column.
struct Texts {
    /// The last eight bytes before the end of each, and the eight before.
    low: [u64; ROWS],
    high: [u64; ROWS],
    /// Lengths, with the sign.
    length: [u64; ROWS],
}

impl Default for Texts {
    fn default() -> Self {
        Self { low: [0; ROWS], high: [0; ROWS], length: [0; ROWS] }
    }
}

impl Texts {
    /// The numbers within these bounds in a text, as [`Batch::read`] gives them.
    fn read(&mut self, text: &[u8], bounds: &Bounds, numbers: &mut [f64; ROWS]) -> bool {
        self.take(text, bounds) && Arch::new().dispatch(Words { texts: self, bounds, numbers })
    }

    /// Takes what is within these bounds; whether none of them is too near to the begin of the text.
    fn take(&mut self, text: &[u8], bounds: &Bounds) -> bool {
        let mut taken = true;
        for (row, (start, end)) in bounds.starts.iter().zip(&bounds.ends).enumerate() {
            taken &= self.take_one(row, text, *start as usize, *end as usize);
        }
        taken
    }

    /// Takes the text of the number of a row, unless it is too near to the begin of all.
    #[inline]
    fn take_one(&mut self, row: usize, text: &[u8], start: usize, end: usize) -> bool {
        let words = text.get(end.wrapping_sub(REACH)..end).and_then(|words| words.first_chunk::<REACH>());
        let Some(words) = words else { return false };
        let (high, low) = words.split_at(8);
        self.low[row] = u64::from_le_bytes(low.try_into().unwrap_or_default());
        self.high[row] = u64::from_le_bytes(high.try_into().unwrap_or_default());
        self.length[row] = (end as u64).wrapping_sub(start as u64);
        true
    }
}

struct Words<'a> {
    texts: &'a Texts,
    bounds: &'a Bounds,
    numbers: &'a mut [f64; ROWS],
}

impl WithSimd for Words<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> bool {
        let Self { texts, bounds, numbers } = self;
        let [shortest, longest] = bounds.lengths();
        // What is known of all of them need not be asked of each.
        if shortest == 0 || longest > 16 {
            false
        } else if longest <= 8 {
            texts.read_all::<true, false>(numbers)
        } else if shortest > 8 {
            texts.read_all::<false, true>(numbers)
        } else {
            texts.read_all::<true, true>(numbers)
        }
    }
}

impl Texts {
    /// The numbers, where some of their texts may be of up to 8 bytes, and some of 9 to 16.
    #[inline(always)]
    fn read_all<const SHORT: bool, const LONG: bool>(&self, numbers: &mut [f64; ROWS]) -> bool {
        let mut wrong = 0;
        for row in 0..ROWS {
            let length = self.length[row];
            let is_long = LONG && (!SHORT || length > 8);
            // Bytes less the character 0, those before the number pushed out.
            let low = self.low[row] ^ (0x30 * ONES);
            let high = self.high[row] ^ (0x30 * ONES);
            let before_low = if SHORT { 64 - 8 * length.min(8) } else { 0 };
            let before_high = if LONG { 64 - 4 * length.max(8) } else { 32 };
            let low = low >> before_low;
            let high = if LONG { high >> before_high >> before_high } else { 0 };
            let minus = u64::from((if is_long { high } else { low }) & 0xff == 0x30 ^ 0x2d);
            let without_sign = !(0xff * minus);
            let low = if is_long { low } else { low & without_sign } << before_low;
            let high = if LONG { (high & without_sign) << before_high << before_high } else { 0 };
            // The point: the top bit of its byte, if it is among the last eight bytes.
            let others = low ^ ((0x30 ^ 0x2e) * ONES);
            let point = !(((others & !TOPS) + !TOPS) | others) & TOPS;
            let before = (point >> 7).wrapping_sub(1);
            let after = !(point << 1).wrapping_sub(1);
            let has_point = point != 0;
            let digits_low = (low & after) | ((low & before) << 8) | (high >> 56);
            let (digits_low, digits_high) = if has_point { (digits_low, high << 8) } else { (low, high) };
            let decimals = if has_point { u64::from(point.leading_zeros()) / 8 } else { 0 };
            wrong |= (digits_low.wrapping_add(0x76 * ONES) | digits_low) & TOPS;
            if LONG {
                wrong |= (digits_high.wrapping_add(0x76 * ONES) | digits_high) & TOPS;
            }
            // Nothing but a sign, a point with nothing before or after it, a number of 16 digits.
            let whole_digits = length.wrapping_sub(minus + if has_point { decimals + 1 } else { 0 });
            wrong |= u64::from(whole_digits == 0) | u64::from(has_point && decimals == 0);
            if LONG {
                wrong |= u64::from(!has_point && whole_digits == 16);
            }
            let whole = if LONG { joined(digits_high) * 100_000_000 } else { 0 } + joined(digits_low);
            #[expect(clippy::cast_possible_wrap, reason = "at most 15 digits, below 2^53")]
            let number = divided(whole as i64 as f64, decimals);
            numbers[row] = f64::from_bits(number.to_bits() | minus << 63);
        }
        wrong == 0
    }
}

/// `n / 10^d` for a whole `n` below `10^15` and `d` to 7, rounded once, sooner than a division would be made.
///
/// The quotient by way of the reciprocal is off by some units of the last place, `rest` is what that leaves of `n`,
/// exactly, and its own quotient is off by some `2^-100`. But nothing of the kind `n / 10^d` is nearer than `2^-54 / 10^7`,
/// a part of itself, to the middle between two doubles: so the sum is rounded as the true quotient is (Markstein 1990).
#[inline(always)]
fn divided(n: f64, d: u64) -> f64 {
    let factor = |bit: u64, factor: f64| if d & bit == 0 { 1.0 } else { factor };
    let power = factor(1, 1e1) * factor(2, 1e2) * factor(4, 1e4);
    let reciprocal = factor(1, 1e-1) * factor(2, 1e-2) * factor(4, 1e-4);
    let quotient = n * reciprocal;
    let rest = (-quotient).mul_add(power, n);
    rest.mul_add(reciprocal, quotient)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A column of numbers, read in a text with nothing behind it.
    fn read(texts: &[&str]) -> Option<Vec<f64>> {
        let text = format!("{}{},", "0".repeat(REACH), texts.join(","));
        let ends: Vec<u32> = text.match_indices(',').map(|(at, _)| u32::try_from(at).unwrap()).collect();
        let (mut batch, mut numbers) = (Batch::default(), [0.0; ROWS]);
        batch.column.begin(u32::try_from(REACH).unwrap(), &ends);
        batch.column.go_on(ends.iter().copied());
        let is_read = batch.read(text.as_bytes(), 0, &mut numbers);
        assert!(!is_read || numbers[texts.len()..].iter().all(|number| *number == numbers[texts.len() - 1]));
        is_read.then(|| numbers[..texts.len()].to_vec())
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

    #[test]
    fn quotients_are_those_of_a_division() {
        let mut seed = 1_u64;
        for _ in 0..200_000 {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            for (d, power) in (0..=7).zip([1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7]) {
                let any = ((seed >> 11) % 1_000_000_000_000_000) as f64;
                for n in [any, any % 1e9, any % 1e4] {
                    assert_eq!(divided(n, d).to_bits(), (n / power).to_bits(), "{n} / 10^{d}");
                }
            }
        }
    }

    /// A number, with what follows it in a file.
    fn read_one(text: &str) -> Option<(f64, usize)> {
        plain(format!("{text},-17.25,0.5,123456789\n").as_bytes())
    }

    #[test]
    fn plain_numbers_are_read_to_the_last_bit() {
        let mut below = generator();
        for _ in 0..200_000 {
            let (whole, decimals) = (below(8), below(8));
            let mut digits = |count: u64| -> String {
                (0..count).map(|_| char::from_digit(u32::try_from(below(10)).unwrap(), 10).unwrap()).collect()
            };
            let whole = if whole == 0 { "0".to_owned() } else { digits(whole) };
            let part = if decimals == 0 { String::new() } else { format!(".{}", digits(decimals)) };
            let sign = if digits(1).as_str() < "5" { "-" } else { "" };
            let text = format!("{sign}{whole}{part}");
            let (number, length) = read_one(&text).unwrap_or_else(|| panic!("{text}"));
            assert_eq!((number.to_bits(), length), (text.parse::<f64>().unwrap().to_bits(), text.len()), "{text}");
        }
    }

    #[test]
    fn other_numbers_are_left() {
        for text in ["", "-", "+1", ".5", "1.", "12345678", "1.12345678", "1e5", "1.5e-3", "1.5E3", "nan", "--1", "a"] {
            assert_eq!(read_one(text), None, "{text}");
        }
        assert_eq!(plain(b"1.5"), None);
    }
}
