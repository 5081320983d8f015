//! A batch on a processor with AVX-512: the bytes of eight numbers in two vectors, eights of digits joined by three
//! instructions.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for narrower vectors")]

use std::arch::x86_64::{__m128i, __m512i};

use pulp::x86::V4;
use pulp::{NullaryFnOnce, cast};

use super::super::number::{ONES, POWERS};
use super::places::{Places, REACH, ROWS};

/// Bytes of a text that a batch may be spread over.
const WINDOW: usize = 1 << 14;

/// Of three vectors: `(a ^ b) & c`, `a & b & !c`, `a & !b & !c`.
const XOR_AND: i32 = 0x28;
const AND_NOT: i32 = 0x40;
const NOT_NOT: i32 = 0x10;

/// Numbers in a vector.
const LANES: usize = 8;

const RECIPROCALS: [f64; LANES] = [1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7];

/// The first that is too long to be exact.
const SIXTEEN_DIGITS: f64 = 1e15;

/// The numbers, as [`super::Batch::read`] gives them; nothing if the processor, or the text about them, is not made for it.
pub(super) fn read(text: &[u8], places: &Places, numbers: &mut [f64; ROWS]) -> Option<bool> {
    let simd = V4::try_new()?;
    let first = (places.ends[0] as usize).checked_sub(REACH)?;
    let from = first.min(text.len().checked_sub(WINDOW + REACH)?);
    let window = Window { bytes: text[from..].first_chunk()?, from: u32::try_from(from).ok()? };
    let is_in = (places.ends[ROWS - 1] as usize) <= from + WINDOW;
    is_in.then(|| simd.vectorize(Wide { simd, window, places, numbers }))
}

/// The part of a text in which all numbers stand, from `from` on.
struct Window<'a> {
    bytes: &'a [u8; WINDOW + REACH],
    from: u32,
}

struct Wide<'a> {
    simd: V4,
    window: Window<'a>,
    places: &'a Places,
    numbers: &'a mut [f64; ROWS],
}

impl NullaryFnOnce for Wide<'_> {
    type Output = bool;

    #[inline(always)]
    fn call(self) -> bool {
        let [shortest, longest] = self.places.lengths();
        if shortest == 0 || longest > 16 {
            false
        } else if longest <= 8 {
            self.read::<false>()
        } else {
            self.read::<true>()
        }
    }
}

