//! A batch on any processor: the words of many numbers side by side, as its vectors have room for them.

#![allow(
    clippy::inline_always,
    reason = "what is not inlined into the function with the wide vectors is compiled for the narrow ones"
)]

use pulp::{Arch, Simd, WithSimd};

use super::super::number::{ONES, joined};
use super::places::{Places, REACH, ROWS};

/// The top bits of eight bytes.
const TOPS: u64 = 0x80 * ONES;

/// The texts of the numbers of a column.
pub(super) struct Texts {
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
    /// The numbers at these places in a text, as [`super::Batch::read`] gives them.
    pub fn read(&mut self, text: &[u8], places: &Places, numbers: &mut [f64; ROWS]) -> bool {
        self.take(text, places) && Arch::new().dispatch(Words { texts: self, places, numbers })
    }

    /// Takes what is at these places; whether none of them is too near to the begin of the text.
    fn take(&mut self, text: &[u8], places: &Places) -> bool {
        let mut taken = true;
        for (row, (start, end)) in places.starts.iter().zip(&places.ends).enumerate() {
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
    places: &'a Places,
    numbers: &'a mut [f64; ROWS],
}

impl WithSimd for Words<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> bool {
        let Self { texts, places, numbers } = self;
        let [shortest, longest] = places.lengths();
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
    use super::divided;

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
}
