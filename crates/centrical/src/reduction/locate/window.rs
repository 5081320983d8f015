//! The window of each plateau, and the settling after its ramp.
//!
//! Block levels are fitted by a constant, the once-per-revolution term and, while spinning, the exponential end
//! of the settling. A window is the longest stretch about the middle of a plateau that this fit describes to within the
//! noise: it begins once the settling is exponential, and the remaining settling is fitted. Its time constant is a
//! property of the drive, common to the mounting. What straight lines describe better is drift: it stays in the readings.

use std::f64::consts::TAU;
use std::ops::Range;

use nalgebra::Vector3;
use pulp::{Simd, WithSimd};
use rayon::prelude::*;

use super::block_fit::{BlockFit, Levels, spread};
use crate::reduction::error::ReductionError;
use crate::reduction::plateau::ScheduledPlateau;
use crate::reduction::simd::{dot, widest};
use crate::reduction::survey::Blocks;
use crate::reduction::terms::{FADED, Settling, Shape, Window};
use crate::statistics::{cut, median};

/// The windows of one mounting.
#[derive(Debug, Clone)]
pub(super) struct Windows {
    /// In the order of the schedule.
    pub plateaus: Vec<Window>,
    /// Time constant of the settling, common to the mounting [s].
    pub settling_time: Option<f64>,
}

/// Finds the windows about the cores.
pub(super) fn refine(
    blocks: &Blocks,
    schedule: &[ScheduledPlateau],
    cores: &[Range<usize>],
) -> Result<Windows, ReductionError> {
    let mut search =
        Search { blocks, schedule, cores, ranges: cores.to_vec(), settling_time: None, bends: vec![0.0; cores.len()] };
    search.check()?;
    search.grow();
    if !search.best_settling().is_some_and(|settling| settling.seen) {
        search.settling_time = None;
        search.take((0..cores.len()).into_par_iter().map(|k| search.range(k)).collect());
    }
    Ok(search.windows())
}

/// Rounds of growth: the gain after some is a block at most.
const ROUNDS: usize = 6;

/// The ranges have settled once fewer than one of this many change: among hundreds some always do, by a block, and move the
/// time constant that all of them share by next to nothing.
const SETTLED: usize = 16;

struct Search<'a> {
    blocks: &'a Blocks,
    schedule: &'a [ScheduledPlateau],
    cores: &'a [Range<usize>],
    ranges: Vec<Range<usize>>,
    settling_time: Option<f64>,
    /// Of each plateau, the part of the settling's law that goes with the square, at the start of its range.
    bends: Vec<f64>,
}

