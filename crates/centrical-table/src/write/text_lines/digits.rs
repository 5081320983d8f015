//! Numbers split into their decimal digits.

#![allow(
    clippy::inline_always,
    reason = "what is not inlined into the function with the wide vectors is compiled for the narrow ones"
)]

/// Numbers that are worked on together.
pub(super) const ROWS: usize = 64;

/// Makes of numbers below 10^8 their eight digits, the first in the lowest byte: halves, quarters and eighths are split off in all
/// parts of the words at once, by products with rounded reciprocals of 10^4, 100 and 10.
#[inline(always)]
pub(super) fn split(numbers: &mut [u64; ROWS]) {
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
