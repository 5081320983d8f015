//! Sums over many numbers in lanes that do not wait for each other, in an order that is always the same.
//!
//! What a [`widest`] work calls is compiled for the processor's vectors only where it is inlined: hence the attributes.

/// Lanes: as many as the widest processor has for two instructions.
const LANES: usize = 8;

/// Does a work with the widest vectors of the machine. They add and multiply as single numbers do, and nothing is fused:
/// the outcome is the same on any.
pub(super) fn widest<W: pulp::WithSimd>(work: W) -> W::Output {
    pulp::Arch::new().dispatch(work)
}

/// Folds values into lanes, and the lanes into one.
#[inline(always)]
pub(super) fn fold<T: Copy>(values: &[f64], start: T, step: impl Fn(T, f64) -> T, join: impl Fn(T, T) -> T) -> T {
    let mut lanes = [start; LANES];
    let whole = values.chunks_exact(LANES);
    let rest = whole.remainder();
    for chunk in whole {
        for (lane, value) in lanes.iter_mut().zip(chunk) {
            *lane = step(*lane, *value);
        }
    }
    for (lane, value) in lanes.iter_mut().zip(rest) {
        *lane = step(*lane, *value);
    }
    lanes.into_iter().reduce(join).unwrap_or(start)
}

/// Sum of a function of values.
#[inline(always)]
pub(super) fn sum(values: &[f64], of: impl Fn(f64) -> f64) -> f64 {
    fold(values, 0.0, |sum, value| sum + of(value), |a, b| a + b)
}

/// Scalar product.
#[inline(always)]
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; LANES];
    let (whole_a, whole_b) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest = whole_a.remainder().iter().zip(whole_b.remainder());
    let rest: f64 = rest.map(|(a, b)| a * b).sum();
    for (a, b) in whole_a.zip(whole_b) {
        for ((lane, a), b) in lanes.iter_mut().zip(a).zip(b) {
            *lane += a * b;
        }
    }
    lanes.iter().sum::<f64>() + rest
}

/// `y - factor x`.
#[inline(always)]
pub(super) fn subtract(y: &mut [f64], factor: f64, x: &[f64]) {
    y.iter_mut().zip(x).for_each(|(y, x)| *y -= factor * x);
}
