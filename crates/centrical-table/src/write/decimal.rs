//! Numbers as text to a fixed number of decimals, many at a time: the digits side by side, as the vectors of the processor
//! have room for them, then each number where it belongs.
//!
//! A number in units of its last decimal is a whole one below 10^15: two halves of eight digits. Sixteen characters have them
//! with the point in its place, and zeros before them. Who fills a text from its end writes the next number over these.

#![allow(
    clippy::inline_always,
    reason = "what is not inlined into the function with the wide vectors is compiled for the narrow ones"
)]

/// Numbers that are worked on together.
pub(super) const ROWS: usize = 64;

/// Room for the longest number and what ends it.
pub(super) const ROOM: usize = 32;

/// Eight times the character 0.
const ZEROS: u64 = u64::from_ne_bytes([b'0'; 8]);

/// Units of the last decimal that sixteen characters have room for, the point among them.
const LARGEST: f64 = 1e15;

/// `x + 2^52` has the integer nearest to a small positive `x` in its last bits.
const SHIFT: f64 = 4_503_599_627_370_496.0;

/// How numbers are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Decimals {
    /// Decimals, 1 to 14.
    count: u32,
    /// Whether zeros at the end are left out.
    short: bool,
    /// Whether the text has to read back to the number.
    exact: bool,
}

/// The digits of a column of numbers.
pub(super) struct Digits {
    decimals: Decimals,
    /// Sixteen characters for each number, the first in the lowest byte of the first word: zeros, digits, the point.
    words: [[u64; ROWS]; 2],
    /// How many of them each number has, without its sign; [`OTHER`] of one that has no such text.
    length: [usize; ROWS],
    /// One for each number that is negative, as written.
    minus: [usize; ROWS],
}

/// A number that has to be written otherwise.
const OTHER: usize = 0;

/// Powers of ten.
const POWERS: [f64; 15] = [1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14];

impl Decimals {
    /// The shortest form that reads back to the number. Numbers of at most nine decimals, as most stamps and many readings are,
    /// need no search for it.
    pub const SHORTEST: Self = Self { count: 9, short: true, exact: true };

    /// The fewest decimals whose last half unit is at most 10^-12 of a range; none if the range has no such text.
    pub fn for_range(range: f64) -> Option<Self> {
        let is_enough = |count: &u32| 0.5 <= 1e-12 * range * POWERS[*count as usize];
        let count = (1..=14).find(is_enough).filter(|count| range * POWERS[*count as usize] < LARGEST)?;
        Some(Self { count, short: false, exact: false })
    }

    /// Up to `count`, from 1 to 14, to which these numbers are rounded; fewer where they are too large for as many.
    pub(crate) fn at_most(count: u32, numbers: &[f64]) -> Self {
        let largest =
            numbers.iter().fold(0.0, |most: f64, number| if number.abs() > most { number.abs() } else { most });
        let fits = |count: &u32| largest * POWERS[*count as usize] < LARGEST;
        Self { count: (1..=count).rev().find(fits).unwrap_or(1), short: true, exact: false }
    }

    /// How many.
    pub fn count(self) -> u32 {
        self.count
    }

    /// The sizes of numbers in units of the last decimal, whole ones; NaN for a number that has no such text.
    #[inline(always)]
    fn units(self, numbers: &[f64; ROWS]) -> [f64; ROWS] {
        let units_of_one = POWERS[self.count as usize];
        let mut all = [0.0; ROWS];
        for (units, number) in all.iter_mut().zip(numbers) {
            let scaled = number.abs() * units_of_one;
            *units = if scaled < LARGEST { (scaled + SHIFT) - SHIFT } else { f64::NAN };
        }
        if self.exact {
            for (units, number) in all.iter_mut().zip(numbers) {
                *units = if *units / units_of_one == number.abs() { *units } else { f64::NAN };
            }
        }
        all
    }
}

impl Digits {
    pub const fn new(decimals: Decimals) -> Self {
        Self { decimals, words: [[0; ROWS]; 2], length: [OTHER; ROWS], minus: [0; ROWS] }
    }

    /// Takes at most [`ROWS`] numbers.
    #[inline(always)]
    pub fn take(&mut self, numbers: &[f64]) {
        let Decimals { count, short, exact } = self.decimals;
        let mut padded = [0.0; ROWS];
        padded[..numbers.len()].copy_from_slice(numbers);
        let units = self.decimals.units(&padded);
        for ((minus, number), units) in self.minus.iter_mut().zip(&padded).zip(&units) {
            *minus = usize::from(number.is_sign_negative() && (exact || *units != 0.0));
        }
        // A digit before the point, the point, and the decimals.
        self.length = [count as usize + 2; ROWS];
        for power in &POWERS[count as usize + 1..] {
            for (length, units) in self.length.iter_mut().zip(&units) {
                *length += usize::from(units >= power);
            }
        }
        self.write(&units);
        if short {
            self.shorten();
        }
        for (length, units) in self.length.iter_mut().zip(&units) {
            *length = if units.is_nan() { OTHER } else { *length };
        }
    }

