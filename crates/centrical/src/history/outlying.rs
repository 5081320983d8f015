//! Units that are not like the others: robust distances over all parameters.
//!
//! 1. Each parameter is counted from its median in standard deviations by the median absolute value.
//! 2. Correlations are those of normal scores of the ranks, which a few outlying units hardly move.
//! 3. With nearly as many parameters as units they are shrunk towards zero, `(1 - lambda) r_ij`, by the `lambda` of J. Schaefer and
//!    K. Strimmer (Stat. Appl. Genet. Mol. Biol. 4, 2005): `lambda = sum Var(r_ij) / sum r_ij^2`.
//! 4. The distance is `d^2 = z^T R^-1 z`.
//!
//! The law of the largest distance follows no table. It is drawn: normal units with these correlations, treated in the same way. A
//! probability is then that of *any* sound unit as far off (family-wise).

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, Normal};

use crate::statistics::{MAD, Random, median};
use crate::uncertainty::chi_squared_tail;

/// One unit against the others.
#[derive(Debug, Clone, PartialEq)]
pub struct UnitDistance {
    /// Robust distance `d`.
    pub distance: f64,
    /// Probability that the farthest of as many sound units is as far off.
    pub probability: f64,
    /// Parameter by parameter: standard deviations from the median.
    pub scores: Vec<f64>,
}

/// Fewer units give no law.
pub const FEWEST_UNITS: usize = 10;

/// The distances of units, a row of `values` each, `n x p`; `None` below [`FEWEST_UNITS`], or where a parameter does not vary.
/// The same `seed` gives the same probabilities on any number of threads.
pub fn distances(values: &DMatrix<f64>, seed: u64) -> Option<Vec<UnitDistance>> {
    let (n, p) = values.shape();
    if n < FEWEST_UNITS || p == 0 {
        return None;
    }
    let normal_scores = normal_scores(n);
    let (scores, correlations) = described(values, &normal_scores)?;
    let squares = squared_distances(&scores, &correlations)?;
    let probability = largest_law(n, &correlations, &normal_scores, seed)?;
    let distance = |(unit, square): (usize, &f64)| UnitDistance {
        distance: square.sqrt(),
        probability: probability(*square),
        scores: scores.row(unit).iter().copied().collect(),
    };
    Some(squares.iter().enumerate().map(distance).collect())
}

/// Standard deviations from the medians, and the shrunk correlations.
fn described(values: &DMatrix<f64>, normal_scores: &[f64]) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
    let (n, p) = values.shape();
    let (mut scores, mut ranked) = (DMatrix::zeros(n, p), DMatrix::zeros(n, p));
    for j in 0..p {
        let mut column: Vec<f64> = values.column(j).iter().copied().collect();
        let middle = median(&mut column);
        let deviation = MAD * median(&mut values.column(j).iter().map(|v| (v - middle).abs()).collect::<Vec<f64>>());
        if !(deviation > 0.0 && deviation.is_finite()) {
            return None;
        }
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|&a, &b| values[(a, j)].total_cmp(&values[(b, j)]));
        for (rank, &unit) in order.iter().enumerate() {
            scores[(unit, j)] = (values[(unit, j)] - middle) / deviation;
            ranked[(unit, j)] = normal_scores[rank];
        }
    }
    Some((scores, shrunk(ranked.transpose() * &ranked, n)))
}

/// Correlations of normal scores, shrunk.
fn shrunk(mut correlations: DMatrix<f64>, n: usize) -> DMatrix<f64> {
    let p = correlations.nrows();
    let (mut doubt, mut size) = (0.0, 0.0);
    for i in 0..p {
        for j in 0..i {
            let r = correlations[(i, j)];
            doubt += (1.0 - r * r).powi(2) / (n - 1) as f64;
            size += r * r;
        }
    }
    let lambda = if size > doubt { doubt / size } else { 1.0 };
    for i in 0..p {
        for j in 0..p {
            correlations[(i, j)] = if i == j { 1.0 } else { (1.0 - lambda) * correlations[(i, j)] };
        }
    }
    correlations
}

fn squared_distances(scores: &DMatrix<f64>, correlations: &DMatrix<f64>) -> Option<Vec<f64>> {
    let whitened = correlations.clone().cholesky()?.l_dirty().solve_lower_triangular(&scores.transpose())?;
    Some(whitened.column_iter().map(|unit| unit.norm_squared()).collect())
}

/// The probability that the largest squared distance of `n` sound units is as large.
fn largest_law(n: usize, correlations: &DMatrix<f64>, normal_scores: &[f64], seed: u64) -> Option<impl Fn(f64) -> f64> {
    let p = correlations.nrows();
    let factor = correlations.clone().cholesky()?;
    let mut largest: Vec<f64> = if n > MOST_DRAWN {
        Vec::new()
    } else {
        let draws = (0..DRAWS).into_par_iter();
        draws.filter_map(|draw| largest_of_drawn(n, &factor, normal_scores, &mut Random::stream(seed, draw))).collect()
    };
    largest.sort_by(f64::total_cmp);
    Some(move |square: f64| {
        // Beyond what was drawn, and for very many units, whose medians and correlations are as good as known: chi^2.
        let by_chi_squared = (n as f64 * chi_squared_tail(square, p)).min(1.0);
        if largest.is_empty() {
            return by_chi_squared;
        }
        let beyond = largest.len() - largest.partition_point(|drawn| *drawn < square);
        (1.0 + beyond as f64) / (1.0 + largest.len() as f64)
    })
}

fn largest_of_drawn(n: usize, factor: &Cholesky<f64, Dyn>, normal_scores: &[f64], random: &mut Random) -> Option<f64> {
    let p = factor.l_dirty().nrows();
    let l = factor.l();
    let mut drawn = DMatrix::zeros(n, p);
    for mut unit in drawn.row_iter_mut() {
        unit.tr_copy_from(&(&l * DVector::from_fn(p, |_, _| random.normal())));
    }
    let (scores, correlations) = described(&drawn, normal_scores)?;
    squared_distances(&scores, &correlations)?.into_iter().max_by(f64::total_cmp)
}

/// Draws of all units.
const DRAWS: u64 = 999;

/// Units up to which laws are drawn.
const MOST_DRAWN: usize = 2000;

/// Blom's normal scores, of unit length.
fn normal_scores(n: usize) -> Vec<f64> {
    let normal = Normal::standard();
    let score = |rank: usize| normal.inverse_cdf((rank as f64 + 0.625) / (n as f64 + 0.25));
    let scores: Vec<f64> = (0..n).map(score).collect();
    let length = scores.iter().map(|s| s * s).sum::<f64>().sqrt();
    scores.into_iter().map(|s| s / length).collect()
}
