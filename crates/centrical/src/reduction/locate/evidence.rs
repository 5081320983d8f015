//! The evidence of a record's blocks for the plateaus, as logarithms of probability densities.
//!
//! A block shows its level, and the change of level about it. In a transition (a ramp, handling, a plateau nobody
//! scheduled) both are anything in the record's span. On a plateau the change is noise and the level is near the
//! nominal one. All densities are given over that of "any change, any level".

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use nalgebra::Vector3;
use pulp::{Simd, WithSimd};

use super::path::LAYER;
use crate::reduction::plateau::ScheduledPlateau;
use crate::reduction::simd::{exp, ln, widest};
use crate::reduction::survey::Blocks;
use crate::statistics::{MAD, median, whole};

/// Share of blocks on a plateau that show something else: a knock, a burst of spikes.
const DISTURBED: f64 = 0.01;

/// Half-width of the level's density on a plateau, relative and absolute [m/s^2]: the uncalibrated unit's scale,
/// misalignment and bias. The density has the tails of Cauchy's law, so the plateaus of a unit ten times worse are found too.
const LEVEL: (f64, f64) = (5e-3, 0.05);

/// [`LEVEL`] about a nominal level [m/s^2].
pub(super) fn level_width(nominal_z: &Vector3<f64>) -> f64 {
    LEVEL.0 * nominal_z.norm() + LEVEL.1
}

/// Blocks whose mean is compared with that of as many before: the more, the slower a change is seen.
const REACH: f64 = 4.0;

/// Whole revolutions above this many [`REACH`] may be longer than half a plateau, and then join each of its blocks to a ramp. The blocks of such a
/// plateau may be steady by [`REACH`] instead; a tilted axis alone prevents that.
const LONG: f64 = 4.0;

/// Noise of a dead channel, over the span of the readings.
const DEAD: f64 = 1e-9;

/// The blocks' evidence.
#[derive(Clone)]
pub(super) struct Evidence<'a> {
    blocks: &'a Blocks,
    /// Largest span of a reading [m/s^2].
    span: f64,
    /// Noise that changes of level are taken for: that of one sample, or louder [m/s^2].
    noise: Vector3<f64>,
    /// Levels per axis, and their sums before each block.
    levels: [Vec<f64>; 3],
    sums: [Vec<f64>; 3],
}

/// The evidence for one scheduled plateau.
pub(super) struct Candidate<'a> {
    evidence: &'a Evidence<'a>,
    /// Blocks to both sides of one, over whose means the change of level about it is seen: whole revolutions.
    reach: f64,
    nominal_z: Vector3<f64>,
    /// Half-width of the level's density [m/s^2].
    width: f64,
    /// Boundaries towards neighbouring plateaus: the way there, and the projection on it beyond which a level is the neighbour's.
    boundaries: Vec<(Vector3<f64>, f64)>,
}

impl<'a> Evidence<'a> {
    /// Evidence of a record.
    pub fn new(blocks: &'a Blocks) -> Self {
        let levels = [0, 1, 2].map(|axis| -> Vec<f64> { blocks.f_z.iter().map(|f| f[axis]).collect() });
        let sums = levels.each_ref().map(|levels| -> Vec<f64> {
            let sums = levels.iter().scan(0.0, |sum, level| Some(std::mem::replace(sum, *sum + level)));
            sums.collect()
        });
        let (mut low, mut high) = (blocks.f_z[0], blocks.f_z[0]);
        for f in &blocks.f_z {
            (low, high) = (low.inf(f), high.sup(f));
        }
        // A record of one plateau spans its noise alone: on the way there the readings spanned half of its level at least.
        let level = low.abs().sup(&high.abs()).max();
        let span = (high - low).max().max(0.5 * level).max(blocks.sample_noise.max());
        let noise = blocks.sample_noise.map(|noise| noise.max(DEAD * span));
        Self { blocks, span, noise, levels, sums }
    }

    /// The same, where changes are noise that is a number of `times` louder.
    pub fn louder(&self, times: f64) -> Self {
        Self { noise: self.noise * times, ..self.clone() }
    }

