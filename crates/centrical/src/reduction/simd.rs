//! Arithmetic on many numbers with the widest vectors of the machine; the result is the same on any machine.
//!
//! Sums go through independent lanes, in an order that is always the same. Cosine, sine, exponential and logarithm are polynomials that a
//! processor evaluates side by side.
//!
//! A function called by a [`widest`] work is compiled for the processor's vectors only if it is inlined: hence the
//! attributes, and loops in place of iterator methods that would be calls.

use std::f64::consts::{FRAC_1_SQRT_2, LOG2_E, TAU};

#[cfg(not(test))]
use pulp::Arch;
use pulp::{Simd, WithSimd};

/// Lanes of one instruction of the widest processor.
pub(crate) const LANES: usize = 8;

/// Lanes of a long product, so that a processor has several instructions in flight.
const LONG: usize = 4 * LANES;

/// Does a work with the widest vectors of the machine. They add and multiply as single numbers do, and fused operations
/// are explicit: the result is the same on any machine.
pub(crate) fn widest<W: WithSimd>(work: W) -> W::Output {
    #[cfg(test)]
    let processor = tests::PROCESSOR.get();
    #[cfg(not(test))]
    let processor = Arch::new();
    processor.dispatch(work)
}

/// Folds values into lanes, and the lanes into one.
#[inline(always)]
fn fold<T: Copy>(values: &[f64], start: T, step: impl Fn(T, f64) -> T, join: impl Fn(T, T) -> T) -> T {
    let mut lanes = [start; LANES];
    let (whole, rest) = values.as_chunks::<LANES>();
    for chunk in whole {
        for (lane, value) in lanes.iter_mut().zip(chunk) {
            *lane = step(*lane, *value);
        }
    }
    for (lane, value) in lanes.iter_mut().zip(rest) {
        *lane = step(*lane, *value);
    }
    joined(lanes, join)
}

/// Lowest and highest of the values that are numbers.
#[inline(always)]
pub(crate) fn range(values: &[f64]) -> [f64; 2] {
    let wider =
        |[low, high]: [f64; 2], value| [if value < low { value } else { low }, if value > high { value } else { high }];
    fold(values, [f64::INFINITY, f64::NEG_INFINITY], wider, |a, b| [a[0].min(b[0]), a[1].max(b[1])])
}

/// Sum of a function of values.
#[inline(always)]
pub(crate) fn sum(values: &[f64], of: impl Fn(f64) -> f64) -> f64 {
    fold(values, 0.0, |sum, value| sum + of(value), |a, b| a + b)
}

/// Scalar product.
#[inline(always)]
pub(crate) fn dot<S: Simd>(simd: S, a: &[f64], b: &[f64]) -> f64 {
    let mut vectors = const { LONG / S::F64_LANES };
    let mut sums = [simd.splat_f64s(0.0); LONG];
    let ((whole_a, rest_a), (whole_b, rest_b)) = (a.as_chunks::<LONG>(), b.as_chunks::<LONG>());
    let (mut last_a, mut last_b) = ([0.0; LONG], [0.0; LONG]);
    last_a[..rest_a.len()].copy_from_slice(rest_a);
    last_b[..rest_b.len()].copy_from_slice(rest_b);
    for (a, b) in whole_a.iter().zip(whole_b).chain([(&last_a, &last_b)]) {
        let (a, b) = (S::as_simd_f64s(a).0, S::as_simd_f64s(b).0);
        for k in 0..vectors {
            sums[k] = simd.mul_add_f64s(a[k], b[k], sums[k]);
        }
    }
    while vectors * S::F64_LANES > LANES {
        vectors /= 2;
        for k in 0..vectors {
            sums[k] = simd.add_f64s(sums[k], sums[k + vectors]);
        }
    }
    let mut lanes = [0.0; LANES];
    S::as_mut_simd_f64s(&mut lanes).0.copy_from_slice(&sums[..vectors]);
    joined(lanes, |a, b| a + b)
}