impl Wide<'_> {
    /// The numbers, where some of their texts may be of more than 8 bytes.
    #[inline(always)]
    fn read<const LONG: bool>(self) -> bool {
        let Self { simd, window, places, numbers } = self;
        let V4 { avx512f: f, avx512bw: bw, avx512cd: cd, avx512dq: dq, avx2, .. } = simd;
        let all = |value: u64| f._mm512_set1_epi64(value.cast_signed());
        let (zero, minus_one) = (all(0), all(u64::MAX));
        let (mut most, mut largest, mut wrong) = (zero, f._mm512_set1_pd(0.0), 0);
        for (k, numbers) in numbers.as_chunks_mut::<LANES>().0.iter_mut().enumerate() {
            let (starts, ends) = (places.starts.as_chunks::<LANES>().0[k], places.ends.as_chunks::<LANES>().0[k]);
            let length = f._mm512_cvtepu32_epi64(avx2._mm256_sub_epi32(cast(ends), cast(starts)));
            let (even, odd) = (window.four(simd, ends, 0), window.four(simd, ends, 1));
            // Bytes less the character 0, those before the number masked out.
            let bits = f._mm512_slli_epi64::<3>(length);
            let digits = |bytes: __m512i, before: __m512i| {
                let kept = f._mm512_sllv_epi64(minus_one, before);
                f._mm512_ternarylogic_epi64::<XOR_AND>(bytes, all(0x30 * ONES), kept)
            };
            let mut low = digits(f._mm512_unpackhi_epi64(even, odd), bw._mm512_subs_epu16(all(64), bits));
            let mut high = zero;
            if LONG {
                high = digits(f._mm512_unpacklo_epi64(even, odd), f._mm512_sub_epi64(all(128), bits));
            }
            // The sign: the first byte.
            let is_long = if LONG { f._mm512_cmpgt_epi64_mask(length, all(8)) } else { 0 };
            let start = f._mm512_and_si512(f._mm512_sub_epi64(zero, bits), all(63));
            let first = f._mm512_srlv_epi64(f._mm512_mask_blend_epi64(is_long, low, high), start);
            let minus = f._mm512_cmpeq_epi64_mask(f._mm512_and_si512(first, all(0xff)), all(0x30 ^ 0x2d));
            let sign = f._mm512_sllv_epi64(all(0x30 ^ 0x2d), start);
            low = f._mm512_mask_xor_epi64(low, minus & !is_long, low, sign);
            high = f._mm512_mask_xor_epi64(high, minus & is_long, high, sign);
            // The point, if it is among the last eight bytes.
            let is_point = bw._mm512_cmpeq_epi8_mask(low, all((0x30 ^ 0x2e) * ONES));
            wrong |= wrong_points(is_point);
            let point = bw._mm512_movm_epi8(is_point);
            let has_point = f._mm512_test_epi64_mask(point, point);
            // What is before it moves up.
            let less = f._mm512_add_epi64(point, minus_one);
            let before = f._mm512_ternarylogic_epi64::<AND_NOT>(low, less, point);
            let after = f._mm512_ternarylogic_epi64::<NOT_NOT>(low, less, point);
            let by = f._mm512_maskz_set1_epi64(has_point, 8);
            let mut moved = f._mm512_sllv_epi64(before, by);
            if LONG {
                let over = f._mm512_srlv_epi64(high, f._mm512_sub_epi64(all(64), by));
                moved = f._mm512_or_si512(moved, over);
                high = f._mm512_sllv_epi64(high, by);
                most = bw._mm512_max_epu8(most, high);
            }
            low = f._mm512_or_si512(after, moved);
            most = bw._mm512_max_epu8(most, low);
            // Nothing but a sign and a point with its decimals. Without a point these are eight, and the eighth power is the
            // zeroth again.
            let decimals = f._mm512_srli_epi64::<3>(cd._mm512_lzcnt_epi64(point));
            let others = f._mm512_maskz_add_epi64(has_point, decimals, all(1));
            let others = f._mm512_mask_add_epi64(others, minus, others, all(1));
            wrong |= u64::from(f._mm512_cmpeq_epi64_mask(others, length));
            // Pairs, fours, eights.
            let fours = |digits: __m512i| {
                let pairs = bw._mm512_maddubs_epi16(digits, all(0x010a_010a_010a_010a));
                bw._mm512_madd_epi16(pairs, all(0x0001_0064_0001_0064))
            };
            let fours = bw._mm512_packus_epi32(if LONG { fours(high) } else { zero }, fours(low));
            let eights = bw._mm512_madd_epi16(fours, all(0x0001_2710_0001_2710));
            let mut whole = f._mm512_unpackhi_epi32(eights, zero);
            if LONG {
                let high = f._mm512_mul_epu32(f._mm512_unpacklo_epi32(eights, zero), all(100_000_000));
                whole = f._mm512_add_epi64(whole, high);
            }
            // Divided as by [`super::words`].
            let whole = dq._mm512_cvtepi64_pd(whole);
            largest = f._mm512_max_pd(largest, whole);
            let power = f._mm512_permutexvar_pd(decimals, cast(POWERS));
            let reciprocal = f._mm512_permutexvar_pd(decimals, cast(RECIPROCALS));
            let quotient = f._mm512_mul_pd(whole, reciprocal);
            let rest = f._mm512_fnmadd_pd(quotient, power, whole);
            let number = f._mm512_castpd_si512(f._mm512_fmadd_pd(rest, reciprocal, quotient));
            *numbers = cast(f._mm512_mask_or_epi64(number, minus, number, all(1 << 63)));
        }
        let are_digits = bw._mm512_cmpgt_epu8_mask(most, all(9 * ONES)) == 0;
        let largest: [f64; LANES] = cast(largest);
        are_digits && wrong == 0 && largest.iter().all(|number| *number < SIXTEEN_DIGITS)
    }
}

/// What is wrong with the points among the bytes of eight numbers, a bit for each byte: one is the last byte of its number, or
/// there are two.
fn wrong_points(is_point: u64) -> u64 {
    const LAST: u64 = 0x80 * ONES;
    let less = (is_point | LAST) - ONES;
    is_point & (less | LAST)
}

impl Window<'_> {
    /// The last bytes before every second of these ends.
    #[inline(always)]
    fn four(&self, simd: V4, ends: [u32; LANES], first: usize) -> __m512i {
        let V4 { avx512f: f, avx512dq: dq, .. } = simd;
        let bytes = |k: usize| -> __m128i {
            // Within the window, so that nothing is to be checked.
            let at = ends[first + 2 * k].wrapping_sub(self.from) as usize;
            self.bytes[at.wrapping_sub(REACH) % WINDOW..]
                .first_chunk::<REACH>()
                .map_or(cast([0_u8; REACH]), |b| cast(*b))
        };
        // One by one: gathered in an array they would go through memory.
        let (a, b, c, d) = (bytes(0), bytes(1), bytes(2), bytes(3));
        let two = dq._mm512_inserti64x2::<1>(f._mm512_castsi128_si512(a), b);
        dq._mm512_inserti64x2::<3>(dq._mm512_inserti64x2::<2>(two, c), d)
    }
}
