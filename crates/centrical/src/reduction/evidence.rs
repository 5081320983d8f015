//! What the blocks of a record say of where they belong, as logarithms of probability densities.
//!
//! A block shows its level, and the change of level about it. In a transition (a ramp, handling, a plateau nobody
//! scheduled) both are anything in the record's span. On a plateau the change is noise and the level is near the
//! nominal one. All densities are given over that of "any change, any level".

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use nalgebra::Vector3;

use super::ScheduledPlateau;
use super::blocks::{Blocks, MAD, median, whole};

/// Share of blocks on a plateau that show something else: a knock, a burst of spikes.
const DISTURBED: f64 = 0.01;

/// Half-width of the level's density on a plateau, relative and absolute [m/s^2]: the uncalibrated unit's scale,
/// misalignment and bias. The density has the tails of Cauchy's law, so a unit ten times worse is found as well.
pub(super) const LEVEL: (f64, f64) = (5e-3, 0.05);

/// Blocks whose mean is compared with that of as many before: the more, the slower a change is seen.
const REACH: f64 = 4.0;

/// The blocks' evidence.
pub(super) struct Evidence<'a> {
    blocks: &'a Blocks,
    /// Largest span of a reading [m/s^2].
    span: f64,
    /// Noise of one sample; of a dead channel a billionth of the span [m/s^2].
    noise: Vector3<f64>,
    /// Sums of the block levels before each block.
    sums: Vec<Vector3<f64>>,
}

/// The evidence for one scheduled plateau.
pub(super) struct Candidate {
    span: f64,
    /// Noise of a block's level if it were white [m/s^2].
    white: Vector3<f64>,
    /// Change of level about each block [m/s^2].
    changes: Vec<Vector3<f64>>,
    /// Logarithm of the density of each block's level.
    levels: Vec<f64>,
}

impl<'a> Evidence<'a> {
    /// Evidence of a record.
    pub fn new(blocks: &'a Blocks) -> Self {
        let mut sums = vec![Vector3::zeros()];
        let (mut low, mut high) = (blocks.f_z[0], blocks.f_z[0]);
        for f in &blocks.f_z {
            sums.push(sums[sums.len() - 1] + f);
            (low, high) = (low.inf(f), high.sup(f));
        }
        let span = (high - low).max().max(blocks.sample_noise.max());
        let noise = blocks.sample_noise.map(|noise| noise.max(1e-9 * span));
        Self { blocks, span, noise, sums }
    }

    /// Evidence for a scheduled plateau.
    pub fn of(&self, plateau: &ScheduledPlateau) -> Candidate {
        let width = LEVEL.0 * plateau.nominal_z.norm() + LEVEL.1;
        let level = |f: &Vector3<f64>| {
            let distance = (f - plateau.nominal_z).norm() / width;
            3.0 * (self.span / width).ln() - 2.0 * (PI * (1.0 + distance * distance)).ln()
        };
        Candidate {
            span: self.span,
            white: self.noise * (self.blocks.interval / self.blocks.width).sqrt(),
            changes: self.changes(plateau.omega),
            levels: self.blocks.f_z.iter().map(level).collect(),
        }
    }

    /// In a transition: moving or, as likely, steady at a level of no scheduled plateau.
    pub fn in_transition(&self) -> Vec<f64> {
        let steadiness = self.steadiness();
        steadiness.iter().map(|steady| mixture(0.5, *steady)).collect()
    }

    /// The noise to begin with: that of one sample. White noise makes the change of block levels far smaller,
    /// and coloured noise hardly larger.
    pub fn noise(&self) -> &Vector3<f64> {
        &self.noise
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
        self.changes(0.0).iter().map(|change| noise_like(change, &self.noise, self.span)).collect()
    }

    /// Change of level about each block: the mean of whole revolutions from it on, less that of as many up to it.
    fn changes(&self, omega: f64) -> Vec<Vector3<f64>> {
        let reach = self.reach(omega);
        let change = |i: usize| {
            let here = i as f64;
            self.mean_level(here, here + reach) - self.mean_level(here + 1.0 - reach, here + 1.0)
        };
        (0..self.blocks.len()).map(change).collect()
    }

    fn reach(&self, omega: f64) -> f64 {
        let revolution = if omega == 0.0 { REACH } else { TAU / omega.abs() / self.blocks.width };
        (revolution * (REACH / revolution).ceil()).min(self.blocks.len() as f64)
    }

    /// Mean level from block `from` to block `to`, in parts of blocks.
    fn mean_level(&self, from: f64, to: f64) -> Vector3<f64> {
        let (from, to) = (from.max(0.0), to.min(self.blocks.len() as f64));
        let integral = |x: f64| {
            let i = whole(x).min(self.blocks.len() - 1);
            self.sums[i] + self.blocks.f_z[i] * (x - i as f64)
        };
        (integral(to) - integral(from)) / (to - from)
    }
}

impl Candidate {
    /// On the plateau: a change as noise and the level near the nominal, or a disturbance that shows anything.
    pub fn density(&self, noise: &Vector3<f64>) -> Vec<f64> {
        let blocks = self.changes.iter().zip(&self.levels);
        blocks.map(|(change, level)| mixture(1.0 - DISTURBED, noise_like(change, noise, self.span) + level)).collect()
    }

    /// Whether the level of a block is rather the plateau's than any.
    pub fn has_level(&self, block: usize) -> bool {
        self.levels[block] > 0.0
    }

    /// Robust standard deviation of the change over some blocks, not below what white noise makes.
    pub fn noise_of_change(&self, range: &Range<usize>) -> Vector3<f64> {
        let changes = &self.changes[range.clone()];
        let size = |axis: usize| changes.iter().map(|change| change[axis].abs()).collect::<Vec<f64>>();
        Vector3::from_fn(|axis, _| (MAD * median(&mut size(axis))).max(self.white[axis]))
    }
}

/// Density of a change if it is noise, over that of any change; logarithm.
fn noise_like(change: &Vector3<f64>, noise: &Vector3<f64>, span: f64) -> f64 {
    let scale = span / (noise.product().cbrt() * TAU.sqrt());
    3.0 * scale.ln() - 0.5 * change.component_div(noise).norm_squared()
}

/// `ln(share e^x + 1 - share)`.
fn mixture(share: f64, x: f64) -> f64 {
    // Beyond this one of the two is less than the rounding of the other.
    const ONE_ONLY: f64 = 45.0;
    if x > ONE_ONLY {
        share.ln() + x
    } else if x < -ONE_ONLY {
        (1.0 - share).ln()
    } else {
        (share * x.exp() + 1.0 - share).ln()
    }
}