    /// Writes numbers, given in units of the last decimal, with the point in its place and zeros before them.
    #[inline(always)]
    fn write(&mut self, units: &[f64; ROWS]) {
        let [first, last] = &mut self.words;
        for ((first, last), units) in first.iter_mut().zip(last.iter_mut()).zip(units) {
            // Within one of the quotient.
            let quotient = (1e-8 * units + SHIFT) - SHIFT;
            let rest = units - 1e8 * quotient;
            let over = if rest < 0.0 { 1.0 } else { 0.0 };
            (*first, *last) = (whole(quotient - over), whole(rest + 1e8 * over));
        }
        split(first);
        split(last);
        // What is before the point moves up.
        let point = 8 * (15 - self.decimals.count);
        let before = (1_u128 << point) - 1;
        let ([before_0, before_1], [after_0, after_1]) = (halves(before), halves(!(before << 8 | 0xff)));
        let [point_0, point_1] = halves(u128::from(b'0' ^ b'.') << point);
        for (first, last) in first.iter_mut().zip(last) {
            let (high, low) = (*first, *last);
            *first = ZEROS ^ point_0 | ((high >> 8 | low << 56) & before_0) | (high & after_0);
            *last = ZEROS ^ point_1 | ((low >> 8) & before_1) | (low & after_1);
        }
    }

    /// Leaves out zeros at the end, and the point if nothing is left behind it.
    #[inline(always)]
    fn shorten(&mut self) {
        let count = self.decimals.count as usize;
        let zeros_of = |word: u64| (word ^ ZEROS).leading_zeros() as usize / 8;
        let [first, last] = &mut self.words;
        for ((first, last), length) in first.iter_mut().zip(last).zip(&mut self.length) {
            let zeros = if zeros_of(*last) == 8 { 8 + zeros_of(*first) } else { zeros_of(*last) };
            let left_out = zeros + usize::from(zeros == count);
            let (before, end) = if left_out < 8 { (*first, *last) } else { (0, *first) };
            let bits = 8 * (left_out % 8);
            (*first, *last) = (before << bits, end << bits | before >> 1 >> (63 - bits));
            *length -= left_out;
        }
    }

    /// Writes number `row` and what ends it to the end of `text`, zeros before it, and returns the length of both; none if the number
    /// has no such text.
    #[inline(always)]
    pub fn put(&self, row: usize, ended_by: u8, text: &mut [u8; ROOM]) -> Option<usize> {
        let length = self.length[row];
        if length == OTHER {
            return None;
        }
        text[ROOM - 17..ROOM - 9].copy_from_slice(&self.words[0][row].to_le_bytes());
        text[ROOM - 9..ROOM - 1].copy_from_slice(&self.words[1][row].to_le_bytes());
        text[ROOM - 1] = ended_by;
        text[(ROOM - 2 - length) % ROOM] = b'-';
        Some(length + self.minus[row] + 1)
    }
}

/// A whole number below 2^32 as an integer; a conversion would look for what does not fit, number by number.
#[inline(always)]
fn whole(number: f64) -> u64 {
    (number + SHIFT).to_bits() & 0xffff_ffff
}

/// The first eight bytes of sixteen, and the others.
#[expect(clippy::cast_possible_truncation)]
fn halves(bytes: u128) -> [u64; 2] {
    [bytes as u64, (bytes >> 64) as u64]
}

