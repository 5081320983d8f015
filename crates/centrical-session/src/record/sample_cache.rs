//! Samples that are kept in memory between the two passes over a record, within a budget that all records share.

use std::sync::atomic::{AtomicUsize, Ordering};

use centrical::reduction::RecordSlice;

use super::packed_times::PackedTimes;
use super::reader::RecordIndex;

/// Bytes that samples take at most: an hour at 1 kHz and more.
const BYTES_LIMIT: usize = 125_000_000;

/// Bytes of a sample: three readings, and a time in equal steps.
const SAMPLE_BYTES: usize = 25;

/// Bytes that the samples of all records share.
pub(crate) struct MemoryBudget {
    left: AtomicUsize,
    all: usize,
}

/// The samples of a record for the second pass, unless there are too many.
pub(crate) struct SampleCache<'a> {
    budget: &'a MemoryBudget,
    /// Taken of the budget.
    bytes: usize,
    times: Vec<PackedTimes>,
    f_z: [Vec<f64>; 3],
    /// Stamp of the last sample, and those of samples that had the stamp of the one before: these are not kept.
    last: f64,
    repeated: Vec<f64>,
    /// Where they are in the file, if they are not kept and the file can be read from anywhere.
    pub(super) index: Option<RecordIndex>,
    pub(super) is_whole: bool,
    /// Whether an earlier record exceeded the whole budget: the next one is not begun in vain.
    is_too_long: bool,
}

impl Default for MemoryBudget {
    fn default() -> Self {
        Self::of(BYTES_LIMIT)
    }
}

impl MemoryBudget {
    /// A budget of that many bytes.
    pub fn of(all: usize) -> Self {
        Self { left: AtomicUsize::new(all), all }
    }

    /// How many records of `samples` samples fit into it, at least one.
    pub fn capacity(&self, samples: u64) -> usize {
        self.capacity_for(usize::try_from(samples).unwrap_or(usize::MAX).saturating_mul(SAMPLE_BYTES))
    }

    fn capacity_for(&self, bytes: usize) -> usize {
        (self.all / bytes.max(1)).max(1)
    }

    fn take(&self, bytes: usize) -> bool {
        self.left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(bytes)).is_ok()
    }

    fn give_back(&self, bytes: usize) {
        self.left.fetch_add(bytes, Ordering::Relaxed);
    }
}

impl<'a> SampleCache<'a> {
    /// No record yet.
    pub fn new(budget: &'a MemoryBudget) -> Self {
        Self {
            budget,
            bytes: 0,
            times: Vec::new(),
            f_z: [const { Vec::new() }; 3],
            last: f64::NEG_INFINITY,
            repeated: Vec::new(),
            index: None,
            is_whole: false,
            is_too_long: false,
        }
    }

    /// Begins another record, in the place of the last one.
    pub(super) fn begin(&mut self) {
        self.times.clear();
        self.repeated.clear();
        self.last = f64::NEG_INFINITY;
        for f in self.f_z.iter_mut().filter(|_| !self.is_too_long) {
            f.clear();
            // All at once: readings that move to larger places leave the old ones behind, and what is not used costs nothing.
            f.reserve(self.budget.all / SAMPLE_BYTES);
        }
        self.budget.give_back(std::mem::take(&mut self.bytes));
        (self.index, self.is_whole) = (None, !self.is_too_long);
    }

    /// How many records like this one fit into the budget, at least one.
    pub fn capacity(&self) -> usize {
        if self.is_whole { self.budget.capacity_for(self.bytes) } else { 1 }
    }

    /// Keeps the next stretch.
    pub(super) fn extend(&mut self, stretch: RecordSlice) {
        if !self.is_whole {
            return;
        }
        let repeated = stretch.repeated(self.last);
        self.last = stretch.t.last().copied().unwrap_or(self.last);
        if repeated.is_empty() {
            self.keep(stretch);
        } else if self.take(size_of_val(repeated.as_slice())) {
            self.repeated.extend(repeated.iter().map(|i| stretch.t[*i]));
            self.keep(stretch.without(&repeated).as_slice());
        }
    }

    fn keep(&mut self, stretch: RecordSlice) {
        if stretch.t.is_empty() {
            return;
        }
        let from = self.f_z[0].len();
        let times = PackedTimes::of(from, stretch.t);
        if self.take(times.bytes() + 3 * size_of_val(stretch.t)) {
            self.times.push(times);
            for (whole, part) in self.f_z.iter_mut().zip(stretch.f_z) {
                whole.extend_from_slice(part);
            }
        }
    }

    /// Takes more of the budget, or gives everything back if it is exhausted.
    fn take(&mut self, bytes: usize) -> bool {
        self.is_whole = self.budget.take(bytes);
        if self.is_whole {
            self.bytes += bytes;
        } else {
            (self.times, self.repeated) = (Vec::new(), Vec::new());
            self.f_z = [const { Vec::new() }; 3];
            self.is_too_long |= self.bytes + bytes > self.budget.all;
            self.budget.give_back(std::mem::take(&mut self.bytes));
        }
        self.is_whole
    }

    /// How many samples there are in a window, more or less.
    pub(super) fn samples_in(&self, window: [f64; 2]) -> usize {
        self.touched(window).map(|times| times.range.len()).sum()
    }

    fn touched(&self, [from, to]: [f64; 2]) -> impl Iterator<Item = &PackedTimes> {
        self.times.iter().filter(move |times| from <= times.span[1] && times.span[0] <= to)
    }

    /// The samples of a window, from and to [s], and how many with the stamp of the one before are not among them. Their times
    /// are written to `t`.
    pub(super) fn between<'b>(&'b self, window: [f64; 2], t: &'b mut Vec<f64>) -> (RecordSlice<'b>, usize) {
        let touched: Vec<&PackedTimes> = self.touched(window).collect();
        t.clear();
        t.reserve(touched.iter().map(|times| times.range.len()).sum());
        for times in &touched {
            times.write(t);
        }
        let start = touched.first().map_or(0, |times| times.range.start);
        let f_z = self.f_z.each_ref().map(|f| &f[start..start + t.len()]);
        let [from, to] = window;
        let repeated = self.repeated.iter().filter(|t| (from..=to).contains(*t)).count();
        (RecordSlice { t, f_z }.between(window), repeated)
    }
}

impl Drop for SampleCache<'_> {
    fn drop(&mut self) {
        self.budget.give_back(self.bytes);
    }
}
