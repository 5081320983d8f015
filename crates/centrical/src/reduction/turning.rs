//! Slow rotation: gravity has one size in every attitude, also where the attitude changes.
//!
//! An arc of slow rotation is described by Legendre polynomials, `f(t) = f_0 + c_1 P_1 + c_2 P_2 + c_3 P_3`. Its mean `f_0` is shorter than
//! gravity: the mean of `|f|^2 = g^2` over the arc is
//!
//! `|f_0|^2 + |c_1|^2 / 3 + |c_2|^2 / 5 + |c_3|^2 / 7 = g^2`.
//!
//! What the polynomials leave beside the white noise, a tremor or a turn that is not smooth, belongs to that sum with its mean square. An arc
//! in which it counts for more than [`MOST_LEFT`] standard uncertainties is left out. So is one in which a kink of the way may hide that would
//! count for as much: it accelerates the proof masses at their distance from the axes.
//!
//! A rest is an arc that does not turn: a tremor of its attitude shortens its mean in the same way ([`super::trembling`]).
//!
//! So the mean reading, drawn out from the bias by the ratio of `g` to `|f_0|`, is that of a rest in the attitude of `f_0`, whatever bias, scale and
//! misalignment are. For that ratio an ellipsoid through all means is enough: of second order in the angle, it takes bias and scale coarsely.
//!
//! Noise along the force shows in the size of the readings by that ellipsoid, over whole stretches of rotation. The noise that changes this
//! size lies along the ellipsoid's normal. The reading itself deviates from the normal by the bias, so transverse hand tremor, a thousand
//! times stronger, would be mistaken for noise along the force. Proof masses beside the axes are accelerated by their place times the second
//! derivative of the vertical. That is not noise either, and is taken out.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector, Vector3};

use super::average::PlateauFit;
use super::ellipsoid::Ellipsoid;
use super::error::ReductionError;
use super::record::{Record, RecordSlice};
use super::survey::Survey;
use super::terms::{Interval, TURNING};
use crate::model::STANDARD_GRAVITY;

/// Rounds in which ellipsoid and means follow from each other: each gains two digits or more.
const ROUNDS: usize = 4;

/// What the polynomials leave, at most, over the standard uncertainty of the mean along the force: it is known to a third or better.
const MOST_LEFT: f64 = 3.0;

/// Second derivative, on average over an arc of half length 1, that the polynomials miss of a kink in its middle, over the root mean square
/// of what they leave. Of the kink `|t|` they see `1/2 + 5/8 P_2`: they leave `1/3 - 1/4 - 5/64 = 1/192` in mean square, and of the mean second
/// derivative, 1, they make `3 . 5/8`. The ratio is `7/8 . sqrt(192) = 7 sqrt(3)`.
const OF_KINK: f64 = 7.0 * 1.732_050_807_568_877_2;

/// What the polynomials leave of an arc with spikes, at most, in standard deviations of the noise alone.
const MOST_SCATTER: f64 = 4.0;

/// Samples of an arc for each one that may be left out as a spike.
const PER_SPIKE: usize = 20;

/// Least singular value of the terms of a place beside the axes that is not noise, over the largest.
const LEAST: f64 = 1e-4;

/// Whether a fit is that of a rest, or of an arc which the polynomials describe. `white` is the white noise of its readings [m/s^2], `radius`
/// the largest distance of the proof masses from the axes of rotation [m].
pub(super) fn is_smooth(fit: &PlateauFit, white: &Vector3<f64>, radius: f64) -> bool {
    let Some(Interval { half, .. }) = fit.shape.turning else { return true };
    let size = fit.mean.norm();
    let along = fit.mean.normalize();
    let uncertainty = along.component_mul(white).norm() / (fit.samples as f64).sqrt();
    let left = left(fit, white);
    // A bump takes some samples. Where many are left out, or the others are not described either, it is the motion that the polynomials miss:
    // the mean of the arc then lacks what these samples read.
    let scatter = white.norm_squared() * (2.0 / fit.samples as f64).sqrt();
    let is_described =
        fit.left_out.spikes == 0 || fit.left_out.spikes <= fit.samples / PER_SPIKE && left <= MOST_SCATTER * scatter;
    // The way is `sqrt(left) / size`, and readings may be in counts, `size / g` of them for an acceleration: the size drops out.
    let of_kink = radius / STANDARD_GRAVITY * OF_KINK * left.sqrt() / (half * half);
    is_described && (left / (2.0 * size)).max(of_kink) <= MOST_LEFT * uncertainty
}