    /// The record.
    pub fn blocks(&self) -> &'a Blocks {
        self.blocks
    }

    /// Evidence for a scheduled plateau.
    pub fn of(&self, plateau: &ScheduledPlateau) -> Candidate<'_> {
        Candidate {
            evidence: self,
            reach: self.reach(plateau.omega),
            nominal_z: plateau.nominal_z,
            width: level_width(&plateau.nominal_z),
            boundaries: Vec::new(),
        }
    }

    /// In a transition: moving or, as likely, steady at a level of no scheduled plateau.
    pub fn in_transition(&self) -> Vec<f64> {
        let mut steadiness = self.steadiness();
        widest(Mixture { share: 0.5, x: &mut steadiness });
        steadiness
    }

    /// The noise to begin with: that of one sample. White noise makes the change of block levels far smaller,
    /// and coloured noise hardly larger.
    pub fn noise(&self) -> &Vector3<f64> {
        &self.noise
    }

    /// Noise of a block's level if it were white, over some blocks [m/s^2].
    fn white(&self, range: &Range<usize>) -> Vector3<f64> {
        let noise = self.blocks.sample_noise_in(range).sup(&Vector3::repeat(DEAD * self.span));
        noise * (self.blocks.interval / self.blocks.width).sqrt()
    }

    /// Steady stretches of the record, whatever the schedule.
    pub fn steady_stretches(&self) -> Vec<Range<usize>> {
        let steady: Vec<bool> = self.steadiness().iter().map(|steady| *steady > 0.0).collect();
        let mut from = 0;
        let runs = steady.chunk_by(bool::eq).map(|run| {
            from += run.len();
            (run[0], from - run.len()..from)
        });
        runs.filter(|(steady, range)| *steady && range.len() as f64 > REACH).map(|(_, range)| range).collect()
    }

    fn steadiness(&self) -> Vec<f64> {
        let mut steadiness = vec![0.0; self.blocks.len()];
        for (k, steadiness) in steadiness.chunks_mut(LAYER).enumerate() {
            self.density_of_change(self.reach(0.0), &self.noise, k * LAYER, steadiness);
        }
        steadiness
    }

    /// Density of the change about each block of a piece if it is noise, over that of any change; logarithm.
    fn density_of_change(&self, reach: f64, noise: &Vector3<f64>, from: usize, density: &mut [f64]) {
        let mut changes = [[0.0; LAYER]; 3];
        let mut changes = changes.each_mut().map(|changes| &mut changes[..density.len()]);
        for (axis, changes) in changes.iter_mut().enumerate() {
            self.changes(axis, reach, from, changes);
        }
        widest(ChangeDensity { changes: changes.each_ref().map(|c| &**c), noise, span: self.span, density });
    }

    /// Change of level about the blocks from one on: the mean over the reach from a block on, less that over the reach up to
    /// it.
    fn changes(&self, axis: usize, reach: f64, from: usize, changes: &mut [f64]) {
        let (n, all) = (self.blocks.len(), from..from + changes.len());
        // Away from the ends of the record every block has its neighbours at the same distance.
        let whole_reach = whole(reach.ceil());
        let start = whole_reach.clamp(all.start, all.end);
        let end = n.saturating_sub(whole_reach + 1).clamp(start, all.end);
        for i in (all.start..start).chain(end..all.end) {
            let here = i as f64;
            changes[i - from] =
                self.mean_level(axis, here, here + reach) - self.mean_level(axis, here + 1.0 - reach, here + 1.0);
        }
        if start < end {
            let (levels, sums, changes) =
                (&self.levels[axis], &self.sums[axis], &mut changes[start - from..end - from]);
            widest(InnerChanges { levels, sums, reach, from: start, changes });
        }
    }

    /// Whole revolutions, in blocks.
    fn reach(&self, omega: f64) -> f64 {
        let revolution = if omega == 0.0 { REACH } else { TAU / omega.abs() / self.blocks.width };
        (revolution * (REACH / revolution).ceil()).min(self.blocks.len() as f64)
    }

    /// Mean level on an axis from block `from` to block `to`, in parts of blocks.
    fn mean_level(&self, axis: usize, from: f64, to: f64) -> f64 {
        let (from, to) = (from.max(0.0), to.min(self.blocks.len() as f64));
        let integral = |x: f64| {
            let i = whole(x).min(self.blocks.len() - 1);
            self.sums[axis][i] + self.levels[axis][i] * (x - i as f64)
        };
        (integral(to) - integral(from)) / (to - from)
    }
}

