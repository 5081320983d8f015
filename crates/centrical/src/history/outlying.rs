//! Units that are not like the others: robust distances over all parameters.
//!
//! 1. Each parameter is counted from its median in standard deviations, `z_ij`. A unit of one session, or of poor ones, has a larger deviation
//!    than others.
//! 2. The correlations `R_i` have a part of the errors of sessions, by what they state and show, and a part of the units.
//! 3. The distance is `d_i^2 = z_i^T R_i^-1 z_i`.
//!
//! The law of the largest distance follows no table. It is drawn: normal units with these deviations and correlations, treated in the same way.
//! A probability is then that of *any* sound unit as far off (family-wise).

mod correlations;
mod described;
mod means;
mod scale;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use self::correlations::{normal_scores, of_sessions};
use self::described::{Described, Known};
pub use self::means::UnitMeans;
use crate::statistics::Random;
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

/// The distances of units by the means of each of their `p` parameters, and by the correlations of the errors of each unit as its sessions
/// `stated` them, `p x p`; `None` below [`FEWEST_UNITS`], where a parameter does not vary, or where parameters or correlations have
/// different units. The same `seed` gives the same probabilities on any number of threads.
pub fn distances(parameters: &[UnitMeans], stated: &[DMatrix<f64>], seed: u64) -> Option<Vec<UnitDistance>> {
    let (n, p) = (parameters.first()?.values.len(), parameters.len());
    let are_of_all = parameters.iter().all(|means| means.values.len() == n) && stated.len() == n;
    if n < FEWEST_UNITS || !are_of_all || stated.iter().any(|of_unit| of_unit.shape() != (p, p)) {
        return None;
    }
    let errors = of_sessions(stated, differences(parameters).as_ref());
    let known = Known { normal_scores: normal_scores(n), errors };
    let values = columns(parameters.iter().map(|means| &means.values));
    let variances = columns(parameters.iter().map(|means| &means.variances));
    let units = Described::of(&values, &variances, &known)?;
    let squares = units.squared_distances()?;
    let probability = largest_law(&units, &known, seed);
    let distance = |(unit, square): (usize, &f64)| UnitDistance {
        distance: square.sqrt(),
        probability: probability(*square),
        scores: units.scores.row(unit).iter().copied().collect(),
    };
    Some(squares.iter().enumerate().map(distance).collect())
}

fn columns<'a>(columns: impl Iterator<Item = &'a Vec<f64>>) -> DMatrix<f64> {
    DMatrix::from_columns(&columns.map(|column| DVector::from_column_slice(column)).collect::<Vec<_>>())
}

/// Differences of neighbouring sessions, if all parameters have them.
fn differences(parameters: &[UnitMeans]) -> Option<DMatrix<f64>> {
    let m = parameters[0].differences.len();
    let have_all = m > 0 && parameters.iter().all(|means| means.differences.len() == m);
    have_all.then(|| columns(parameters.iter().map(|means| &means.differences)))
}

/// The probability that the largest squared distance of sound units is as large.
fn largest_law(units: &Described, known: &Known, seed: u64) -> impl Fn(f64) -> f64 {
    let (n, p) = units.scores.shape();
    let largest_of = |draw| {
        let drawn = units.drawn(&mut Random::stream(seed, draw));
        let squares = Described::of(&drawn, &units.variances, known)?.squared_distances()?;
        squares.into_iter().max_by(f64::total_cmp)
    };
    let draws = if n > MOST_DRAWN { 0 } else { DRAWS };
    let mut largest: Vec<f64> = (0..draws).into_par_iter().filter_map(largest_of).collect();
    largest.sort_by(f64::total_cmp);
    move |square: f64| {
        // For very many units, whose medians and correlations are as good as known: chi^2.
        if largest.is_empty() {
            return (n as f64 * chi_squared_tail(square, p)).min(1.0);
        }
        let beyond = largest.len() - largest.partition_point(|drawn| *drawn < square);
        (1.0 + beyond as f64) / (1.0 + largest.len() as f64)
    }
}

/// Draws of all units.
const DRAWS: u64 = 999;

/// Units up to which laws are drawn.
const MOST_DRAWN: usize = 2000;