/// Mean square of what the polynomials of an arc, or the mean of a rest, leave beside the white noise [m^2/s^4].
fn left(fit: &PlateauFit, white: &Vector3<f64>) -> f64 {
    (fit.variance.sum() - white.norm_squared()).max(0.0)
}

/// Mean square of what trembles about a `mean` reading beside the white noise, in units of gravity.
pub(super) fn trembles(fit: &PlateauFit, mean: &Vector3<f64>, white: &Vector3<f64>, ellipsoid: &Ellipsoid) -> f64 {
    left(fit, white) / (mean - ellipsoid.centre()).norm_squared()
}

/// Draws out the means of the `fits` of all records, each with the white noise of its readings [m/s^2] and the part of what trembles in it that
/// is attitude; the ellipsoid of all means, which is `ellipsoid` before. A rest whose attitude trembles by 10 mrad about both axes is shorter
/// by 1e-4.
pub(super) fn draw_out<'a>(
    fits: impl IntoIterator<Item = (&'a mut PlateauFit, Vector3<f64>, f64)>,
    mut ellipsoid: Ellipsoid,
) -> Ellipsoid {
    let mut fits: Vec<(&mut PlateauFit, Vector3<f64>, f64)> = fits.into_iter().collect();
    let mean: Vec<Vector3<f64>> = fits.iter().map(|(fit, ..)| fit.mean).collect();
    for _ in 0..ROUNDS {
        for ((fit, white, attitude), mean) in fits.iter_mut().zip(&mean) {
            let part = |k: usize| ellipsoid.size(&fit.turning[k]).powi(2) / (2 * k + 3) as f64;
            let left = trembles(fit, mean, white, &ellipsoid);
            // What the polynomials of an arc leave is motion of its attitude.
            let left = if fit.turns() { left } else { left * *attitude };
            let size = (1.0 - (0..TURNING).map(part).sum::<f64>() - left).sqrt();
            fit.mean = ellipsoid.centre() + (mean - ellipsoid.centre()) / size;
        }
        ellipsoid = Ellipsoid::nearest(&fits.iter().map(|(fit, ..)| fit.mean).collect::<Vec<_>>());
    }
    ellipsoid
}

/// The noise of a record along the force, in units of `white` [m/s^2], over stretches of arcs of a turn each: their fits as those of rests. Errors of
/// the coefficients follow the attitude: noise as slow as a turn weighs in them. Longer stretches would be too few to show the density.
///
/// # Errors
/// [`ReductionError`] if the record is too short.
pub(super) fn noise_along(
    record: RecordSlice,
    fits: &[PlateauFit],
    ellipsoid: &Ellipsoid,
    white: &Vector3<f64>,
) -> Result<Vec<PlateauFit>, ReductionError> {
    let mut spans: Vec<[f64; 2]> = Vec::new();
    let arcs: Vec<&PlateauFit> = fits.iter().filter(|fit| fit.turns()).collect();
    let turn = time_of_turn(&arcs);
    for arc in &arcs {
        let [from, to] = arc.window;
        match spans.last_mut() {
            Some(span) if from - span[1] < 1e-6 * (to - from) && to - span[0] <= turn => span[1] = to,
            _ => spans.push([from, to]),
        }
    }
    if spans.is_empty() {
        return Ok(Vec::new());
    }
    let accelerated = Accelerated::of(&arcs, ellipsoid);
    let noise = |n: usize| {
        let reading = Vector3::from_fn(|axis, _| record.f_z[axis][n]);
        let excess = ellipsoid.excess(&reading) - accelerated.excess(ellipsoid, &reading, record.t[n]);
        excess / ellipsoid.half_gradient(&reading).component_mul(white).norm()
    };
    let noise: Vec<f64> = (0..record.t.len()).map(noise).collect();
    let noise = Record { t: record.t.to_vec(), f_z: [noise.clone(), noise.clone(), noise] };
    let located = Survey::of(noise.as_slice())?.locate_spans(&spans)?;
    Ok((0..spans.len()).filter_map(|span| located.average(span, noise.as_slice()).ok()).collect())
}

