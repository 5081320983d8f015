//! The blocks that each plateau of a long schedule may be in, so that its path takes time in proportion to the record.
//!
//! Every plateau is a steady stretch of the record. Of `N` plateaus and `S` stretches, number `N s / S` is expected in the block
//! before which `s` stretches have ended. A plateau is looked for where it is expected to within some plateaus. Stretches that nobody
//! scheduled, and plateaus that do not look steady, lead away from it; then the band is to be widened.

use std::ops::Range;

/// Plateaus to both sides of the expected one, to begin with. A schedule of no more has no band.
const NARROWEST: usize = 16;

/// Where the plateaus of a schedule are expected.
pub(super) struct Band {
    /// Number of the plateau expected at each block, not decreasing.
    expected: Vec<usize>,
    count: usize,
    /// Plateaus to both sides of the expected one.
    reach: usize,
}

impl Band {
    /// The narrowest band of `count` plateaus in a record with these steady stretches.
    pub fn new(stretches: &[Range<usize>], blocks: usize, count: usize) -> Self {
        let mut ended = 0;
        let expected = (0..blocks).map(|block| {
            ended += stretches[ended..].iter().take_while(|stretch| stretch.end <= block).count();
            ended * count / stretches.len().max(1)
        });
        Self { expected: expected.collect(), count, reach: NARROWEST }
    }

    /// The band of twice the width.
    pub fn widened(self) -> Self {
        let reach = 2 * self.reach;
        Self { reach, ..self }
    }

    /// The blocks that each plateau may be in.
    pub fn within(&self) -> Vec<Range<usize>> {
        let of = |k: usize| {
            let start = self.expected.partition_point(|expected| expected + self.reach < k);
            start..self.expected.partition_point(|expected| *expected <= k + self.reach)
        };
        (0..self.count).map(of).collect()
    }

    /// Whether a path keeps clear of the edges of the band: half its reach at least. The whole record has no edge.
    pub fn holds(&self, path: &[Range<usize>]) -> bool {
        let is_clear = |k: usize, block: usize| 2 * self.expected[block].abs_diff(k) <= self.reach;
        let holds = |(k, range): (usize, &Range<usize>)| {
            !range.is_empty() && is_clear(k, range.start) && is_clear(k, range.end - 1)
        };
        self.reach >= self.count || path.iter().enumerate().all(holds)
    }
}
