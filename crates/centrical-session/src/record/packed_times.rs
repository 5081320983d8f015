//! The times of neighbouring samples, kept in a byte each where they are equally spaced.

#![allow(
    clippy::inline_always,
    reason = "what is not inlined into the function with the wide vectors is compiled for the narrow ones"
)]

use std::ops::Range;

use pulp::{Arch, Simd, WithSimd};

/// The times of neighbouring samples.
pub struct PackedTimes {
    /// The samples, counted in the record.
    pub range: Range<usize>,
    /// The first and the last [s].
    pub span: [f64; 2],
    law: Law,
}

/// How they follow each other.
enum Law {
    /// In equal steps from the first to the last, each as many units of its last place off as this is over [`MIDDLE`]: a
    /// byte instead of eight.
    Even(Vec<u8>),
    Any(Vec<f64>),
}

/// The byte of a time that is where equal steps have it.
const MIDDLE: u64 = 128;

impl PackedTimes {
    /// The times [s] of the samples from `start` on.
    pub fn of(start: usize, t: &[f64]) -> Self {
        let span = [t.first(), t.last()].map(|t| t.copied().unwrap_or_default());
        let off = Arch::new().dispatch(Off { span, t });
        let law = off.map_or_else(|| Law::Any(t.to_vec()), Law::Even);
        Self { range: start..start + t.len(), span, law }
    }

    /// Bytes that they take.
    pub fn bytes(&self) -> usize {
        match &self.law {
            Law::Even(off) => off.len(),
            Law::Any(t) => size_of_val(t.as_slice()),
        }
    }

    /// Writes them behind `t`.
    pub fn write(&self, t: &mut Vec<f64>) {
        match &self.law {
            Law::Even(off) => Arch::new().dispatch(Again { span: self.span, off, t }),
            Law::Any(times) => t.extend_from_slice(times),
        }
    }
}

/// Packs times as their distances from equal steps; none if one is too far.
struct Off<'a> {
    span: [f64; 2],
    t: &'a [f64],
}

impl WithSimd for Off<'_> {
    type Output = Option<Vec<u8>>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let mut all = 0;
        let off = self.t.iter().zip(even(self.span, self.t.len())).map(|(t, even)| {
            let off = t.to_bits().wrapping_sub(even.to_bits()).wrapping_add(MIDDLE);
            all |= off;
            off.to_le_bytes()[0]
        });
        let off = off.collect();
        u8::try_from(all).is_ok().then_some(off)
    }
}

/// The same times, to be written.
struct Again<'a> {
    span: [f64; 2],
    off: &'a [u8],
    t: &'a mut Vec<f64>,
}

impl WithSimd for Again<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let even = even(self.span, self.off.len());
        let time =
            |(off, even): (&u8, f64)| f64::from_bits(even.to_bits().wrapping_add(u64::from(*off)).wrapping_sub(MIDDLE));
        self.t.extend(self.off.iter().zip(even).map(time));
    }
}

/// Equal steps from one time to another.
#[inline(always)]
fn even([first, last]: [f64; 2], count: usize) -> impl Iterator<Item = f64> {
    let step = (last - first) / (count.max(2) - 1) as f64;
    (0..count).map(move |i| first + i as f64 * step)
}

#[cfg(test)]
mod tests {
    use super::PackedTimes;

    #[test]
    fn times_are_kept_to_the_last_bit() {
        type Law = fn(f64) -> f64;
        let even: [Law; 4] = [|i| i / 1000.0, |i| i * 1e-3, |i| 1_699_999_000.25 + i / 1000.0, |_| 0.0];
        let others: [Law; 2] = [|i| i / 300.0 - 50.0, |i| (i + i % 2.0) / 1000.0];
        for (law, is_even) in even.map(|law| (law, true)).into_iter().chain(others.map(|law| (law, false))) {
            for n in [0, 1, 2, 3, 20_000] {
                let t: Vec<f64> = (0..n).map(f64::from).map(law).collect();
                let times = PackedTimes::of(7, &t);
                let mut again = Vec::new();
                times.write(&mut again);
                assert!(t.iter().zip(&again).all(|(a, b)| a.to_bits() == b.to_bits()) && again.len() == t.len());
                assert!(n < 20_000 || matches!(times.law, super::Law::Even(_)) == is_even);
            }
        }
    }
}
