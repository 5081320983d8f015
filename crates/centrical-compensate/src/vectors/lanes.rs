//! Vectors of three components, many at a time, by components.

/// `W` vectors, on the boundary of a cache line: the widest vector registers would straddle two otherwise.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(crate) struct Lanes<const W: usize>(pub [[f64; W]; 3]);

impl<const W: usize> Lanes<W> {
    pub const ZERO: Self = Self([[0.0; W]; 3]);

    /// Vector `w`.
    #[inline(always)]
    pub fn at(&self, w: usize) -> [f64; 3] {
        [self.0[0][w], self.0[1][w], self.0[2][w]]
    }

    /// Sets vector `w`.
    #[inline(always)]
    pub fn put(&mut self, w: usize, v: [f64; 3]) {
        for i in 0..3 {
            self.0[i][w] = v[i];
        }
    }
}
