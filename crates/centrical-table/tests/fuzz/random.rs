//! Random numbers and places for files that are damaged on purpose.

/// A small generator of its own (splitmix64), so that a seed damages alike on every machine.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform among 0, ..., `end - 1`; 0 of nothing.
    pub fn below(&mut self, end: usize) -> usize {
        usize::try_from(self.next() % end.max(1) as u64).unwrap()
    }

    /// A place, half the time within `near` of the start or the end, where formats keep their sizes.
    pub fn place(&mut self, length: usize, near: usize) -> usize {
        let near = length.min(near);
        match self.below(4) {
            0 => self.below(near),
            1 => length.saturating_sub(1 + self.below(near)),
            _ => self.below(length),
        }
    }
}
