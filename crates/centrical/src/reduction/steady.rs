//! Steady stretches of a signal: it stands still, ramps to another value, and stands still again. So a schedule looks to
//! someone who does not have it.
//!
//! Means over half a second stand still from one to the next where they differ by no more than their noise. They also do
//! where they change by less than 2e-3 of the largest mean in a second: no ramp is so slow. The noise of a sample is that of
//! neighbours, `1.4826 median |y_k+1 - y_k| / sqrt(2)`. The value of a stretch is the median over its later three
//! quarters: the beginning may still settle.

use std::f64::consts::SQRT_2;

use crate::progress::{OnProgress, Stopped, advance};
use crate::statistics::{MAD, median, watched_median};

/// Length of a block [s].
const BLOCK: f64 = 0.5;

/// Fewest samples of a block.
const SAMPLES: usize = 5;

/// Slowest ramp, as a part of the largest mean [1/s].
const RAMP: f64 = 2e-3;

/// Shortest stretch [s].
const SHORTEST: f64 = 2.0;

/// A stretch in which the signal stands still.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteadyStretch {
    /// First and last time [s].
    pub window: [f64; 2],
    /// Where the signal stands, in its unit.
    pub value: f64,
    /// Its standard uncertainty, from the scatter of the blocks.
    pub standard_uncertainty: f64,
}

/// A signal that moves from one steady stretch to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Staircase {
    /// Number of steady stretches.
    pub stretches: usize,
    /// The lowest value of them, in the unit of the signal.
    pub lowest: f64,
    /// The highest.
    pub highest: f64,
}

impl Staircase {
    /// Whether a signal moves from one steady stretch to another: it stands still for half of the time, at values that differ by
    /// more than a hundred times the noise of a sample and a twentieth of the largest. Drift and noise of any colour do not, but
    /// spikes may: they are to be left out before. `progress` is asked again and again.
    ///
    /// # Errors
    /// [`Stopped`] when the caller stops the search.
    pub fn of(t: &[f64], y: &[f64], progress: OnProgress<()>) -> Result<Option<Staircase>, Stopped> {
        let mut steps = steps(y);
        advance(progress, ())?;
        let noise = NOISE_OF_STEPS * watched_median(&mut steps, progress)?;
        let stretches = stretches(&blocks(t, y), noise);
        advance(progress, ())?;
        let still: f64 = stretches.iter().map(|stretch| stretch.window[1] - stretch.window[0]).sum();
        let values = stretches.iter().map(|stretch| stretch.value);
        let [lowest, highest] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)]);
        let is_apart = highest - lowest > (100.0 * noise).max(0.05 * lowest.abs().max(highest.abs()));
        let is_still = t.first().zip(t.last()).is_some_and(|(first, last)| 2.0 * still >= last - first);
        Ok((is_apart && is_still).then_some(Staircase { stretches: stretches.len(), lowest, highest }))
    }
}

/// Mean of consecutive samples.
struct Block {
    window: [f64; 2],
    mean: f64,
    samples: usize,
}

impl SteadyStretch {
    /// The steady stretches of a signal `y` over the times `t` [s], which do not decrease; as many samples as there are of both.
    pub fn all(t: &[f64], y: &[f64]) -> Vec<SteadyStretch> {
        stretches(&blocks(t, y), NOISE_OF_STEPS * median(&mut steps(y)))
    }
}

/// The stretches of blocks that stand still, samples having this noise.
fn stretches(blocks: &[Block], noise: f64) -> Vec<SteadyStretch> {
    let largest = blocks.iter().map(|block| block.mean.abs()).fold(0.0, f64::max);
    let is_still = |pair: &[Block]| {
        let white = 5.0 * noise * (1.0 / pair[0].samples as f64 + 1.0 / pair[1].samples as f64).sqrt();
        let time = pair[1].window[0] - pair[0].window[0];
        (pair[1].mean - pair[0].mean).abs() <= white.max(RAMP * largest * time)
    };
    let still: Vec<bool> = blocks.windows(2).map(is_still).collect();
    let mut stretches = Vec::new();
    let mut first = 0;
    for end in 1..=blocks.len() {
        if end == blocks.len() || !still[end - 1] {
            stretches.extend(stretch(&blocks[first..end]));
            first = end;
        }
    }
    stretches
}

/// The stretch of blocks that stand still, if they do so for long enough.
fn stretch(blocks: &[Block]) -> Option<SteadyStretch> {
    let window = [blocks.first()?.window[0], blocks.last()?.window[1]];
    if window[1] - window[0] < SHORTEST {
        return None;
    }
    // A block at either end may hold a part of a ramp.
    let settled = blocks.get((blocks.len() / 4).max(1)..blocks.len() - 1).filter(|settled| !settled.is_empty())?;
    let means: Vec<f64> = settled.iter().map(|block| block.mean).collect();
    let value = median(&mut means.clone());
    let scatter = MAD * median(&mut means.iter().map(|mean| (mean - value).abs()).collect::<Vec<_>>());
    // The median of normal values is 1.25 times as uncertain as their mean.
    Some(SteadyStretch { window, value, standard_uncertainty: 1.25 * scatter / (means.len() as f64).sqrt() })
}

fn blocks(t: &[f64], y: &[f64]) -> Vec<Block> {
    let count = t.len().min(y.len());
    let mut blocks = Vec::new();
    let mut first = 0;
    for n in 0..count {
        if t[n] - t[first] >= BLOCK && n - first >= SAMPLES {
            let samples = n - first;
            let mean = y[first..n].iter().sum::<f64>() / samples as f64;
            blocks.push(Block { window: [t[first], t[n - 1]], mean, samples });
            first = n;
        }
    }
    blocks
}

/// Standard deviation of a sample, as a part of the median step between neighbours.
const NOISE_OF_STEPS: f64 = MAD / SQRT_2;

/// Sizes of the steps between neighbours.
fn steps(y: &[f64]) -> Vec<f64> {
    y.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect()
}
