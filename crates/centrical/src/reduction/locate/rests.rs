//! The rests of a record that was not scheduled: turned by hand or on a table, and left alone again and again.
//!
//! No threshold says what stands still. A record is divided into rests, each with a level of its own, and motion between
//! them; of all divisions that one is taken whose penalised likelihood is largest. A block `f` of a rest at the level `m` has the
//! density of noise with the covariance `S`, common to all rests, about `m`; a block in motion may read anything that the
//! record reads, with equal density. Three levels and two ends of a rest cost `5 ln N` for `N` blocks (Schwarz's criterion):
//!
//! `sum over rests of (sum (f - m)^T S^-1 (f - m) + n ln det 2 pi S + 5 ln N) + (blocks in motion) 2 ln(range)`,
//!
//! least over all divisions by dynamic programming (Jackson et al. 2005, with pruning as Killick et al. 2012). `S` follows from
//! the rests, and they from `S`, in turn until neither changes. Blocks of coloured noise say less than as many independent ones:
//! with the correlation `r` from one block to the next `n` of them count as `n (1 - r) / (1 + r)`, and the penalty is that much larger.
//!
//! A rest is disturbed where one follows another within two blocks at nearly the same level: no hand turns a unit so fast. Of such
//! a run the longest part is taken. At another level altogether it is another rest: recordings of single rests were joined.

use std::f64::consts::TAU;
use std::ops::Range;

use nalgebra::{Matrix3, Vector3};

use crate::reduction::survey::Blocks;

/// Rounds of levels and noise in turn: three or four are needed.
const ROUNDS: usize = 20;

/// Blocks between two rests that are parts of one: the motion of a hand takes longer.
const DISTURBANCE: usize = 2;

/// Levels of two such parts differ by less than this part of the range of the readings, 12 deg of a sphere.
const SAME_LEVEL: f64 = 0.1;

/// The rests of a record, in blocks, in the order of time.
pub(super) fn rests(blocks: &Blocks) -> Vec<Range<usize>> {
    if blocks.len() <= blocks.least_of_rest() {
        return Vec::new();
    }
    let Some(mut noise) = Noise::of_steps(blocks) else { return Vec::new() };
    let mut rests = Vec::new();
    for _ in 0..ROUNDS {
        let next = Division::of(blocks, &noise).rests();
        if next == rests {
            break;
        }
        rests = next;
        let Some(of_rests) = Noise::of_rests(blocks, &rests) else { break };
        noise = of_rests;
    }
    longest_parts(blocks, &rests)
}

/// Of each run of rests within [`DISTURBANCE`] and [`SAME_LEVEL`] the longest.
fn longest_parts(blocks: &Blocks, rests: &[Range<usize>]) -> Vec<Range<usize>> {
    let range = range(blocks);
    let is_one = |one: &Range<usize>, next: &Range<usize>| {
        let change = (blocks.level(next) - blocks.level(one)).component_div(&range);
        next.start - one.end <= DISTURBANCE && change.amax() < SAME_LEVEL
    };
    let runs = rests.chunk_by(is_one);
    // The first of those that are equally long.
    runs.filter_map(|run| run.iter().rev().max_by_key(|rest| rest.len()).cloned()).collect()
}

/// Noise of the blocks of a rest.
struct Noise {
    /// Takes readings to independent ones of unit variance.
    whitening: Matrix3<f64>,
    /// `ln det 2 pi S`.
    log_determinant: f64,
    /// Independent blocks that a block counts as, 0 to 1.
    independence: f64,
}

impl Noise {
    /// By the changes from block to block: a quarter of them at least is within rests.
    fn of_steps(blocks: &Blocks) -> Option<Self> {
        /// Quartile of the square of a normal variable.
        const QUARTILE: f64 = 0.101_531;
        let variance = |axis: usize| {
            let mut squares: Vec<f64> =
                blocks.f_z.windows(2).map(|pair| (pair[1][axis] - pair[0][axis]).powi(2)).collect();
            let quarter = squares.len() / 4;
            *squares.select_nth_unstable_by(quarter, f64::total_cmp).1 / (2.0 * QUARTILE)
        };
        Self::new(blocks, Matrix3::from_diagonal(&Vector3::from_fn(|axis, _| variance(axis))), 0.0)
    }

