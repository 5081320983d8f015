//! The instructions of the machine at hand.

/// Calls `work` with the widest vectors of the machine and its fused products, which give what narrow ones and single
/// numbers give. `work` has to be inlined.
#[cfg(feature = "std")]
#[inline(always)]
pub(crate) fn on_this_machine<T>(work: impl FnOnce() -> T) -> T {
    struct Work<F>(F);
    impl<T, F: FnOnce() -> T> pulp::WithSimd for Work<F> {
        type Output = T;

        #[inline(always)]
        fn with_simd<S: pulp::Simd>(self, _: S) -> T {
            (self.0)()
        }
    }
    pulp::Arch::new().dispatch(Work(work))
}

/// Calls `work`.
#[cfg(not(feature = "std"))]
#[inline(always)]
pub(crate) fn on_this_machine<T>(work: impl FnOnce() -> T) -> T {
    work()
}