/// Changes of level about the blocks from one on, that have all of the reach to both sides.
struct InnerChanges<'a> {
    levels: &'a [f64],
    sums: &'a [f64],
    reach: f64,
    from: usize,
    changes: &'a mut [f64],
}

impl WithSimd for InnerChanges<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { levels, sums, reach, from, changes } = self;
        // Where the mean ahead ends, `reach` on, and the mean behind begins, `reach - 1` back: whole blocks and parts.
        let (ahead, behind) = (whole(reach), whole((reach - 1.0).ceil()));
        let (part_ahead, part_behind) = (reach - ahead as f64, behind as f64 - (reach - 1.0));
        let n = changes.len();
        let blocks = |start: usize| start..start + n;
        let (ends, ends_sums) = (&levels[blocks(from + ahead)], &sums[blocks(from + ahead)]);
        let (begins, begins_sums) = (&levels[blocks(from - behind)], &sums[blocks(from - behind)]);
        let (here_sums, next_sums) = (&sums[blocks(from)], &sums[blocks(from + 1)]);
        for (i, change) in changes.iter_mut().enumerate() {
            let after = ends_sums[i] + ends[i] * part_ahead - here_sums[i];
            let before = next_sums[i] - (begins_sums[i] + begins[i] * part_behind);
            *change = (after - before) / reach;
        }
    }
}

/// Multiplies a density by that of levels near a nominal one, over that of any level; logarithms.
struct LevelDensity<'a> {
    levels: [&'a [f64]; 3],
    nominal_z: Vector3<f64>,
    width: f64,
    span: f64,
    density: &'a mut [f64],
}

impl WithSimd for LevelDensity<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let [f1, f2, f3] = self.levels;
        let nominal = self.nominal_z;
        let (scale, any) = (1.0 / (self.width * self.width), 3.0 * (self.span / self.width).ln());
        for (((density, f1), f2), f3) in self.density.iter_mut().zip(f1).zip(f2).zip(f3) {
            let (d1, d2, d3) = (f1 - nominal[0], f2 - nominal[1], f3 - nominal[2]);
            *density += any - 2.0 * ln(PI * (1.0 + (d1 * d1 + d2 * d2 + d3 * d3) * scale));
        }
    }
}

/// Density of changes if they are noise, over that of any change; logarithm.
struct ChangeDensity<'a> {
    changes: [&'a [f64]; 3],
    noise: &'a Vector3<f64>,
    span: f64,
    density: &'a mut [f64],
}

impl WithSimd for ChangeDensity<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let [c1, c2, c3] = self.changes;
        let any = 3.0 * (self.span / (self.noise.product().cbrt() * TAU.sqrt())).ln();
        let noise = self.noise.map(|noise| 1.0 / noise);
        for (((density, c1), c2), c3) in self.density.iter_mut().zip(c1).zip(c2).zip(c3) {
            let (x1, x2, x3) = (c1 * noise[0], c2 * noise[1], c3 * noise[2]);
            *density = any - 0.5 * (x1 * x1 + x2 * x2 + x3 * x3);
        }
    }
}

/// `ln(share e^x + 1 - share)` of many `x`.
struct Mixture<'a> {
    share: f64,
    x: &'a mut [f64],
}

impl WithSimd for Mixture<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        // Beyond this, one of the two terms is below the rounding of the other.
        const ONE_ONLY: f64 = 45.0;
        let (share, of_share) = (self.share, self.share.ln());
        for x in self.x {
            let both = ln(share * exp(x.min(ONE_ONLY)) + 1.0 - share);
            *x = if *x > ONE_ONLY { of_share + *x } else { both };
        }
    }
}

