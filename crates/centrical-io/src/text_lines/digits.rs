//! Numbers split into their decimal digits.

#![allow(
    clippy::inline_always,
    reason = "what is not inlined into the function with the wide vectors is compiled for the narrow ones"
)]

/// The eight digits of a number below 10^8, the first in the lowest byte: halves, quarters and eighths are split off
/// in all parts of the word at once, by products with rounded reciprocals of 10^4, 100 and 10.
#[inline(always)]
pub(super) fn eight_digits(number: u64) -> u64 {
    let first = ((number & 0xffff_ffff) * 3_518_437_209) >> 45;
    let halves = first | ((number - 10_000 * first) << 32);
    let hundreds = ((halves * 10_486) >> 20) & 0x0000_007F_0000_007F;
    let quarters = hundreds | ((halves - 100 * hundreds) << 16);
    let tens = ((quarters * 103) >> 10) & 0x000F_000F_000F_000F;
    tens | ((quarters - 10 * tens) << 8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_digits_are_split() {
        for number in (0..100_000_000).step_by(97).chain([99_999_999, 9_999, 10_000, 99_990_000]) {
            let bytes = (eight_digits(number) | 0x3030_3030_3030_3030).to_le_bytes();
            assert_eq!(bytes, format!("{number:08}").as_bytes());
        }
    }
}
