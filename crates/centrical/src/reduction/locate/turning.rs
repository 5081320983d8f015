//! Arcs of a record in which the unit turns slowly.
//!
//! A block outside all rests belongs to slow rotation if the readings change slowly about it: from the block before to the one after
//! by the rate [`FASTEST`] and four standard deviations of their noise at most. Neighbouring blocks are gathered into arcs. An arc turns
//! by [`ANGLE`] at most, so that a polynomial of third degree describes it, and lasts [`LONGEST`] at most.

use std::ops::Range;

use nalgebra::Vector3;

use crate::reduction::survey::Blocks;

/// Fastest rotation that counts as slow [rad/s]: 3 deg/s.
const FASTEST: f64 = 3.0 * std::f64::consts::PI / 180.0;

/// Most that an arc turns [rad]. What the polynomial leaves along the force is `g ANGLE^4 / 1680`, below 3e-5 m/s^2.
const ANGLE: f64 = 0.25;

/// Longest and shortest arc [s].
const LONGEST: f64 = 30.0;
const SHORTEST: f64 = 2.0;

/// Parts of an arc whose angles are summed.
const WAY: usize = 8;

/// Most that a rest turns [rad]: its mean is `g STILL^2 / 24` shorter, below 4e-6 m/s^2.
const STILL: f64 = 3e-3;

/// Blocks about a rest, or about a block in faster motion, that belong to neither.
const MARGIN: usize = 2;

/// The arcs, in blocks, in the order of time.
pub(super) fn arcs(blocks: &Blocks, rests: &[Range<usize>]) -> Vec<Range<usize>> {
    let count = blocks.len();
    let mut is_free = vec![true; count];
    let mut exclude = |range: Range<usize>| {
        let (from, to) = (range.start.saturating_sub(MARGIN), (range.end + MARGIN).min(count));
        is_free[from..to].fill(false);
    };
    for rest in rests {
        exclude(rest.clone());
    }
    for block in 0..count {
        if !is_slow(blocks, block) {
            exclude(block..block + 1);
        }
    }
    let mut arcs = Vec::new();
    let mut from = 0;
    while from < count {
        let to = (from..count).find(|block| !is_free[*block] || !is_next(blocks, from, *block)).unwrap_or(count);
        divide(blocks, from..to, &mut arcs);
        from = to.max(from + 1);
    }
    arcs
}

/// Whether the unit stood still in what was found as a rest: from its first quarter to the last the readings turn by [`STILL`] at most, and by
/// four standard deviations of their noise. In a record of slow rotation the noise of rests is not known, and they may hold rotation.
pub(super) fn is_still(blocks: &Blocks, rest: &Range<usize>) -> bool {
    let quarter = (rest.len() / 4).max(1);
    let [first, last] = [rest.start, rest.end - quarter].map(|n| level(blocks, n..n + quarter));
    let noise = noise_of_difference(blocks, quarter);
    first.angle(&last) <= STILL + 4.0 * noise / first.norm()
}

/// Whether the readings change slowly about a block.
fn is_slow(blocks: &Blocks, block: usize) -> bool {
    let (before, after) = (block.saturating_sub(1), (block + 1).min(blocks.len() - 1));
    let time = blocks.t[after] - blocks.t[before];
    let change = (blocks.f_z[after] - blocks.f_z[before]).norm();
    change <= FASTEST * time * blocks.f_z[block].norm() + 4.0 * noise_of_difference(blocks, 1)
}

/// Noise of the difference of two means of `count` blocks, in any direction [m/s^2].
fn noise_of_difference(blocks: &Blocks, count: usize) -> f64 {
    blocks.sample_noise.norm() * (2.0 * blocks.interval / (blocks.width * count as f64)).sqrt()
}

/// Whether no blocks are missing between two.
fn is_next(blocks: &Blocks, first: usize, block: usize) -> bool {
    blocks.t[block] - blocks.t[first] < (block - first) as f64 * blocks.width + 0.5 * blocks.width
}

/// Divides a run of blocks into arcs, each as long as it may be.
fn divide(blocks: &Blocks, run: Range<usize>, arcs: &mut Vec<Range<usize>>) {
    let long = |duration: f64| (duration / blocks.width).floor();
    let mut from = run.start;
    while from < run.end {
        let is_within = |to: &usize| {
            // By way of some places between: a unit that turns back ends where it began.
            let place = |k: usize| {
                let first = from + (*to - MARGIN - from) * k / WAY;
                level(blocks, first..first + MARGIN)
            };
            let turn: f64 = (0..WAY).map(|k| place(k).angle(&place(k + 1))).sum();
            (*to - from) as f64 <= long(LONGEST) && turn <= ANGLE
        };
        let to = (from + MARGIN..=run.end).take_while(is_within).last();
        let Some(to) = to else { return };
        if (to - from) as f64 >= long(SHORTEST) {
            arcs.push(from..to);
        }
        from = to;
    }
}

fn level(blocks: &Blocks, range: Range<usize>) -> Vector3<f64> {
    let levels = &blocks.f_z[range.start..range.end.min(blocks.len())];
    levels.iter().sum::<Vector3<f64>>() / levels.len() as f64
}
