//! The division of a record's time into equal blocks.

use crate::reduction::record::RecordSlice;
use crate::statistics::{median, whole};

/// Shortest block [s]: a centrifuge's arm changes its speed in seconds, not in tenths.
const SHORTEST: f64 = 0.1;

/// Samples in a block: fewer, and a spike moves the median.
pub(super) const SAMPLES: usize = 8;

/// The division of a record's time into blocks.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    /// The record's first instant [s].
    start: f64,
    /// Sampling interval [s]; zero if all stamps of the beginning are one.
    pub interval: f64,
    /// Width of a block [s].
    pub width: f64,
}

impl Grid {
    /// The division for a record that begins with these times. Samples that share a stamp lie between it and the next.
    pub fn new(times: &[f64]) -> Self {
        let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
        let samples_of_step = (times.len() as f64 - 1.0) / steps.len() as f64;
        let step = median(&mut steps);
        let interval = if samples_of_step > 2.0 { step / samples_of_step } else { step };
        let start = times.first().copied().unwrap_or(0.0);
        Self { start, interval, width: SHORTEST.max(SAMPLES as f64 * interval).max(step) }
    }

    /// The number of the block that an instant falls in.
    pub fn number(&self, t: f64) -> usize {
        whole((t - self.start) / self.width)
    }

    /// The middle of a block [s].
    pub fn middle(&self, number: usize) -> f64 {
        self.start + (number as f64 + 0.5) * self.width
    }

    /// The samples of a stretch, block by block.
    pub fn divide<'a>(&self, stretch: RecordSlice<'a>) -> impl Iterator<Item = (usize, RecordSlice<'a>)> {
        let mut from = 0;
        std::iter::from_fn(move || {
            let number = self.number(*stretch.t.get(from)?);
            let to = from + self.samples_up_to(number, &stretch.t[from..]);
            let part = stretch.part(from..to);
            from = to;
            Some((number, part))
        })
    }

    /// The number of times, in ascending order, up to the end of a block. Equal steps give the first guess; otherwise the end
    /// is searched from the beginning, since a block is short beside a stretch.
    fn samples_up_to(&self, number: usize, t: &[f64]) -> usize {
        let is_in = |i: usize| self.number(t[i]) <= number;
        let steps = whole((self.middle(number) + 0.5 * self.width - t[0]) / self.interval);
        for end in steps..steps.saturating_add(3).min(t.len()) {
            if end > 0 && is_in(end - 1) && !is_in(end) {
                return end;
            }
        }
        let mut step = 1;
        while step < t.len() && is_in(step) {
            step *= 2;
        }
        let from = step / 2;
        from + t[from..step.min(t.len())].partition_point(|time| self.number(*time) <= number)
    }
}
