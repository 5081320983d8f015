//! Records of a unit that was turned by hand or on a table: the mean of every rest, without a schedule; and the coarse scale
//! and bias of readings that are not in units of acceleration.

use nalgebra::{DMatrix, DVector, Vector3};

use super::average::{PlateauFit, ReducedMounting, average};
use super::colour::{NoiseModel, plateau_means};
use super::error::ReductionError;
use super::locate::{Located, locate_rests};
use super::plateau::PlateauMean;
use super::record::RecordSlice;
use super::survey::Survey;
use super::turning::{draw_out, is_smooth, noise_along};
use crate::linalg::least_squares::LeastSquares;
use crate::progress::{OnProgress, Stopped, advance};

/// The rests of some records.
#[derive(Debug, Clone, PartialEq)]
pub struct Rests {
    /// Their means, record by record in the order of time.
    pub means: Vec<Vec<PlateauMean>>,
    /// Variance of the means along the specific force at most, over the one stated, but for a chance of [`EXCLUDED`]: few rests show the colour of
    /// their noise poorly.
    ///
    /// [`EXCLUDED`]: super::EXCLUDED
    pub noise_at_most: f64,
}

/// A record of a unit that is turned.
#[derive(Debug, Clone, Copy)]
pub struct RestRecord<'a> {
    /// Its readings.
    pub samples: RecordSlice<'a>,
    /// Largest distance of the proof masses from the axes of a slow rotation [m], whose arcs then count as rests; `None` if they do not.
    pub turning_radius: Option<f64>,
}

impl<'a> From<RecordSlice<'a>> for RestRecord<'a> {
    /// A record whose slow rotation does not count.
    fn from(samples: RecordSlice<'a>) -> Self {
        Self { samples, turning_radius: None }
    }
}

/// The means of the rests of some records. The colour of the noise is pooled over all of them. A rest whose samples are not steady
/// is left out. Arcs of slow rotation count if the attitudes of all show an ellipsoid. `progress` is asked again and again.
///
/// # Errors
/// [`ReductionError`] if a record is invalid (lengths, times) or too short, or when the caller stops.
pub fn reduce_rests(records: &[RestRecord], progress: OnProgress<()>) -> Result<Rests, ReductionError> {
    let located = records.iter().map(|record| {
        let located = locate_rests(&Survey::of(record.samples)?, record.turning_radius.is_some())?;
        let fits = averaged(&located, record, progress)?;
        Ok((located, fits))
    });
    let mut located: Vec<(Located, Vec<PlateauFit>)> = located.collect::<Result<_, ReductionError>>()?;
    let with_noise = located.iter_mut().flat_map(|(located, fits)| {
        let white = *located.sample_noise();
        fits.iter_mut().map(move |fit| (fit, white))
    });
    let ellipsoid = draw_out(with_noise);
    advance(progress, ())?;
    let mut along = Vec::new();
    for (record, (located, fits)) in records.iter().zip(&mut located) {
        match &ellipsoid {
            Some(ellipsoid) => along.extend(noise_along(record.samples, fits, ellipsoid, located.sample_noise())?),
            None => fits.retain(|fit| !fit.turns()),
        }
    }
    // Too few attitudes show no ellipsoid: the reading points about as the force does.
    let direction =
        |mean: &Vector3<f64>| ellipsoid.as_ref().map_or(mean.normalize(), |ellipsoid| ellipsoid.normal(mean));
    let reduced = located.into_iter().map(|(located, fits)| {
        let of_rest = |fit: PlateauFit| {
            let along = direction(&fit.mean);
            fit.of_rest(&along, located.sample_noise())
        };
        let rests = fits.into_iter().map(of_rest).collect();
        ReducedMounting::of_rests(located, rests)
    });
    let reduced: Vec<ReducedMounting> = reduced.collect();
    advance(progress, ())?;
    let noise = NoiseModel::pool_rests(&reduced, &along);
    advance(progress, ())?;
    let means = reduced.iter().map(|record| plateau_means(record, &noise)).collect();
    advance(progress, ())?;
    Ok(Rests { means, noise_at_most: noise.at_most(&reduced) })
}

/// The rests of a record that are steady, and its arcs that are smooth.
fn averaged(located: &Located, record: &RestRecord, progress: OnProgress<()>) -> Result<Vec<PlateauFit>, Stopped> {
    let is_smooth =
        |fit: &PlateauFit| record.turning_radius.is_none_or(|radius| is_smooth(fit, located.sample_noise(), radius));
    let mut fits = Vec::new();
    for rest in 0..located.windows().len() {
        advance(progress, ())?;
        fits.extend(average(located, rest, record.samples, 0).ok().filter(is_smooth));
    }
    Ok(fits)
}

/// Coarse scale and bias of three newtonometers: `reading = scale f + bias`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoarseScale {
    /// Readings per m/s^2.
    pub scale: Vector3<f64>,
    /// Readings at no specific force.
    pub bias: Vector3<f64>,
}

/// Coarse scale and bias by which the readings `means` of rests have the length of `gravity` [m/s^2]: the ellipsoid
/// `sum_i ((c_i - bias_i) / scale_i)^2 = g^2` with axes along those of the instrument, by linear least squares. Scales are
/// positive: gravity does not show the sign of an axis. `None` if the rests determine no such ellipsoid: each axis has to point
/// up and down, about.
pub fn coarse_scale(means: &[Vector3<f64>], gravity: f64) -> Option<CoarseScale> {
    let first = *means.first()?;
    let (low, high) = means.iter().fold((first, first), |(low, high), mean| (low.inf(mean), high.sup(mean)));
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    // Within the ellipsoid the equation `sum_i (a_i y_i^2 + b_i y_i) = 1` holds for some a > 0.
    let row = |mean: &Vector3<f64>| {
        let y = (mean - middle).component_div(&half);
        [y.x * y.x, y.y * y.y, y.z * y.z, y.x, y.y, y.z]
    };
    let rows = DMatrix::from_row_iterator(means.len(), 6, means.iter().flat_map(row));
    if means.len() < 6 || rows.iter().any(|value| !value.is_finite()) {
        return None;
    }
    let solution = LeastSquares::new(rows, DVector::repeat(6, 1.0)).solve(DVector::repeat(means.len(), 1.0)).x;
    let (a, b) = (solution.fixed_rows::<3>(0).into_owned(), solution.fixed_rows::<3>(3).into_owned());
    if a.iter().any(|a| !a.is_finite() || *a <= 0.0) {
        return None;
    }
    let size = 1.0 + b.component_mul(&b).component_div(&a).sum() / 4.0;
    Some(CoarseScale {
        scale: half.zip_map(&a, |half, a| half * (size / a).sqrt() / gravity),
        bias: middle - half.component_mul(&b.component_div(&a)) / 2.0,
    })
}
