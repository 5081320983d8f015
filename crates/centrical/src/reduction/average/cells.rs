//! A window's residuals and design summed over equal cells of time: all that the slow part of the noise needs. Functionals of the readings,
//! and their variances under the components of the noise.

use nalgebra::Vector3;
use pulp::{Simd, WithSimd};

use super::samples::CELLS;
use super::strips::Sums;
use crate::reduction::simd::{dot, product, widest};
use crate::reduction::terms::{TERMS, Triangle};

/// Sums over the good samples of each cell.
#[derive(Debug, Clone)]
pub(in crate::reduction) struct Cells {
    /// Width of a cell [s].
    pub width: f64,
    /// Sampling interval [s].
    pub interval: f64,
    counts: Vec<f64>,
    /// Sums of the residuals [m/s^2].
    residuals: Vec<Vector3<f64>>,
    /// Sums of each orthonormal column of the design; the last is the mean's: `mean = sum_i q_i y_i / mean_scale`.
    q: Vec<Vec<f64>>,
    mean_scale: f64,
}

/// A linear functional of a window's samples: its weights summed by cell, and the sum of their squares by sample.
#[derive(Debug, Clone)]
pub(in crate::reduction) struct Weights {
    pub by_cell: Vec<f64>,
    pub squares: f64,
}

impl Cells {
    /// The sums of all strips, gathered by cell, of a fit with that triangle.
    pub(super) fn gather(
        strips: impl Iterator<Item = (usize, Sums)>,
        triangle: &Triangle,
        terms: usize,
        width: f64,
        interval: f64,
    ) -> Self {
        let (mut counts, mut residuals) = (vec![0.0; CELLS], vec![Vector3::zeros(); CELLS]);
        let mut columns = [[0.0; TERMS]; CELLS];
        for (cell, sums) in strips {
            counts[cell] += sums.count as f64;
            residuals[cell] += sums.residuals;
            columns[cell].iter_mut().zip(sums.columns).for_each(|(sum, column)| *sum += column);
        }
        let orthonormal = columns.map(|columns| triangle.orthonormal(columns, terms));
        let q = (0..terms).map(|k| orthonormal.iter().map(|q| q[k]).collect()).collect();
        Self { width, interval, counts, residuals, q, mean_scale: triangle.r[terms - 1][terms - 1] }
    }

    /// The weights of the samples in the mean.
    pub fn mean_weights(&self) -> Weights {
        let q = &self.q[self.q.len() - 1];
        let squares = 1.0 / (self.mean_scale * self.mean_scale);
        Weights { by_cell: q.iter().map(|q| q / self.mean_scale).collect(), squares }
    }

    /// The part of a slow function of time, one value a cell, that the fit does not absorb: as weights, and its product
    /// with the readings.
    pub fn contrast(&self, function: &[f64]) -> (Weights, Vector3<f64>) {
        let fitted: Vec<f64> = self.q.iter().map(|q| product(q, function)).collect();
        let mut by_cell: Vec<f64> = function.iter().zip(&self.counts).map(|(v, n)| v * n).collect();
        let squares = product(&by_cell, function) - product(&fitted, &fitted);
        for (q, fitted) in self.q.iter().zip(&fitted) {
            by_cell.iter_mut().zip(q).for_each(|(w, q)| *w -= q * fitted);
        }
        let product = function.iter().zip(&self.residuals).map(|(v, r)| r * *v).sum();
        (Weights { by_cell, squares }, product)
    }

    /// `function` less as much of `other` as makes its contrast orthogonal to that of `other`, both slow functions of time,
    /// one value a cell.
    pub fn free_of(&self, function: &[f64], other: &[f64]) -> Vec<f64> {
        let (weights, _) = self.contrast(other);
        let share = product(&weights.by_cell, function) / weights.squares;
        // A function that the fit absorbs wholly has no contrast.
        let share = if share.is_finite() { share } else { 0.0 };
        function.iter().zip(other).map(|(f, o)| f - share * o).collect()
    }

    /// The slope of the readings [m/s^3], with the weights that give it. It does not depend on what follows `other`, a slow
    /// function of time, one value a cell.
    pub fn slope(&self, other: Option<&[f64]>) -> (Weights, Vector3<f64>) {
        let middle = 0.5 * CELLS as f64;
        let time: Vec<f64> = (0..CELLS).map(|cell| (cell as f64 + 0.5 - middle) * self.width).collect();
        let time = other.map_or_else(|| time.clone(), |other| self.free_of(&time, other));
        let (weights, product) = self.contrast(&time);
        let by_cell = weights.by_cell.iter().map(|w| w / weights.squares).collect();
        (Weights { by_cell, squares: 1.0 / weights.squares }, product / weights.squares)
    }

    /// Variance of a functional under a component of unit density.
    ///
    /// White: `sum w^2 / interval`. Markov: `sum_ab w_a w_b exp(-|t_a - t_b| / tau) / (2 tau)` over cells, by a recursion.
    pub fn gain(&self, correlation_time: Option<f64>, weights: &Weights) -> f64 {
        let Some(tau) = correlation_time else { return weights.squares / self.interval };
        Markov::new(&[tau], self.width).gains(weights)[0]
    }
}

/// Markov processes of several correlation times, over cells of one width.
pub(in crate::reduction) struct Markov {
    /// Correlation from one cell to the next.
    decay: Vec<f64>,
    /// Mean correlation inside a cell, over twice the correlation time.
    within: Vec<f64>,
    /// Mean correlation between neighbouring cells, over the correlation time.
    between: Vec<f64>,
}

impl Markov {
    /// Of these correlation times, over cells of a width [s].
    pub fn new(times: &[f64], width: f64) -> Self {
        let of = |law: fn(f64) -> f64| times.iter().map(|tau| law(width / tau) / tau).collect();
        Self {
            decay: times.iter().map(|tau| (-width / tau).exp()).collect(),
            within: of(|x| (x - 1.0 + (-x).exp()) / (x * x)),
            // By its own exponential: the sinh of cells that are a thousand correlation times wide overflows.
            between: of(|x| (-(-x).exp_m1() / x).powi(2)),
        }
    }

    /// Variances of a functional under each process of unit density.
    pub fn gains(&self, weights: &Weights) -> Vec<f64> {
        widest(Gains { markov: self, weights })
    }
}

/// Variances of a functional under Markov processes of unit density.
struct Gains<'a> {
    markov: &'a Markov,
    weights: &'a Weights,
}

impl WithSimd for Gains<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Vec<f64> {
        let Markov { decay, within, between } = self.markov;
        let by_cell = &self.weights.by_cell;
        let mut past = vec![0.0; decay.len()];
        let mut products = past.clone();
        for w in by_cell {
            for ((past, product), decay) in past.iter_mut().zip(&mut products).zip(decay) {
                *product += w * *past;
                *past = decay * *past + w;
            }
        }
        let squares = dot(simd, by_cell, by_cell);
        for ((product, within), between) in products.iter_mut().zip(within).zip(between) {
            *product = within * squares + between * *product;
        }
        products
    }
}