/// Time of a whole turn at the mean rate [s].
fn time_of_turn(arcs: &[&PlateauFit]) -> f64 {
    let (mut turned, mut lasted) = (0.0, 0.0);
    for (arc, [from, to]) in arcs.iter().filter_map(|fit| Some((fit.arc()?, fit.window))) {
        turned += arc.rate * (to - from);
        lasted += to - from;
    }
    TAU * lasted / turned
}

/// Mean second derivative of the vertical over an arc [1/s^2].
fn bend(arc: &PlateauFit) -> Vector3<f64> {
    arc.arc().map_or_else(Vector3::zeros, |arc| arc.bend_z)
}

/// What an ellipsoid leaves of the sizes of arcs that a place beside the axes explains, with another ellipsoid that is not drawn towards it.
struct Accelerated {
    /// Of the terms of [`row`].
    coefficients: DVector<f64>,
    /// Middle of each arc [s], and its bend over the largest of all.
    bends: Vec<(f64, Vector3<f64>)>,
}

impl Accelerated {
    /// By least squares; nothing where the arcs are no more than the coefficients. What the arcs hardly show stays zero: only the sum is asked for.
    fn of(arcs: &[&PlateauFit], ellipsoid: &Ellipsoid) -> Self {
        const TERMS: usize = 12;
        let most = arcs.iter().map(|arc| bend(arc).norm()).fold(f64::MIN_POSITIVE, f64::max);
        let middle = |arc: &PlateauFit| 0.5 * (arc.window[0] + arc.window[1]);
        let bends: Vec<(f64, Vector3<f64>)> = arcs.iter().map(|arc| (middle(arc), bend(arc) / most)).collect();
        let rows = arcs.iter().zip(&bends).flat_map(|(arc, (_, bend))| row(ellipsoid, &arc.mean, bend));
        let rows = DMatrix::from_row_iterator(arcs.len(), TERMS, rows);
        let excess = DVector::from_iterator(arcs.len(), arcs.iter().map(|arc| ellipsoid.excess(&arc.mean)));
        let solved = (arcs.len() > TERMS).then(|| rows.svd(true, true));
        let coefficients = solved.and_then(|svd| svd.solve(&excess, LEAST * svd.singular_values.max()).ok());
        Self { coefficients: coefficients.unwrap_or_else(|| DVector::zeros(TERMS)), bends }
    }

    /// That of a reading at the time `t` [s].
    fn excess(&self, ellipsoid: &Ellipsoid, reading: &Vector3<f64>, t: f64) -> f64 {
        self.coefficients.iter().zip(row(ellipsoid, reading, &self.bend_at(t))).map(|(x, term)| x * term).sum()
    }

    /// Between the middles of two arcs on a straight line: within an arc the bend turns as the vertical does.
    fn bend_at(&self, t: f64) -> Vector3<f64> {
        let next = self.bends.partition_point(|(middle, _)| *middle < t);
        match (next.checked_sub(1).and_then(|before| self.bends.get(before)), self.bends.get(next)) {
            (Some((from, before)), Some((to, after))) => before + (after - before) * ((t - from) / (to - from)),
            (Some((_, bend)), None) | (None, Some((_, bend))) => *bend,
            (None, None) => Vector3::zeros(),
        }
    }
}

/// Squares, products and components of the direction of a reading, and the coordinates of a bend.
fn row(ellipsoid: &Ellipsoid, reading: &Vector3<f64>, bend: &Vector3<f64>) -> [f64; 12] {
    let (y, b) = ((reading - ellipsoid.centre()).normalize(), bend);
    [y.x * y.x, y.y * y.y, y.z * y.z, y.x * y.y, y.x * y.z, y.y * y.z, y.x, y.y, y.z, b.x, b.y, b.z]
}