/// Makes of numbers below 10^8 their eight digits, the first in the lowest byte: halves, quarters and eighths are split off in all
/// parts of the words at once, by products with rounded reciprocals of 10^4, 100 and 10.
#[inline(always)]
fn split(numbers: &mut [u64; ROWS]) {
    for number in &mut *numbers {
        let first = ((*number & 0xffff_ffff) * 3_518_437_209) >> 45;
        *number = first | ((*number - 10_000 * first) << 32);
    }
    let mut halves: [u32; 2 * ROWS] = pulp::cast(*numbers);
    for half in &mut halves {
        // Which product is the short one is seen by the bits of its factor.
        let hundreds = ((*half & 0x3fff) * 5243) >> 19;
        *half = hundreds | ((*half - 100 * hundreds) << 16);
    }
    let mut quarters: [u16; 4 * ROWS] = pulp::cast(halves);
    for quarter in &mut quarters {
        let tens = ((u32::from(*quarter) * 6554) >> 16) as u16;
        *quarter = tens | ((*quarter - 10 * tens) << 8);
    }
    *numbers = pulp::cast(quarters);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The texts of numbers; none where another form is needed.
    fn texts(decimals: Decimals, numbers: &[f64]) -> Vec<Option<String>> {
        let mut digits = Digits::new(decimals);
        digits.take(numbers);
        let text = |row| {
            let mut room = [0; ROOM];
            let length = digits.put(row, b',', &mut room)?;
            Some(String::from_utf8(room[ROOM - length..].to_vec()).unwrap().strip_suffix(',').unwrap().to_owned())
        };
        (0..numbers.len()).map(text).collect()
    }

    fn text(decimals: Decimals, number: f64) -> Option<String> {
        texts(decimals, &[number])[0].clone()
    }

    /// Numbers of all magnitudes below `largest`, of either sign.
    fn numbers(largest: f64) -> impl Iterator<Item = [f64; ROWS]> {
        let mut state = 1_u64;
        let mut next = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..2000).map(move |_| {
            [0.0; ROWS].map(|_| {
                let magnitude = largest * 10_f64.powf(-14.0 * next() * next());
                magnitude * (2.0 * next() - 1.0)
            })
        })
    }

    #[test]
    fn decimals_are_chosen_for_the_range() {
        for (range, count) in [(2000.0, 9), (500.0, 9), (499.0, 10), (9.80665, 11), (1e-2, 14), (4e10, 2), (9e10, 1)] {
            assert_eq!(Decimals::for_range(range).map(Decimals::count), Some(count), "{range}");
        }
        for range in [0.0, 1e-3, f64::NAN, f64::INFINITY, 1e15] {
            assert_eq!(Decimals::for_range(range), None, "{range}");
        }
    }

    /// As the standard library rounds them, but for a product with the power of ten that comes near a half.
    #[test]
    fn numbers_are_rounded_to_the_last_decimal() {
        for (count, short) in (1..=14).flat_map(|count| [(count, false), (count, true)]) {
            let decimals = Decimals { count, short, exact: false };
            let power = POWERS[count as usize];
            let mut near_half = 0;
            for numbers in numbers(0.999 * LARGEST / power) {
                for (number, text) in numbers.into_iter().zip(texts(decimals, &numbers)) {
                    let expected = format!("{number:.*}", count as usize);
                    let is_zero = expected.trim_start_matches(['-', '0', '.']).is_empty();
                    let expected = if is_zero { expected.trim_start_matches('-') } else { &expected };
                    let without_zeros = expected.trim_end_matches('0').trim_end_matches('.');
                    if text.as_deref() != Some(if short { without_zeros } else { expected }) {
                        let rest = (number * power).abs().fract();
                        assert!((rest - 0.5).abs() <= f64::EPSILON * (number * power).abs(), "{text:?}, {expected}");
                        near_half += 1;
                    }
                }
            }
            // Only of numbers with as many digits as a double has.
            assert!(near_half < 2000 * ROWS / 50, "{near_half}");
        }
    }

    /// What is written reads back to the bit in the shortest form; what would not is left.
    #[test]
    fn exact_numbers_are_short_and_read_back() {
        let decimals = Decimals::SHORTEST;
        for numbers in numbers(1e6) {
            let few = numbers.map(|number| (number * 1e6).round() / 1e6);
            for (number, text) in few.into_iter().zip(texts(decimals, &few)) {
                assert_eq!(text, Some(number.to_string()));
            }
            for (number, text) in numbers.into_iter().zip(texts(decimals, &numbers)) {
                let has_few = number.to_string().split('.').nth(1).is_none_or(|decimals| decimals.len() <= 9);
                assert_eq!(text.is_some(), has_few, "{number}");
            }
        }
    }

    #[test]
    fn edges_are_written_or_left() {
        let two = Decimals { count: 2, short: false, exact: false };
        for (number, expected) in [
            (0.0, "0.00"),
            (-0.0, "0.00"),
            (-0.004, "0.00"),
            (-0.006, "-0.01"),
            (9.995_001, "10.00"),
            (99_999_999.99, "99999999.99"),
            (-100_000_000.0, "-100000000.00"),
            (9_999_999_999_999.0, "9999999999999.00"),
        ] {
            assert_eq!(text(two, number).as_deref(), Some(expected), "{number}");
        }
        for number in [1e13, -1e300, f64::INFINITY, f64::NAN] {
            assert_eq!(text(two, number), None, "{number}");
        }
        let exact = Decimals { count: 3, short: true, exact: true };
        for (number, expected) in [(0.0, "0"), (-0.0, "-0"), (1500.0, "1500"), (0.001, "0.001"), (-20.5, "-20.5")] {
            assert_eq!(text(exact, number).as_deref(), Some(expected), "{number}");
        }
        assert_eq!(text(exact, 0.0001), None);
    }

    #[test]
    fn all_digits_are_split() {
        let numbers: Vec<u64> = (0..100_000_000).step_by(97).chain([99_999_999, 9_999, 10_000, 99_990_000]).collect();
        for some in numbers.chunks(ROWS) {
            let mut digits = [0; ROWS];
            digits[..some.len()].copy_from_slice(some);
            split(&mut digits);
            for (number, digits) in some.iter().zip(digits) {
                let bytes = (digits | 0x3030_3030_3030_3030).to_le_bytes();
                assert_eq!(bytes, format!("{number:08}").as_bytes());
            }
        }
    }
}
