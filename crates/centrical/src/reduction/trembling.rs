//! What trembles at rest: the attitude, or the place.
//!
//! Let a rest show the motion `s(t)` across the force, in units of gravity, `v` in mean square beside the white noise. If the attitude trembles,
//! the force keeps its size, and its mean is shorter by `v / 2`. If the place does, as on a table that is shaken sideways, an acceleration is added
//! to gravity: the mean is as it was, and the size exceeds gravity by `|s|^2 / 2`. So the excess of the size at a sample is `kappa |s|^2 / 2`
//! beside its noise. `kappa` is 0 for the attitude and 1 for the place. The mean is shorter by `(1 - kappa) v / 2`.
//!
//! `kappa` is the slope of a regression over the samples of all rests of a record, beside a constant and the two components of `s` in each rest:
//! few rests show the ellipsoid poorly, and the excess by a wrong one follows `s` itself. The white noise in `|s + w|^2` has the variance
//! `4 v sigma^2 + 4 sigma^4`, which is taken out of the sum of squares. Each rest is a cluster for the standard uncertainty: the noise of the
//! excess may be coloured. Before the data it is as likely that the attitude trembles alone, the place alone, or both in any parts.

use nalgebra::{DMatrix, DVector, Vector3};

use super::average::PlateauFit;
use super::ellipsoid::Ellipsoid;
use super::record::RecordSlice;
use crate::model::Position;
use crate::statistics::median;

/// Fewest rests that show the scatter between them.
const FEWEST: usize = 3;

/// Samples of a rest that are looked at, evenly spread: an hour at 2 kHz needs no more memory than some minutes.
const MOST: usize = 100_000;

/// Samples farther from the mean than this many standard deviations take no part.
const FARTHEST: f64 = 6.0;

/// A constant and two components of the motion.
const LINEAR: usize = 3;

/// Least uncertainty of a part: one part for all motion of a record resolves no more.
const SHARPEST: f64 = 5e-3;

/// Points of the posterior distribution of a part between 0 and 1.
const POINTS: u32 = 200;

/// The part of what trembles that is attitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct AttitudePart {
    /// Its mean.
    pub mean: f64,
    /// Its standard uncertainty.
    pub standard_uncertainty: f64,
}

/// The white noise of readings beside a tremor of the attitude, no more than `white` [m/s^2], which second differences of the readings show. A tremor
/// that reaches up to half the sampling rate is in these, and not in the size of the force: of it the second differences show the noise alone.
/// The median over the rests among the `fits` of a record.
pub(super) fn white_noise(
    record: RecordSlice,
    fits: &[PlateauFit],
    ellipsoid: &Ellipsoid,
    white: &Vector3<f64>,
) -> Vector3<f64> {
    let part = |fit: &PlateauFit| {
        let samples = record.between(fit.window);
        let excess = |n: usize| ellipsoid.excess(&Vector3::from_fn(|axis, _| samples.f_z[axis][n]));
        let excess: Vec<f64> = (0..samples.t.len().min(MOST)).map(excess).collect();
        let squares = excess.windows(3).map(|e| (e[0] - 2.0 * e[1] + e[2]).powi(2)).sum::<f64>();
        let along = ellipsoid.half_gradient(&fit.mean).component_mul(white).norm();
        // The variance of second differences is six-fold.
        (squares / (6 * excess.len().saturating_sub(2)) as f64).sqrt() / along
    };
    let rests = fits.iter().filter(|fit| !fit.turns());
    let mut parts: Vec<f64> = rests.map(part).filter(|part| part.is_finite()).collect();
    if parts.is_empty() { *white } else { white * median(&mut parts).min(1.0) }
}

/// Sums over the samples of a rest.
struct Sums {
    /// Products of the excess and the square of the motion, both beside the constant and the components.
    products: f64,
    /// Squares of the latter, without the white noise.
    squares: f64,
}

