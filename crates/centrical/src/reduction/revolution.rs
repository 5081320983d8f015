//! Cosine and sine of the carousel's angle at many instants: polynomials that a processor evaluates side by side.

use std::f64::consts::TAU;

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

/// `cos(omega (t - start))` and `sin(omega (t - start))`.
pub(super) fn cos_sin(omega: f64, start: f64, t: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let quarters_per_second = omega * 4.0 / TAU;
    let (mut cos, mut sin) = (vec![0.0; t.len()], vec![0.0; t.len()]);
    for ((t, cos), sin) in t.iter().zip(&mut cos).zip(&mut sin) {
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
    (cos, sin)
}

#[inline]
fn polynomial<const N: usize>(coefficients: &[f64; N], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

#[cfg(test)]
mod tests {
    use super::cos_sin;

    #[test]
    fn as_the_standard_library_has_them() {
        let t: Vec<f64> = (0..100_000).map(|i| 3.0 + f64::from(i) * 1.003e-3).collect();
        for omega in [62.65, -14.0, 0.03, 1e-9] {
            let (cos, sin) = cos_sin(omega, 3.0, &t);
            for i in 0..t.len() {
                let angle = omega * (t[i] - 3.0);
                // The angle itself is rounded, here and there.
                let tolerance = 4e-16 * (1.0 + angle.abs());
                assert!((cos[i] - angle.cos()).abs() < tolerance, "{angle}: {}", cos[i]);
                assert!((sin[i] - angle.sin()).abs() < tolerance, "{angle}: {}", sin[i]);
            }
        }
    }
}