impl Search<'_> {
    /// Refuses plateaus that are too short.
    fn check(&self) -> Result<(), ReductionError> {
        for (index, core) in self.cores.iter().enumerate() {
            let least = self.blocks.least(self.schedule[index].omega);
            if core.len() < least {
                let window = [self.blocks.t[core.start], self.blocks.t[core.end - 1]];
                return Err(ReductionError::PlateauTooShort { index, window, least: least as f64 * self.blocks.width });
            }
        }
        Ok(())
    }

    /// Longer windows give a better time constant, and a better one allows longer windows. The cores hold little settling:
    /// their first estimate is tried, and judged once the windows have grown by it.
    fn grow(&mut self) {
        for _ in 0..ROUNDS {
            self.settling_time = self.best_settling().map(|settling| settling.time);
            self.bends = (0..self.cores.len()).into_par_iter().map(|k| self.bend(k)).collect();
            let ranges: Vec<Range<usize>> = (0..self.cores.len()).into_par_iter().map(|k| self.range(k)).collect();
            let changed = ranges.iter().zip(&self.ranges).filter(|(range, before)| range != before).count();
            if changed > 0 {
                self.take(ranges);
            }
            if SETTLED * changed < self.cores.len() {
                break;
            }
        }
    }

    /// The time constant that explains most of the residuals of the spinning plateaus together. It is seen if it
    /// explains more than its coefficients would of noise (Schwarz's criterion), and more than a drift would.
    fn best_settling(&self) -> Option<Guess> {
        let spinning: Vec<usize> = (0..self.ranges.len()).filter(|k| self.schedule[*k].omega != 0.0).collect();
        let steady = spinning.par_iter().map(|k| {
            let range = &self.ranges[*k];
            let levels = self.levels(*k, range.clone(), range.len(), None);
            Some((Steady::new(&self.blocks.t[range.clone()], &levels.fit(range.clone())?), self.bends[*k]))
        });
        let steady = steady.collect::<Option<Vec<_>>>()?;
        let shortest = spinning.iter().map(|k| self.cores[*k].len()).min()? as f64 * self.blocks.width;
        // Longer than a quarter of the plateau it is drift; shorter than a block it is over before it is seen.
        let (low, high) = (self.blocks.width.ln(), (0.25 * shortest).ln().max(self.blocks.width.ln()));
        let explained = |ln_tau: f64| -> f64 {
            steady.iter().map(|(fit, bend)| fit.explained_by(Settling { time: ln_tau.exp(), bend: *bend })).sum()
        };
        let ln_tau = maximum(low, high, explained);
        let blocks: usize = self.ranges.iter().map(Range::len).sum();
        let coefficients = 3 * spinning.len() + 1;
        // Slow noise looks like settling in block residuals: the explained part counts less in proportion.
        let colour = steady.iter().map(|(fit, _)| fit.colour).sum::<f64>() / steady.len() as f64;
        let chance = colour.max(1.0) * coefficients as f64 * (blocks as f64).ln();
        let by_drift: f64 = steady.iter().map(|(fit, _)| fit.explained_by_drift()).sum();
        Some(Guess { time: ln_tau.exp(), seen: explained(ln_tau) > chance.max(by_drift) })
    }

    fn settling_of(&self, plateau: usize) -> Option<f64> {
        self.settling_time.filter(|_| self.schedule[plateau].omega != 0.0)
    }

    /// A plateau's settling as it is at the start of a range of blocks.
    fn settling_at(&self, k: usize, range: &Range<usize>) -> Option<Settling> {
        let delay = self.blocks.t[range.start] - self.blocks.t[self.ranges[k].start];
        self.settling_of(k).map(|time| Settling { time, bend: self.bends[k] }.after(delay))
    }

    /// The levels of some blocks with the design of a plateau's reading. Settling that began earlier has the same shape:
    /// the fits over any of these blocks have the design in common. It has the once-per-revolution term if `shown`
    /// blocks show it.
    fn levels(&self, k: usize, range: Range<usize>, shown: usize, settling: Option<Settling>) -> Levels {
        let omega = self.schedule[k].omega;
        let omega = if turns_seen(omega, self.blocks.width, shown) { omega } else { 0.0 };
        Levels::new(
            self.blocks,
            range.clone(),
            &Shape { start: self.blocks.t[self.ranges[k].start], omega, settling, turning: None },
        )
    }

    /// Takes other ranges; the bends go with their starts.
    fn take(&mut self, ranges: Vec<Range<usize>>) {
        let settling = |(k, range)| self.settling_at(k, range);
        self.bends = ranges.iter().enumerate().map(settling).map(|s| s.map_or(0.0, |settling| settling.bend)).collect();
        self.ranges = ranges;
    }

    /// The bend of a plateau's settling at the start of its range: a quarter of the force's relative error.
    fn bend(&self, k: usize) -> f64 {
        let (nominal_z, range) = (self.schedule[k].nominal_z, self.ranges[k].clone());
        let Some(settling) = self.settling_at(k, &range) else { return 0.0 };
        let levels = self.levels(k, range.clone(), range.len(), Some(settling));
        let settling = levels.fit(range).map_or(Vector3::zeros(), |fit| fit.settling());
        0.25 * settling.dot(&nominal_z) / nominal_z.norm_squared()
    }

    /// The blocks of a plateau: the longest range about the middle of its core that its fit describes,
    /// no further than the neighbours' cores. The noise is that of the core, slow noise included; the margins of the
    /// core may hold the slow start of a ramp.
    fn range(&self, k: usize) -> Range<usize> {
        let core = &self.cores[k];
        let from = if k == 0 { 0 } else { self.cores[k - 1].end };
        let to = self.cores.get(k + 1).map_or(self.blocks.len(), |next| next.start);
        let levels = self.levels(k, from..to, core.len(), self.settling_at(k, &self.ranges[k]));
        let Some(of_core) = levels.fit(core.clone()) else { return core.clone() };
        let (scale, cut) = (of_core.scale(), cut(self.blocks.len()));
        let fits = |range: Range<usize>| levels.fit(range).is_some_and(|fit| !fit.has_two_off(&scale, cut));
        let quarter = core.len() / 4;
        let (first, last) = (core.start + quarter, core.end - quarter);
        let end = last + furthest(to - last, |more| fits(first..last + more));
        let start = first - furthest(first - from, |more| fits(first - more..end));
        // A block off alone is a disturbance inside, and the begin of a ramp at an edge.
        let off = levels.fit(start..end).map(|fit| fit.off(&scale, cut)).unwrap_or_default();
        let at_edge = |block: Option<&bool>| usize::from(block.is_some_and(|off| *off));
        start + at_edge(off.first())..end - at_edge(off.last())
    }

    /// The windows, with a margin: the block at an edge may hold the onset of the ramp below the noise, and deviations
    /// from the settling's law get another time constant to fade.
    fn windows(&self) -> Windows {
        let half = 0.5 * self.blocks.width;
        let window = |k: usize| {
            let range = &self.ranges[k];
            let wait = self.blocks.width + self.settling_of(k).unwrap_or(0.0);
            let from = self.blocks.t[range.start] - half + wait;
            let to = self.blocks.t[range.end - 1] + half - self.blocks.width;
            let settling = self.settling_at(k, range).map(|settling| settling.after(wait - half));
            Window {
                span: [from, to],
                shape: Shape { start: from, omega: self.schedule[k].omega, settling, turning: None },
            }
        };
        Windows { plateaus: (0..self.ranges.len()).map(window).collect(), settling_time: self.settling_time }
    }
}