    /// By the scatter of the blocks about the levels of their rests; none without rests.
    fn of_rests(blocks: &Blocks, rests: &[Range<usize>]) -> Option<Self> {
        let count: usize = rests.iter().map(|rest| rest.len() - 1).sum();
        if count == 0 {
            return None;
        }
        let (mut squares, mut products) = (Matrix3::zeros(), 0.0);
        for levels in rests.iter().map(|rest| &blocks.f_z[rest.clone()]) {
            let mean = levels.iter().sum::<Vector3<f64>>() / levels.len() as f64;
            for level in levels {
                squares += (level - mean) * (level - mean).transpose();
            }
            products += levels.windows(2).map(|pair| (pair[0] - mean).dot(&(pair[1] - mean))).sum::<f64>();
        }
        Self::new(blocks, squares / count as f64, products / squares.trace())
    }

    /// A step of the readings leaves an error of its own.
    fn new(blocks: &Blocks, covariance: Matrix3<f64>, correlation: f64) -> Option<Self> {
        let rounding = Matrix3::from_diagonal(&(blocks.digit.component_mul(&blocks.digit) / 12.0));
        let factor = (covariance + rounding).cholesky()?;
        let log_determinant = 3.0 * TAU.ln() + 2.0 * factor.l_dirty().diagonal().map(f64::ln).sum();
        let correlation = correlation.max(0.0);
        let independence = (1.0 - correlation) / (1.0 + correlation);
        Some(Self { whitening: factor.l().try_inverse()?, log_determinant, independence })
    }
}

/// The best division of a record.
struct Division {
    /// For each block the first block of the rest that it ends; none for a block in motion.
    begins: Vec<Option<usize>>,
}

/// A rest that may go on, from its first block to the present one.
struct Open {
    first: usize,
    /// Of the best division before its first block.
    cost_before: f64,
    count: f64,
    mean: Vector3<f64>,
    /// Sum of squares about the mean.
    squares: f64,
}

impl Open {
    fn add(&mut self, level: &Vector3<f64>) {
        self.count += 1.0;
        let from_mean = level - self.mean;
        self.mean += from_mean / self.count;
        self.squares += from_mean.dot(&(level - self.mean));
    }

    fn cost(&self, noise: &Noise) -> f64 {
        self.cost_before + self.squares + self.count * noise.log_determinant
    }
}

impl Division {
    fn of(blocks: &Blocks, noise: &Noise) -> Self {
        let levels: Vec<Vector3<f64>> = blocks.f_z.iter().map(|level| noise.whitening * level).collect();
        let penalty = 5.0 * (blocks.len() as f64).ln() / noise.independence;
        let (least, motion) = (blocks.least_of_rest(), motion(blocks));
        let mut open: Vec<Open> = Vec::new();
        let mut begins = Vec::with_capacity(levels.len());
        let mut best = 0.0;
        for (block, level) in levels.iter().enumerate() {
            open.push(Open { first: block, cost_before: best, count: 0.0, mean: Vector3::zeros(), squares: 0.0 });
            for rest in &mut open {
                rest.add(level);
            }
            let is_long = |rest: &&Open| block + 1 - rest.first >= least;
            let cheapest = open.iter().filter(is_long).min_by(|a, b| a.cost(noise).total_cmp(&b.cost(noise)));
            let (in_motion, cheapest) = (best + motion, cheapest.map(|rest| (rest.first, rest.cost(noise))));
            let rest = cheapest.filter(|(_, cost)| cost + penalty < in_motion);
            best = rest.map_or(in_motion, |(_, cost)| cost + penalty);
            begins.push(rest.map(|(first, _)| first));
            // One that half a penalty parts from the best will not catch up: it would have to be worth a rest of its own.
            let limit = cheapest.map_or(f64::INFINITY, |(_, cost)| (cost + 0.5 * penalty).min(best));
            open.retain(|rest| block + 1 - rest.first < least || rest.cost(noise) <= limit);
        }
        Self { begins }
    }

    fn rests(&self) -> Vec<Range<usize>> {
        let mut rests = Vec::new();
        let mut end = self.begins.len();
        while end > 0 {
            match self.begins[end - 1] {
                Some(first) => {
                    rests.push(first..end);
                    end = first;
                }
                None => end -= 1,
            }
        }
        rests.reverse();
        rests
    }
}

/// `2 ln(range)`, the cost of a block in motion.
fn motion(blocks: &Blocks) -> f64 {
    2.0 * range(blocks).map(f64::ln).sum()
}

/// Range of the levels on each axis, a digit at least.
fn range(blocks: &Blocks) -> Vector3<f64> {
    let mut levels = blocks.f_z.iter();
    let first = levels.next().copied().unwrap_or_default();
    let (low, high) = levels.fold((first, first), |(low, high), level| (low.inf(level), high.sup(level)));
    high - low + blocks.digit
}
