//! Records that are copies of each other, trimmed, shifted in time, resampled or rounded.
//!
//! Means of two records of one mounting differ by the noise of both at least; speeds and a second mounting of the unit add to that. Means of
//! a copy differ by the noise of the samples that it lacks. So differences far below the noise are no chance. Either estimate of
//! the noise of a mean may be too large: white noise, if the noise is blue as behind a sigma-delta converter; the noise of the session, if it holds
//! a drift. The smaller one counts.

use nalgebra::{Matrix3, Vector3};

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

/// The least noise that a mean can have.
fn noise(plateau: &PlateauMean) -> Matrix3<f64> {
    let white: Vector3<f64> = plateau.white_variance.component_div(&plateau.covariance.diagonal());
    plateau.covariance * white.min().min(1.0)
}
