//! Units that are not like the others: robust distances over all parameters.
//!
//! The mean `x_i` of a unit over its sessions has errors of covariance `V_i`, which its sessions state and their differences correct. Beside
//! them units scatter by a covariance `B` that all have in common:
//!
//! `x_i ~ N(m, S_i)`,  `S_i = B + V_i`,  `d_i^2 = (x_i - m)^T S_i^-1 (x_i - m)`.
//!
//! So a unit of one session, or of poor ones, may lie farther off than others. The law of the largest distance follows no table. It is
//! drawn: normal units of these covariances, treated in the same way. A probability is then that of *any* sound unit as far off (family-wise).

mod between;
mod component;
mod corrected;
mod means;
mod rows;
mod scale;

use nalgebra::{Cholesky, DMatrix};
use rayon::prelude::*;

use self::component::{Component, Known};
use self::corrected::UnitSessions;
use self::means::UnitMeans;
use self::rows::Rows;
use crate::statistics::Random;
use crate::statistics::chi_squared_tail;
use crate::uncertainty::Estimates;

/// One unit against the others.
#[derive(Debug, Clone, PartialEq)]
pub struct UnitDistance {
    /// Robust distance `d`.
    pub distance: f64,
    /// Probability that the farthest of as many sound units is as far off.
    pub probability: f64,
    /// Parameter by parameter: standard deviations from the centre.
    pub scores: Vec<f64>,
}

impl UnitDistance {
    /// Fewer units give no law.
    pub const FEWEST_UNITS: usize = 10;

    /// The distances of units of one type, each of one or more sessions by `counts`. `session` makes session `t` of a unit, in the order of time, when
    /// it is asked for: `p` values, and the covariance of their errors as it states them. `None` below [`Self::FEWEST_UNITS`], or where a
    /// parameter does not vary. The same `seed` gives the same probabilities on any number of threads.
    pub fn of_all(
        counts: &[usize],
        session: &(dyn Fn(usize, usize) -> Estimates + Sync),
        seed: u64,
    ) -> Option<Vec<Self>> {
        if counts.len() < Self::FEWEST_UNITS {
            return None;
        }
        let sessions = UnitSessions { counts, session };
        let means = UnitMeans::of(&sessions);
        let add_errors =
            |unit: usize, weight: f64, sum: &mut DMatrix<f64>| means.add_errors(&sessions, unit, weight, sum);
        let units = Rows { values: means.values.clone(), variances: means.variances.clone(), add_errors: &add_errors };
        let known = Known::of(units.values.nrows(), units.values.ncols())?;
        let found = Component::of(&units, &known)?;
        let squares = found.squared_distances(&units)?;
        let probability = largest_law(&units, &found, &known, seed)?;
        let scores = found.scores(&units);
        let distance = |(unit, square): (usize, &f64)| UnitDistance {
            distance: square.sqrt(),
            probability: probability(*square),
            scores: scores.row(unit).iter().copied().collect(),
        };
        Some(squares.iter().enumerate().map(distance).collect())
    }
}

/// The probability that the largest squared distance of sound units is as large.
fn largest_law(units: &Rows, found: &Component, known: &Known, seed: u64) -> Option<impl Fn(f64) -> f64> {
    let (n, p) = units.values.shape();
    let mut largest = if n > MOST_DRAWN { Vec::new() } else { drawn_largest(units, found, known, seed)? };
    largest.sort_by(f64::total_cmp);
    Some(move |square: f64| {
        // For very many units, whose scatter is as good as known: chi^2.
        if largest.is_empty() {
            return (n as f64 * chi_squared_tail(square, p)).min(1.0);
        }
        let beyond = largest.len() - largest.partition_point(|drawn| *drawn < square);
        (1.0 + beyond as f64) / (1.0 + largest.len() as f64)
    })
}

/// The largest squared distances of sound units with the covariances that were `found`.
fn drawn_largest(units: &Rows, found: &Component, known: &Known, seed: u64) -> Option<Vec<f64>> {
    let p = units.values.ncols();
    let errors: Vec<DMatrix<f64>> = (0..units.values.nrows())
        .map(|unit| {
            let mut errors = DMatrix::zeros(p, p);
            (units.add_errors)(unit, 1.0, &mut errors);
            errors
        })
        .collect();
    let factors = errors.iter().map(|errors| (errors + &found.between).cholesky().map(Cholesky::unpack));
    let factors: Vec<DMatrix<f64>> = factors.collect::<Option<_>>()?;
    let add_errors = |unit: usize, weight: f64, sum: &mut DMatrix<f64>| rows::add_scaled(&errors[unit], weight, sum);
    let largest_of = |draw| {
        let values = drawn(&factors, &mut Random::stream(seed, draw));
        let units = Rows { values, variances: units.variances.clone(), add_errors: &add_errors };
        let squares = Component::of(&units, known)?.squared_distances(&units)?;
        squares.into_iter().max_by(f64::total_cmp)
    };
    Some((0..DRAWS).into_par_iter().filter_map(largest_of).collect())
}

/// Normal rows with these Cholesky factors of their covariances, `n x p`.
fn drawn(factors: &[DMatrix<f64>], random: &mut Random) -> DMatrix<f64> {
    let p = factors[0].nrows();
    let mut drawn = DMatrix::zeros(p, factors.len());
    for (factor, mut drawn) in factors.iter().zip(drawn.column_iter_mut()) {
        for of_column in factor.column_iter().enumerate() {
            let (j, column) = of_column;
            let normal = random.normal();
            drawn.rows_mut(j, p - j).axpy(normal, &column.rows(j, p - j), 1.0);
        }
    }
    drawn.transpose()
}

/// Draws of all units.
const DRAWS: u64 = 399;

/// Units up to which laws are drawn.
const MOST_DRAWN: usize = 2000;
