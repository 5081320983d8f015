//! Decimal numbers as records write them: a sign, up to seven digits, a point, up to eight more.
//!
//! Such a number is a whole one of at most 15 digits divided by a power of ten up to 10^8. Both are doubles without an
//! error, so the quotient is the double nearest to what is written (Clinger 1990): the last bit is that of any
//! correctly rounding parser. What is written otherwise is left to such a parser.

/// Ones in each of eight bytes.
pub(super) const ONES: u64 = 0x0101_0101_0101_0101;

/// Bytes that are looked at: sign, eight bytes of whole digits and point, eight of decimals, and the byte after.
const REACH: usize = 18;

pub(super) const POWERS: [f64; 8] = [1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7];
const WHOLE_POWERS: [u64; 8] = [1, 10, 100, 1000, 10_000, 100_000, 1_000_000, 10_000_000];

/// The number that a text starts with, and its length; nothing if it is not of the plain kind or its end may not be in
/// sight.
#[inline]
pub(super) fn plain(text: &[u8]) -> Option<(f64, usize)> {
    let text: &[u8; REACH] = text.first_chunk()?;
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
fn eight(text: &[u8; REACH], from: usize) -> u64 {
    let mut word = [0; 8];
    word.copy_from_slice(&text[from..from + 8]);
    u64::from_le_bytes(word)
}

/// How many of eight bytes are digits before the first that is none.
#[inline]
fn digits(word: u64) -> u32 {
    // A digit is 0 to 9 after this; anything else gets its top bit set by the sum, or has it. A carry goes to later
    // bytes only.
    let plain = word ^ (ONES * u64::from(b'0'));
    let others = (plain.wrapping_add(ONES * 0x76) | plain) & (ONES * 0x80);
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
#[expect(clippy::inline_always, reason = "a batch of numbers is compiled for the widest vectors")]
#[inline(always)]
pub(super) fn joined(digits: u64) -> u64 {
    let pairs = (digits.wrapping_mul(10).wrapping_add(digits >> 8)) & 0x00ff_00ff_00ff_00ff;
    let fours = (pairs.wrapping_mul(100).wrapping_add(pairs >> 16)) & 0x0000_ffff_0000_ffff;
    // Of factors below 2^32: one instruction instead of three.
    (fours & 0xffff_ffff) * 10_000 + (fours >> 32)
}

#[cfg(test)]
mod tests {
    use super::plain;

    /// A number, with what follows it in a file.
    fn read(text: &str) -> Option<(f64, usize)> {
        plain(format!("{text},-17.25,0.5,123456789\n").as_bytes())
    }

    #[test]
    fn plain_numbers_are_read_to_the_last_bit() {
        let mut seed = 1_u64;
        let mut below = |end: u64| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) % end
        };
        for _ in 0..200_000 {
            let (whole, decimals) = (below(8), below(8));
            let mut digits = |count: u64| -> String {
                (0..count).map(|_| char::from_digit(u32::try_from(below(10)).unwrap(), 10).unwrap()).collect()
            };
            let whole = if whole == 0 { "0".to_owned() } else { digits(whole) };
            let part = if decimals == 0 { String::new() } else { format!(".{}", digits(decimals)) };
            let sign = if digits(1).as_str() < "5" { "-" } else { "" };
            let text = format!("{sign}{whole}{part}");
            let (number, length) = read(&text).unwrap_or_else(|| panic!("{text}"));
            assert_eq!((number.to_bits(), length), (text.parse::<f64>().unwrap().to_bits(), text.len()), "{text}");
        }
    }

    #[test]
    fn other_numbers_are_left() {
        for text in ["", "-", "+1", ".5", "1.", "12345678", "1.12345678", "1e5", "1.5e-3", "1.5E3", "nan", "--1", "a"] {
            assert_eq!(read(text), None, "{text}");
        }
        assert_eq!(plain(b"1.5"), None);
    }
}
