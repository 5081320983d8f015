//! What the stamps of three files show: one recorder, or three.

/// Neighbours farther apart than this many steps of their file have a gap between them.
const GAP: f64 = 2.5;

/// Steps that differ by less than this part are equal: stamps are rounded.
const EQUAL: f64 = 1e-3;

/// How rows of three files become rows of one table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Joining {
    /// Rows with one stamp in all three are one row.
    ByStamp,
    /// Readings are interpolated to the stamps of the slowest file.
    Interpolated {
        /// That file.
        grid: usize,
        /// Of each file the longest time between two samples that have no gap between them.
        gaps: [f64; 3],
    },
}

impl Joining {
    /// By the first stamps of the files since all of them have begun.
    ///
    /// A sample in three may lack partners, as samples are lost. Of files whose rates have a whole ratio no more than every second
    /// sample of the fastest has any: the limit lies between.
    pub fn of(stamps: [&[f64]; 3]) -> Self {
        let end = stamps.iter().filter_map(|stamps| stamps.last()).copied().fold(f64::INFINITY, f64::min);
        let common = stamps.map(|stamps| &stamps[..stamps.partition_point(|t| *t <= end)]);
        let partners = partners(common);
        if common.iter().all(|stamps| 3 * partners >= 2 * stamps.len()) {
            return Self::ByStamp;
        }
        let steps = stamps.map(step);
        let mut grid = 0;
        for (j, step) in steps.iter().enumerate() {
            // On a finer grid neighbouring rows of a slow file would differ by less than its noise, by which plateaus are found.
            if *step > (1.0 + EQUAL) * steps[grid] {
                grid = j;
            }
        }
        let gaps = steps.map(|step| if step.is_finite() { GAP * step } else { 0.0 });
        Self::Interpolated { grid, gaps }
    }
}

/// How many stamps all three have.
fn partners(stamps: [&[f64]; 3]) -> usize {
    let (mut at, mut count) = ([0; 3], 0);
    while let [Some(x), Some(y), Some(z)] = [0, 1, 2].map(|j: usize| stamps[j].get(at[j])) {
        let latest = x.max(*y).max(*z);
        let is_common = x == y && y == z;
        count += usize::from(is_common);
        for (at, t) in at.iter_mut().zip([x, y, z]) {
            *at += usize::from(is_common || *t < latest);
        }
    }
    count
}

/// Time between neighbouring stamps, repeated ones left out: the median, as gaps are long. Infinite where there is one stamp only.
fn step(stamps: &[f64]) -> f64 {
    let mut steps: Vec<f64> = stamps.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
    let middle = steps.len() / 2;
    if steps.is_empty() { f64::INFINITY } else { *steps.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stamps(rate: f64, start: f64, count: i32) -> Vec<f64> {
        (0..count).map(|k| start + f64::from(k) / rate).collect()
    }

    fn grid([x, y, z]: [&[f64]; 3]) -> Option<usize> {
        match Joining::of([x, y, z]) {
            Joining::ByStamp => None,
            Joining::Interpolated { grid, .. } => Some(grid),
        }
    }

    #[test]
    fn one_recorder_is_told_from_three() {
        let x = stamps(100.0, 0.0, 4096);
        let lost: Vec<f64> = x.iter().copied().enumerate().filter(|(k, _)| k % 4 != 1).map(|(_, t)| t).collect();
        assert_eq!(grid([&x, &lost, &x[..3000]]), None);
        assert_eq!(grid([&x, &x, &stamps(100.0, 0.0037, 4096)]), Some(0));
        // Every stamp of the slow ones is one of the fast one.
        let fast = stamps(200.0, 0.0, 4096);
        let slow: Vec<f64> = fast.iter().copied().step_by(2).collect();
        assert_eq!(grid([&fast, &slow, &slow]), Some(1));
        assert_eq!(grid([&x, &stamps(100.3, 0.0, 4096), &stamps(99.7, 0.0, 4096)]), Some(2));
    }

    #[test]
    fn steps_are_those_between_gaps() {
        let burst = [0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 90.0, 90.0, 91.0];
        assert_eq!(step(&burst).to_bits(), 1.0_f64.to_bits());
        assert_eq!(step(&[1.0]).to_bits(), f64::INFINITY.to_bits());
        let few = Joining::of([&[1.0], &[1.5], &[2.0]]);
        assert_eq!(few, Joining::Interpolated { grid: 0, gaps: [0.0; 3] });
    }
}
