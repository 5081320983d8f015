//! Sums over many numbers in independent lanes, in an order that is always the same.
//!
//! A function called by a [`widest`] work is compiled for the processor's vectors only if it is inlined: hence the
//! attributes, and loops in place of iterator methods that would be calls.

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
}
