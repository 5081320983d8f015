//! Cosine, sine, exponential and logarithm of many numbers: polynomials that a processor evaluates side by side.

use std::f64::consts::{LOG2_E, TAU};

/// `sin(y) / y` and `cos(y)` by powers of `y^2`, Taylor: the first term left out is below 2^-53 of the sum for
/// `|y| <= pi / 4`.
const SIN: [f64; 8] = [
    1.0,
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5040.0,
    1.0 / 362_880.0,
    -1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 1_307_674_368_000.0,
];
const COS: [f64; 9] = [
    1.0,
    -1.0 / 2.0,
    1.0 / 24.0,
    -1.0 / 720.0,
    1.0 / 40_320.0,
    -1.0 / 3_628_800.0,
    1.0 / 479_001_600.0,
    -1.0 / 87_178_291_200.0,
    1.0 / 20_922_789_888_000.0,
];

/// Adding it leaves no bits for a fraction: `1.5 2^52`.
const ROUNDING: f64 = 6_755_399_441_055_744.0;

/// `exp(y)`, Taylor: the first term left out is below 2^-53 for `|y| <= ln 2 / 2`.
const EXP: [f64; 14] = [
    1.0,
    1.0,
    1.0 / 2.0,
    1.0 / 6.0,
    1.0 / 24.0,
    1.0 / 120.0,
    1.0 / 720.0,
    1.0 / 5040.0,
    1.0 / 40_320.0,
    1.0 / 362_880.0,
    1.0 / 3_628_800.0,
    1.0 / 39_916_800.0,
    1.0 / 479_001_600.0,
    1.0 / 6_227_020_800.0,
];

/// `artanh(s) / s` by powers of `s^2`: the first term left out is below 2^-53 for `|s| <= (2^0.5 - 1) / (2^0.5 + 1)`.
const ARTANH: [f64; 11] = [
    1.0,
    1.0 / 3.0,
    1.0 / 5.0,
    1.0 / 7.0,
    1.0 / 9.0,
    1.0 / 11.0,
    1.0 / 13.0,
    1.0 / 15.0,
    1.0 / 17.0,
    1.0 / 19.0,
    1.0 / 21.0,
];

/// The first 32 bits of `ln 2`: their product with a number of powers has no rounding.
const LN_2_HEAD: f64 = 6.931_471_803_691_238e-1;
const LN_2_TAIL: f64 = 1.908_214_929_270_587_7e-10;

/// `cos(omega (t - start))` and `sin(omega (t - start))`.
#[inline(always)]
pub(crate) fn cos_sin(omega: f64, start: f64, t: &[f64], cos: &mut [f64], sin: &mut [f64]) {
    let quarters_per_second = omega * 4.0 / TAU;
    for ((t, cos), sin) in t.iter().zip(cos).zip(sin) {
        let quarters = quarters_per_second * (t - start);
        let shifted = quarters + ROUNDING;
        let y = (quarters - (shifted - ROUNDING)) * (TAU / 4.0);
        // The last bits of the shifted number are those of the whole quarters.
        let quarter = shifted.to_bits();
        let (c, s) = (polynomial(&COS, y * y), polynomial(&SIN, y * y) * y);
        let (c, s) = if quarter & 1 == 0 { (c, s) } else { (s, c) };
        // Signs by quarter: cosine + - - +, sine + + - -.
        *cos = f64::from_bits(c.to_bits() ^ ((quarter.wrapping_add(1) & 2) << 62));
        *sin = f64::from_bits(s.to_bits() ^ ((quarter & 2) << 62));
    }
}

/// `exp(x)`; zero or infinite beyond 700.
#[inline(always)]
pub(crate) fn exp(x: f64) -> f64 {
    let shifted = x * LOG2_E + ROUNDING;
    let powers = shifted - ROUNDING;
    let y = (-powers).mul_add(LN_2_TAIL, x - powers * LN_2_HEAD);
    // The last bits of the shifted number are those of the whole powers of two.
    let scale = f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52);
    let inside = polynomial(&EXP, y) * scale;
    if x < -700.0 {
        0.0
    } else if x > 700.0 {
        f64::INFINITY
    } else {
        inside
    }
}

/// `ln(x)` of a positive, normal `x`: `2 artanh(s) = ln m`, `s = (m - 1) / (m + 1)`, for the fraction `m` of `x` that is
/// nearest to 1.
#[inline(always)]
pub(crate) fn ln(x: f64) -> f64 {
    // Half the bits of the fraction's root: a fraction above it is taken as half of it, with one power of two more.
    let shifted = x.to_bits().wrapping_sub(std::f64::consts::FRAC_1_SQRT_2.to_bits());
    #[expect(clippy::cast_possible_wrap, reason = "the powers of two, negative ones too")]
    let powers = (shifted as i64) >> 52;
    let fraction = f64::from_bits(x.to_bits().wrapping_sub(shifted & (0xfff << 52)));
    let powers = powers as f64;
    let s = (fraction - 1.0) / (fraction + 1.0);
    powers * LN_2_HEAD + (2.0 * s * polynomial(&ARTANH, s * s) + powers * LN_2_TAIL)
}

#[inline(always)]
fn polynomial<const N: usize>(coefficients: &[f64; N], x: f64) -> f64 {
    let mut sum = 0.0_f64;
    for c in coefficients.iter().rev() {
        sum = sum.mul_add(x, *c);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::{cos_sin, exp, ln};

    #[test]
    fn as_the_standard_library_has_them() {
        let t: Vec<f64> = (0..100_000).map(|i| 3.0 + f64::from(i) * 1.003e-3).collect();
        for omega in [62.65, -14.0, 0.03, 1e-9] {
            let (mut cos, mut sin) = (vec![0.0; t.len()], vec![0.0; t.len()]);
            cos_sin(omega, 3.0, &t, &mut cos, &mut sin);
            for i in 0..t.len() {
                let angle = omega * (t[i] - 3.0);
                // The angle itself is rounded, here and there.
                let tolerance = 4e-16 * (1.0 + angle.abs());
                assert!((cos[i] - angle.cos()).abs() < tolerance, "{angle}: {}", cos[i]);
                assert!((sin[i] - angle.sin()).abs() < tolerance, "{angle}: {}", sin[i]);
            }
        }
    }

    #[test]
    fn exponentials_as_the_standard_library_has_them() {
        for x in (0..200_000).map(|i| -690.0 + f64::from(i) * 6.9e-3) {
            assert!((exp(x) / x.exp() - 1.0).abs() < 5e-16, "{x}");
        }
        assert_eq!((exp(0.0), exp(-1e9), exp(1e9)), (1.0, 0.0, f64::INFINITY));
    }

    #[test]
    fn logarithms_as_the_standard_library_has_them() {
        for x in (0..200_000).map(|i| (-690.0 + f64::from(i) * 6.9e-3_f64).exp()).chain([1.0, 0.5, 2.0, 0.999_999, 1.5])
        {
            assert!((ln(x) - x.ln()).abs() <= 4e-16 * x.ln().abs().max(1e-3), "{x}");
        }
    }
}