/// A time constant of the settling [s], and whether the record shows any settling.
#[derive(Clone, Copy)]
struct Guess {
    time: f64,
    seen: bool,
}

/// The greatest of `0..=most` that is accepted, by steps halved on refusal. Passes are repeated while they gain: chance
/// may refuse a value below the limit, but rarely its neighbours too. A refused value is not tried again.
fn furthest(most: usize, accepted: impl Fn(usize) -> bool) -> usize {
    let (mut reached, mut refused) = (0, Vec::new());
    loop {
        let before = reached;
        let mut step = most - reached;
        while step > 0 {
            let next = reached + step;
            if !refused.contains(&next) && accepted(next) {
                reached = next;
                step = step.min(most - reached);
            } else {
                refused.push(next);
                step /= 2;
            }
        }
        if reached == before {
            return reached;
        }
    }
}

/// A plateau's block levels fitted without settling.
struct Steady {
    /// Time from the first block [s].
    since: Vec<f64>,
    /// Orthonormal columns of the design.
    q: Vec<Vec<f64>>,
    /// Residuals per axis in units of their spread.
    residuals: [Vec<f64>; 3],
    /// Variance of means of many blocks over what it would be if the blocks were independent.
    colour: f64,
}

impl Steady {
    fn new(t: &[f64], fit: &BlockFit) -> Self {
        let residuals = fit.residuals();
        // The spread is that of the later half, where the settling is over.
        let about = residuals.each_ref().map(|residuals| -> Vec<f64> {
            let later = &residuals[residuals.len() / 2..];
            let middle = median(&mut later.to_vec());
            later.iter().map(|r| r - middle).collect()
        });
        let scale = spread(&about, fit.floor());
        let scaled = |residuals: [Vec<f64>; 3]| {
            let mut axis = 0..3;
            residuals.map(|residuals| -> Vec<f64> {
                let scale = axis.next().map_or(1.0, |axis| scale[axis]);
                residuals.iter().map(|r| r / scale).collect()
            })
        };
        let since = t.iter().map(|time| time - t[0]).collect();
        Self { since, q: fit.orthonormal(), residuals: scaled(residuals), colour: colour(&scaled(about)) }
    }

