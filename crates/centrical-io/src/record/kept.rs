//! Records that are kept in memory between the two passes over them, in room that all of them share.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use centrical::reduction::RecordSlice;

use crate::table::Index;

/// Bytes that records take at most: an hour at 1 kHz and more.
const MOST: usize = 125_000_000;

/// Bytes of a sample: three readings, and a time in equal steps.
const BYTES: usize = 25;

/// Room for records.
pub(crate) struct Room {
    left: AtomicUsize,
    all: usize,
}

/// A record that was read once, for the second pass: its samples, unless there are too many.
pub(crate) struct Kept<'a> {
    room: &'a Room,
    /// Taken of the room.
    bytes: usize,
    times: Vec<Times>,
    f_z: [Vec<f64>; 3],
    /// Where they stand, if they are not kept and the file can be read from anywhere.
    pub(super) index: Option<Index>,
    pub(super) is_whole: bool,
}

/// The times of neighbouring samples.
struct Times {
    /// The samples, counted in the record.
    range: Range<usize>,
    span: [f64; 2],
    law: Law,
}

/// How they follow each other.
enum Law {
    /// In equal steps from the first to the last, each as many units of its last place off as this: a byte instead of
    /// eight.
    Even(Vec<i8>),
    Any(Vec<f64>),
}

impl Default for Room {
    fn default() -> Self {
        Self::of(MOST)
    }
}

impl Room {
    pub(super) fn of(all: usize) -> Self {
        Self { left: AtomicUsize::new(all), all }
    }

    fn take(&self, bytes: usize) -> bool {
        self.left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(bytes)).is_ok()
    }

    fn give_back(&self, bytes: usize) {
        self.left.fetch_add(bytes, Ordering::Relaxed);
    }
}

impl<'a> Kept<'a> {
    /// No record yet.
    pub fn new(room: &'a Room) -> Self {
        Self { room, bytes: 0, times: Vec::new(), f_z: [const { Vec::new() }; 3], index: None, is_whole: false }
    }

    /// Begins another record, in the place of the last one.
    pub(super) fn begin(&mut self) {
        self.times.clear();
        for f in &mut self.f_z {
            f.clear();
            // All at once: readings that move to larger places leave the old ones behind, and what is not used costs nothing.
            f.reserve(self.room.all / BYTES);
        }
        self.room.give_back(std::mem::take(&mut self.bytes));
        (self.index, self.is_whole) = (None, true);
    }

    /// How many records like this one there is room for, the room being taken by it alone.
    pub fn fit_in(&self) -> usize {
        if self.is_whole { self.room.all / self.bytes.max(1) } else { 1 }
    }

    pub(super) fn extend(&mut self, stretch: RecordSlice) {
        if !self.is_whole || stretch.t.is_empty() {
            return;
        }
        let from = self.f_z[0].len();
        let times = Times::of(from, stretch.t);
        let bytes = times.bytes() + 3 * size_of_val(stretch.t);
        self.is_whole = self.room.take(bytes);
        if self.is_whole {
            self.bytes += bytes;
            self.times.push(times);
            for (whole, part) in self.f_z.iter_mut().zip(stretch.f_z) {
                whole.extend_from_slice(part);
            }
        } else {
            self.times = Vec::new();
            self.f_z = [const { Vec::new() }; 3];
            self.room.give_back(std::mem::take(&mut self.bytes));
        }
    }

    /// How many samples there are in a window, more or less.
    pub(super) fn samples_in(&self, window: [f64; 2]) -> usize {
        self.touched(window).map(|times| times.range.len()).sum()
    }

    fn touched(&self, [from, to]: [f64; 2]) -> impl Iterator<Item = &Times> {
        self.times.iter().filter(move |times| from <= times.span[1] && times.span[0] <= to)
    }

    /// Gives `visit` the samples of a window, from and to [s].
    pub(super) fn between<T>(&self, window: [f64; 2], visit: impl FnOnce(RecordSlice) -> T) -> T {
        let touched: Vec<&Times> = self.touched(window).collect();
        let mut t = Vec::with_capacity(touched.iter().map(|times| times.range.len()).sum());
        for times in &touched {
            times.write(&mut t);
        }
        let start = touched.first().map_or(0, |times| times.range.start);
        let f_z = self.f_z.each_ref().map(|f| &f[start..start + t.len()]);
        visit(RecordSlice { t: &t, f_z }.between(window))
    }
}

impl Drop for Kept<'_> {
    fn drop(&mut self) {
        self.room.give_back(self.bytes);
    }
}

impl Times {
    /// The times of the samples from `start` on, at least one.
    fn of(start: usize, t: &[f64]) -> Self {
        let span = [t[0], t[t.len() - 1]];
        let mut is_even = true;
        let off = t.iter().zip(even(span, t.len())).map(|(t, even)| {
            let off = last_places(*t, even);
            #[expect(clippy::cast_possible_truncation, reason = "what is lost is seen")]
            let short = off as i8;
            is_even &= i64::from(short) == off;
            short
        });
        let off = off.collect();
        let law = if is_even { Law::Even(off) } else { Law::Any(t.to_vec()) };
        Self { range: start..start + t.len(), span, law }
    }

    fn bytes(&self) -> usize {
        match &self.law {
            Law::Even(off) => off.len(),
            Law::Any(t) => size_of_val(t.as_slice()),
        }
    }

    fn write(&self, t: &mut Vec<f64>) {
        match &self.law {
            Law::Even(off) => {
                let even = even(self.span, off.len());
                t.extend(
                    off.iter()
                        .zip(even)
                        .map(|(off, even)| f64::from_bits(even.to_bits().wrapping_add_signed(i64::from(*off)))),
                );
            }
            Law::Any(times) => t.extend_from_slice(times),
        }
    }
}

/// Equal steps from one time to another.
fn even([first, last]: [f64; 2], count: usize) -> impl Iterator<Item = f64> {
    let step = (last - first) / (count.max(2) - 1) as f64;
    (0..count).map(move |i| first + i as f64 * step)
}

/// How many units of its last place a number is above another.
fn last_places(of: f64, above: f64) -> i64 {
    of.to_bits().wrapping_sub(above.to_bits()).cast_signed()
}

#[cfg(test)]
mod tests {
    use super::Times;

    #[test]
    fn times_are_kept_to_the_last_bit() {
        type Law = fn(f64) -> f64;
        let even: [Law; 4] = [|i| i / 1000.0, |i| i * 1e-3, |i| 1_699_999_000.25 + i / 1000.0, |_| 0.0];
        let others: [Law; 2] = [|i| i / 300.0 - 50.0, |i| (i + i % 2.0) / 1000.0];
        for (law, is_even) in even.map(|law| (law, true)).into_iter().chain(others.map(|law| (law, false))) {
            for n in [1, 2, 3, 20_000] {
                let t: Vec<f64> = (0..n).map(f64::from).map(law).collect();
                let times = Times::of(7, &t);
                let mut again = Vec::new();
                times.write(&mut again);
                assert!(t.iter().zip(&again).all(|(a, b)| a.to_bits() == b.to_bits()) && again.len() == t.len());
                assert!(n < 20_000 || matches!(times.law, super::Law::Even(_)) == is_even);
            }
        }
    }
}
