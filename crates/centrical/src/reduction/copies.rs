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

/// Rests that read as earlier ones do, in the same order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RepeatedRests {
    /// The first of them, and the rest that it reads as, by their places.
    pub first: (usize, usize),
    /// Number of them.
    pub count: usize,
}

/// Looks for rests that count twice: a record that was pasted twice, or copied with other times or fewer digits, or that stands beside its
/// own table of rests. Of each rest the mean and the least standard deviation that it can have are given, zero where it is not known; pairs
/// without any are left out.
///
/// At every distance in the order of rests, pairs are counted whose means differ by a chi^2 of 0.5 at most. Of rests that are laid in the same
/// attitudes again, some are by chance (binomial law); copies are nearly all.
pub fn repeated_rests(rests: &[(Vector3<f64>, Vector3<f64>)]) -> Option<RepeatedRests> {
    let is_alike = |(earlier, later): &(usize, usize)| {
        let ((one, of_one), (other, of_other)) = (rests[*earlier], rests[*later]);
        let noise = of_one.sup(&of_other);
        let squares = (one - other).component_div(&noise).norm_squared() / 2.0;
        noise.min() > 0.0 && squares <= ALIKE
    };
    let chance = 1.0 - chi_squared_tail(ALIKE, 3);
    let repeated = (1..rests.len()).filter_map(|distance| {
        let pairs = || (0..rests.len() - distance).map(|n| (n, n + distance)).filter(is_alike);
        let (first, count) = (pairs().next()?, pairs().count());
        let law = Binomial::new(chance, (rests.len() - distance) as u64).ok()?;
        let by_chance = rests.len() as f64 * law.sf(count as u64 - 1);
        (by_chance < IMPROBABLE).then_some(RepeatedRests { first, count })
    });
    repeated.max_by_key(|repeated| repeated.count)
}

/// Limit of chi^2 with three components. Of rests in one attitude 8 % stay below it; of copies that share nineteen samples of twenty, 98 %.
const ALIKE: f64 = 0.5;

/// Probability of a refusal by chance.
const IMPROBABLE: f64 = 1e-9;

/// The least noise that a mean can have.
fn noise(plateau: &PlateauMean) -> Matrix3<f64> {
    let white: Vector3<f64> = plateau.white_variance.component_div(&plateau.covariance.diagonal());
    plateau.covariance * white.min().min(1.0)
}
