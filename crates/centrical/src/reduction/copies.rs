//! Records that are copies of each other, trimmed, shifted in time, resampled or rounded.
//!
//! Means of two records of one mounting differ by the noise of both at least; speeds and a second mounting of the unit add to that. Means of
//! a copy differ by the noise of the samples that it lacks. So differences far below noise are not chance. Either estimate of
//! the noise of a mean may be too large: white noise, if the noise is blue as behind a sigma-delta converter; the noise of the session, if it holds
//! a drift. The smaller one counts.

use nalgebra::{Matrix3, Vector3};
use statrs::distribution::{Binomial, DiscreteCDF};

use super::plateau::PlateauMean;
use crate::statistics::chi_squared_tail;

/// Fewer differences are alike by chance.
const FEWEST: usize = 6;

impl PlateauMean {
    /// Probability that means of two records of their own are so alike: the lower tail of chi^2 of their differences. `None` where the plateaus
    /// are not as many, or too few show noise.
    pub fn chance_of_likeness(one: &[PlateauMean], other: &[PlateauMean]) -> Option<f64> {
        if one.len() != other.len() {
            return None;
        }
        let squares = one.iter().zip(other).filter_map(|(a, b)| {
            let covariance = noise(a) + noise(b);
            let difference = a.mean - b.mean;
            Some(difference.dot(&covariance.cholesky()?.solve(&difference)))
        });
        let (count, chi_squared) = squares.fold((0, 0.0), |(count, sum), square| (count + 3, sum + square));
        (count >= FEWEST).then(|| 1.0 - chi_squared_tail(chi_squared, count))
    }
}

/// Rests that read as earlier ones do, in the same order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RepeatedRests {
    /// The first of them, and the rest that it reads as, by their places.
    pub first: (usize, usize),
    /// Number of them.
    pub count: usize,
}

impl RepeatedRests {
    /// Looks for rests that count twice: a record that was pasted twice, or copied with other times or fewer digits, or that stands beside its
    /// own table of rests. Of each rest the mean and the least standard deviation that it can have are given, zero where it is not known; pairs
    /// without any are left out.
    ///
    /// At every distance in the order of rests, pairs are counted whose means differ by a chi^2 up to each of five levels. Of rests that
    /// are laid in the same attitudes again, some are by chance (binomial law). Copies are nearly all, and where two files overlap, the pairs in
    /// the overlap are far more alike than chance allows.
    pub fn among(rests: &[(Vector3<f64>, Vector3<f64>)]) -> Option<RepeatedRests> {
        let square = |(earlier, later): (usize, usize)| {
            let ((one, of_one), (other, of_other)) = (rests[earlier], rests[later]);
            let noise = of_one.sup(&of_other);
            (noise.min() > 0.0).then(|| ((one - other).component_div(&noise).norm_squared() / 2.0, (earlier, later)))
        };
        let tests = (rests.len() * ALIKE.len()) as f64;
        let repeated = (1..rests.len()).flat_map(|distance| {
            let squares: Vec<_> = (0..rests.len() - distance).filter_map(|n| square((n, n + distance))).collect();
            let at_level = move |level: f64| {
                let mut alike = squares.iter().filter(|(square, _)| *square <= level).map(|(_, pair)| *pair);
                let (first, count) = (alike.next()?, 1 + alike.count());
                let law = Binomial::new(1.0 - chi_squared_tail(level, 3), squares.len() as u64).ok()?;
                (tests * law.sf(count as u64 - 1) < IMPROBABLE).then_some(RepeatedRests { first, count })
            };
            ALIKE.into_iter().filter_map(at_level)
        });
        repeated.max_by_key(|repeated| repeated.count)
    }
}

/// Levels of chi^2 with three components. Of rests in one attitude 8 % stay below the first; of copies that share nineteen samples of
/// twenty, 98 %. Below the last is one in two million.
const ALIKE: [f64; 5] = [0.5, 0.1, 0.02, 2e-3, 2e-4];

/// Probability of a refusal by chance.
const IMPROBABLE: f64 = 1e-9;

/// The least noise that a mean can have.
fn noise(plateau: &PlateauMean) -> Matrix3<f64> {
    let white: Vector3<f64> = plateau.white_variance.component_div(&plateau.covariance.diagonal());
    plateau.covariance * white.min().min(1.0)
}