    /// The part of the residuals' sum of squares that a settling explains.
    fn explained_by(&self, settling: Settling) -> f64 {
        // Later values are negligible.
        let shown = self.since.partition_point(|since| *since < FADED * settling.time);
        widest(Explained { of: self, shown, law: |since| settling.value(since) })
    }

    /// The part that a straight line explains.
    fn explained_by_drift(&self) -> f64 {
        widest(Explained { of: self, shown: self.since.len(), law: |since| since })
    }
}

/// A law of time to be tried on the first residuals; it is zero after the `shown` ones.
struct Explained<'a, L> {
    of: &'a Steady,
    shown: usize,
    law: L,
}

impl<L: Fn(f64) -> f64> WithSimd for Explained<'_, L> {
    type Output = f64;

    /// `sum_k (c^T r_k)^2 / (c^T c - sum_j (q_j^T c)^2)`: the residuals are orthogonal to the design. So is a fourth of a column's square or
    /// more: a settling fades in a quarter of the plateau, and a line is zero at its first block.
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let (Steady { since, q, residuals, .. }, n) = (self.of, self.shown);
        let mut column = vec![0.0; n];
        for (value, since) in column.iter_mut().zip(since) {
            *value = (self.law)(*since);
        }
        let mut square = dot(simd, &column, &column);
        for q in q {
            square -= dot(simd, &q[..n], &column).powi(2);
        }
        let mut explained = 0.0;
        for residuals in residuals {
            explained += dot(simd, &column, &residuals[..n]).powi(2) / square;
        }
        explained
    }
}

/// Variance of the means of quarters, over that of independent residuals of unit variance; mean of the axes.
fn colour(residuals: &[Vec<f64>; 3]) -> f64 {
    let quarter = residuals[0].len().div_ceil(4).max(1);
    let of_axis = |residuals: &Vec<f64>| {
        let sums: Vec<f64> = residuals.chunks_exact(quarter).map(|part| part.iter().sum()).collect();
        let middle = sums.iter().sum::<f64>() / sums.len().max(1) as f64;
        let squares: f64 = sums.iter().map(|sum| (sum - middle).powi(2)).sum();
        squares / (3 * quarter * sums.len().saturating_sub(1).max(1)) as f64
    };
    residuals.iter().map(of_axis).sum()
}

/// Whether blocks of this width show at least two turns in `n`, directly or by aliasing. Otherwise they have
/// averaged whole turns, and the term vanishes or cannot be separated from a constant.
fn turns_seen(omega: f64, width: f64, n: usize) -> bool {
    let turns = omega * width / TAU;
    (turns - turns.round()).abs() * n as f64 > 2.0
}

/// Where `f` is greatest between `low` and `high`: the best of a grid, then golden section about it until a parabola
/// fits.
fn maximum(low: f64, high: f64, f: impl Fn(f64) -> f64) -> f64 {
    const GRID: usize = 8;
    let golden = 0.5 * (5_f64.sqrt() - 1.0);
    let at = |i: usize| low + (high - low) * i as f64 / GRID as f64;
    let best = (0..=GRID).map(|i| (i, f(at(i)))).max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |best| best.0);
    let (mut a, mut b) = (at(best.saturating_sub(1)), at((best + 1).min(GRID)));
    // The settling may be 1e5 of the noise, so its time constant counts to 1e-5: the vertex of a parabola through
    // points 1e-2 apart is right to about 1e-4, through points 1e-3 apart to 1e-6.
    while b - a > 1e-2 {
        let (c, d) = (b - golden * (b - a), a + golden * (b - a));
        if f(c) > f(d) { b = d } else { a = c }
    }
    let vertex = |x: f64, step: f64| {
        let (left, middle, right) = (f(x - step), f(x), f(x + step));
        let curvature = left - 2.0 * middle + right;
        if curvature < 0.0 { x + (0.5 * step * (left - right) / curvature).clamp(-step, step) } else { x }
    };
    vertex(vertex(0.5 * (a + b), 5e-3), 5e-4).clamp(low, high)
}
