//! Products and sums rounded once. A processor without such an instruction comes to the same bytes, at its own pace.

/// `a b + c`, rounded once.
#[cfg(feature = "std")]
#[inline(always)]
pub(crate) fn fused(a: f64, b: f64, c: f64) -> f64 {
    a.mul_add(b, c)
}

/// `a b + c`, rounded once.
#[cfg(not(feature = "std"))]
#[inline(always)]
pub(crate) fn fused(a: f64, b: f64, c: f64) -> f64 {
    libm::fma(a, b, c)
}

/// `a . b`.
#[inline(always)]
pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    fused(a[2], b[2], fused(a[1], b[1], a[0] * b[0]))
}

/// `c + a . b`.
#[inline(always)]
pub(crate) fn dot_and(a: [f64; 3], b: [f64; 3], c: f64) -> f64 {
    fused(a[2], b[2], fused(a[1], b[1], fused(a[0], b[0], c)))
}

/// `a x b`.
#[inline(always)]
pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    let minor = |j: usize, k: usize| fused(a[j], b[k], -(a[k] * b[j]));
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}