impl AttitudePart {
    /// By the rests among the `fits` of a record, whose readings have the white noise `white` [m/s^2].
    pub fn of(record: RecordSlice, fits: &[PlateauFit], ellipsoid: &Ellipsoid, white: &Vector3<f64>) -> Self {
        let rests = fits.iter().filter(|fit| !fit.turns());
        let sums: Vec<Sums> = rests.filter_map(|fit| Sums::of(record, fit, ellipsoid, white)).collect();
        let squares: f64 = sums.iter().map(|sums| sums.squares).sum();
        if sums.len() < FEWEST || squares <= 0.0 {
            return Self::posterior(0.0, f64::INFINITY);
        }
        let slope = sums.iter().map(|sums| sums.products).sum::<f64>() / squares;
        let scores = sums.iter().map(|sums| (sums.products - slope * sums.squares).powi(2)).sum::<f64>();
        let n = sums.len() as f64;
        // The excess is half of kappa times the square.
        Self::posterior(1.0 - 2.0 * slope, 2.0 * (scores * n / (n - 1.0)).sqrt() / squares)
    }

    /// Of an estimate with its standard uncertainty: 0, 1, and all parts between them together were as likely before it.
    fn posterior(estimate: f64, standard_uncertainty: f64) -> Self {
        let between = (0..POINTS).map(|k| ((f64::from(k) + 0.5) / f64::from(POINTS), 1.0));
        let alone = [0.0, 1.0].map(|part| (part, f64::from(POINTS)));
        let exponent = |part: f64| -0.5 * ((part - estimate) / standard_uncertainty.max(SHARPEST)).powi(2);
        let all: Vec<(f64, f64)> = between.chain(alone).collect();
        let largest = all.iter().map(|(part, _)| exponent(*part)).fold(f64::NEG_INFINITY, f64::max);
        let weighted = all.iter().map(|(part, prior)| (*part, prior * (exponent(*part) - largest).exp()));
        let [sum, first, second] = weighted.fold([0.0; 3], |[sum, first, second], (part, weight)| {
            [sum + weight, first + weight * part, second + weight * part * part]
        });
        let mean = first / sum;
        Self { mean, standard_uncertainty: (second / sum - mean * mean).max(0.0).sqrt() }
    }
}

impl Sums {
    fn of(record: RecordSlice, fit: &PlateauFit, ellipsoid: &Ellipsoid, white: &Vector3<f64>) -> Option<Self> {
        let samples = record.between(fit.window);
        let along = ellipsoid.half_gradient(&fit.mean);
        let most = fit.variance.map(|variance| FARTHEST * variance.sqrt());
        let across = |of: &Vector3<f64>, along: f64| ellipsoid.size(of).powi(2) - along.powi(2);
        let upright = Position::free("", &along).p_zy;
        let step = samples.t.len().div_ceil(MOST).max(1);
        let mut seen = Vec::with_capacity(samples.t.len() / step + 1);
        for n in (0..samples.t.len()).step_by(step) {
            let reading = Vector3::from_fn(|axis, _| samples.f_z[axis][n]);
            let motion = reading - fit.mean;
            // Comparison with a NaN is false.
            if (0..3).all(|axis| motion[axis].abs() <= most[axis]) {
                let components = upright.tr_mul(&motion);
                let square = across(&motion, along.dot(&motion));
                seen.push(([1.0, components.x, components.y], ellipsoid.excess(&reading), square));
            }
        }
        if seen.len() <= LINEAR {
            return None;
        }
        let count = seen.len() as f64;
        let linear = DMatrix::from_fn(seen.len(), LINEAR, |n, k| seen[n].0[k]).qr().q();
        let beside = |values: DVector<f64>| &values - &linear * linear.tr_mul(&values);
        let excess = beside(DVector::from_iterator(seen.len(), seen.iter().map(|(_, excess, _)| *excess)));
        let square = beside(DVector::from_iterator(seen.len(), seen.iter().map(|(.., square)| *square)));
        // Of either component across the force.
        let noise = 0.5 * across(white, along.component_mul(white).norm());
        let trembles = (seen.iter().map(|(.., square)| square).sum::<f64>() / count - 2.0 * noise).max(0.0);
        let of_noise = 4.0 * noise * (trembles + noise);
        Some(Self {
            products: excess.dot(&square),
            squares: square.norm_squared() - (count - LINEAR as f64) * of_noise,
        })
    }
}
