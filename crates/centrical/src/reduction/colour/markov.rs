//! Variances of functionals of the readings under the components of the noise.

use pulp::{Simd, WithSimd};

use crate::reduction::average::{Cells, Weights};
use crate::reduction::simd::lanes::{dot, widest};

/// Variance of a functional under a component of unit density.
///
/// White: `sum w^2 / interval`. Markov: `sum_ab w_a w_b exp(-|t_a - t_b| / tau) / (2 tau)` over cells, by a recursion.
pub fn gain(correlation_time: Option<f64>, weights: &Weights, cells: &Cells) -> f64 {
    let Some(tau) = correlation_time else { return weights.squares / cells.interval };
    Markov::new(&[tau], cells.width).gains(weights)[0]
}

/// Markov processes of several correlation times, over cells of one width.
pub struct Markov {
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