impl Candidate<'_> {
    /// On the plateau: a change as noise and the level near the nominal, or a disturbance that shows anything; of a piece of
    /// blocks from one on.
    pub fn density(&self, noise: &Vector3<f64>, from: usize, density: &mut [f64]) {
        self.evidence.density_of_change(self.reach, noise, from, density);
        if self.is_slow() {
            let mut near = [0.0; LAYER];
            let near = &mut near[..density.len()];
            self.evidence.density_of_change(REACH, noise, from, near);
            density.iter_mut().zip(near).for_each(|(density, near)| *density = density.max(*near));
        }
        self.multiply_by_level(from, density);
        widest(Mixture { share: 1.0 - DISTURBED, x: density });
    }

    /// Multiplies the density of a piece of blocks from one on by that of their levels.
    fn multiply_by_level(&self, from: usize, density: &mut [f64]) {
        let Self { evidence, nominal_z, width, .. } = *self;
        let piece = from..from + density.len();
        let levels = evidence.levels.each_ref().map(|levels| &levels[piece.clone()]);
        widest(LevelDensity { levels, nominal_z, width, span: evidence.span, density: &mut *density });
        for (way, half_way) in &self.boundaries {
            for (density, f_z) in density.iter_mut().zip(&evidence.blocks.f_z[piece.clone()]) {
                if f_z.dot(way) > *half_way {
                    *density = f64::NEG_INFINITY;
                }
            }
        }
    }

    /// Leaves the blocks to a neighbouring plateau whose level is more than half-way to its own, now that the level `level_z` of
    /// this one is known. The end of a slow settling looks like noise, and such noise would explain the settling of the neighbour too.
    ///
    /// Plateaus whose levels real units may exchange have no such boundary.
    pub fn leave_to(&mut self, neighbour: &ScheduledPlateau, plateau: &ScheduledPlateau, level_z: &Vector3<f64>) {
        let way = neighbour.nominal_z - plateau.nominal_z;
        if way.norm() >= level_width(&plateau.nominal_z) {
            self.boundaries.push((way, level_z.dot(&way) + 0.5 * way.norm_squared()));
        }
    }

    /// The reach by which blocks of a range are compared with others of it: the shorter one where whole revolutions leave it.
    fn reach_within(&self, range: &Range<usize>) -> f64 {
        /// In a range of fewer reaches, most blocks have no whole reach to both sides.
        const FEW: f64 = 3.0;
        let leaves = self.is_slow() && (range.len() as f64) < FEW * self.reach;
        if leaves { REACH } else { self.reach }
    }

    /// Whether whole revolutions may be longer than half the plateau.
    fn is_slow(&self) -> bool {
        self.reach > LONG * REACH
    }

    /// Whether the level of a block is more likely the plateau's than any other.
    pub fn has_level(&self, block: usize) -> bool {
        let mut density = [0.0];
        self.multiply_by_level(block, &mut density);
        density[0] > 0.0
    }

    /// Whether the level goes up as well as down over some blocks, on every axis that moves: the median change is within the scatter about it.
    pub fn goes_up_and_down(&self, range: &Range<usize>) -> bool {
        let white = self.evidence.white(range);
        let mut changes = vec![0.0; range.len()];
        (0..3).all(|axis| {
            self.evidence.changes(axis, self.reach_within(range), range.start, &mut changes);
            let middle = median(&mut changes.clone());
            let mut sizes: Vec<f64> = changes.iter().map(|change| (change - middle).abs()).collect();
            middle.abs() <= (MAD * median(&mut sizes)).max(white[axis])
        })
    }

    /// Robust standard deviation of the change over some blocks, not below what white noise makes.
    pub fn noise_of_change(&self, range: &Range<usize>) -> Vector3<f64> {
        let white = self.evidence.white(range);
        let mut sizes = vec![0.0; range.len()];
        Vector3::from_fn(|axis, _| {
            self.evidence.changes(axis, self.reach_within(range), range.start, &mut sizes);
            for change in &mut sizes {
                *change = change.abs();
            }
            (MAD * median(&mut sizes)).max(white[axis])
        })
    }
}