/// The largest size, of numbers.
#[inline(always)]
pub(crate) fn largest<S: Simd>(simd: S, values: &[f64]) -> f64 {
    const CHAINS: usize = 4;
    let mut most = [simd.splat_f64s(0.0); CHAINS];
    let (vectors, rest) = S::as_simd_f64s(values);
    let (whole, last) = vectors.as_chunks::<CHAINS>();
    for vectors in whole {
        for (most, vector) in most.iter_mut().zip(vectors) {
            *most = simd.max_f64s(*most, simd.abs_f64s(*vector));
        }
    }
    for vector in last {
        most[0] = simd.max_f64s(most[0], simd.abs_f64s(*vector));
    }
    let [a, b, c, d] = most;
    let most = simd.reduce_max_f64s(simd.max_f64s(simd.max_f64s(a, b), simd.max_f64s(c, d)));
    rest.iter().fold(most, |most, value| most.max(value.abs()))
}

/// `y - factor x`.
#[inline(always)]
pub(crate) fn subtract(y: &mut [f64], factor: f64, x: &[f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y = (-factor).mul_add(*x, *y);
    }
}

/// `y - sum of factor x`, with the widest vectors.
pub(crate) fn subtract_all<'a>(y: &mut [f64], terms: impl Iterator<Item = (f64, &'a [f64])>) {
    widest(Subtraction { y, terms });
}

struct Subtraction<'a, T> {
    y: &'a mut [f64],
    terms: T,
}

impl<'a, T: Iterator<Item = (f64, &'a [f64])>> WithSimd for Subtraction<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for (factor, x) in self.terms {
            subtract(self.y, factor, x);
        }
    }
}

/// Scalar product, with the widest vectors.
pub(crate) fn product(a: &[f64], b: &[f64]) -> f64 {
    widest(Product { a, b })
}

struct Product<'a> {
    a: &'a [f64],
    b: &'a [f64],
}

impl WithSimd for Product<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        dot(simd, self.a, self.b)
    }
}

/// Lanes joined by halves, so that each half is a vector.
#[inline(always)]
pub(crate) fn joined<T: Copy>(lanes: [T; LANES], join: impl Fn(T, T) -> T) -> T {
    let [a, b, c, d, e, f, g, h] = lanes;
    let [a, b, c, d] = [join(a, e), join(b, f), join(c, g), join(d, h)];
    join(join(a, c), join(b, d))
}

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
    let shifted = x.to_bits().wrapping_sub(FRAC_1_SQRT_2.to_bits());
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
pub(crate) mod tests {
    use std::cell::Cell;

    use pulp::Arch;

    use super::*;
    use crate::statistics::Random;

    thread_local! {
        /// The processor whose vectors this thread uses: the machine's own, unless a test chooses another.
        pub(crate) static PROCESSOR: Cell<Arch> = Cell::new(Arch::new());
    }

    /// Processors of all kinds that this one can stand for.
    fn processors() -> Vec<Arch> {
        let mut processors = vec![Arch::Scalar];
        #[cfg(target_arch = "x86_64")]
        {
            processors.extend(pulp::x86::V3::try_new().map(Arch::V3));
            processors.extend(pulp::x86::V4::try_new().map(Arch::V4));
        }
        processors.push(Arch::new());
        processors
    }

    /// The result on every processor equals that of single numbers, bit by bit.
    pub(crate) fn on_all<T: PartialEq + std::fmt::Debug + Send>(of: impl Fn() -> T + Sync) {
        // One thread, so that the choice of the processor holds for all of the work.
        let on = |processor: Arch| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
            pool.install(|| {
                PROCESSOR.set(processor);
                of()
            })
        };
        let single = on(Arch::Scalar);
        for processor in processors() {
            assert_eq!(on(processor), single, "{processor:?}");
        }
    }

    #[test]
    fn sums_are_the_same_on_any_processor() {
        let mut random = Random::stream(1, 0);
        let pairs = (0..200).chain([511, 512, 4097]).map(|n| [0, 1].map(|_| (0..n).map(|_| random.normal()).collect()));
        let pairs: Vec<[Vec<f64>; 2]> = pairs.collect();
        on_all(|| pairs.iter().map(|[a, b]| product(a, b).to_bits()).collect::<Vec<u64>>());
    }

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
