//! Where the numbers of a column stand in a text.

/// Rows that are read together.
pub(in crate::text) const ROWS: usize = 64;

/// Bytes up to the end of a number that are looked at.
pub(in crate::text) const REACH: usize = 16;

/// From where to where the numbers of a column stand. Those of rows that are not there stand where the last one does.
pub(in crate::text) struct Places {
    rows: usize,
    pub(super) starts: [u32; ROWS],
    pub(super) ends: [u32; ROWS],
}

impl Default for Places {
    fn default() -> Self {
        Self { rows: 0, starts: [0; ROWS], ends: [0; ROWS] }
    }
}

impl Places {
    /// Begins before the first column of rows, of which the first stands from `from` on; `ends` are their ends, [`ROWS`] at most.
    #[inline]
    pub fn begin(&mut self, from: u32, ends: &[u32]) {
        self.rows = ends.len();
        self.go_on(std::iter::once(from.wrapping_sub(1)).chain(ends.iter().copied()));
    }

    /// Goes on to the column that ends at these separators.
    #[inline]
    pub fn go_on(&mut self, separators: impl Iterator<Item = u32>) {
        let Self { rows, starts, ends } = self;
        *starts = ends.map(|end| end.wrapping_add(1));
        for (end, separator) in ends[..*rows].iter_mut().zip(separators) {
            *end = separator;
        }
        for places in [starts, ends] {
            let last = places[rows.saturating_sub(1)];
            places[*rows..].fill(last);
        }
    }

    /// Whether the column ends where the rows do.
    pub fn ends_at(&self, ends: &[u32]) -> bool {
        self.ends[..self.rows] == *ends
    }

    /// The least and the largest length of the numbers.
    #[expect(clippy::inline_always, reason = "what is not inlined is compiled for narrower vectors")]
    #[inline(always)]
    pub(super) fn lengths(&self) -> [u32; 2] {
        let [mut shortest, mut longest] = [u32::MAX, 0];
        for row in 0..ROWS {
            let length = self.ends[row].wrapping_sub(self.starts[row]);
            (shortest, longest) = (shortest.min(length), longest.max(length));
        }
        [shortest, longest]
    }

    /// Leaves out the last bytes of each number.
    pub(super) fn leave_out(&mut self, bytes: u32) {
        for end in &mut self.ends {
            *end = end.wrapping_sub(bytes);
        }
    }
}
