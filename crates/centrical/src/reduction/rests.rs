//! Records of a unit that was turned by hand or on a table: the mean of every rest, without a schedule.

use nalgebra::Vector3;

use super::average::{PlateauFit, ReducedMounting};
use super::colour::NoiseModel;
use super::ellipsoid::Ellipsoid;
use super::error::ReductionError;
use super::locate::Located;
use super::plateau::PlateauMean;
use super::record::RecordSlice;
use super::survey::Survey;
use super::trembling::{AttitudePart, white_noise};
use super::turning::{draw_out, is_smooth, noise_along, trembles};
use crate::progress::{OnProgress, advance};

/// The rests of some records.
#[derive(Debug, Clone, PartialEq)]
pub struct Rests {
    /// Their means, record by record in the order of time.
    pub means: Vec<Vec<PlateauMean>>,
    /// Variance of the means along the specific force at most, over the one stated, but for a chance of [`NoiseModel::EXCLUDED`]: few rests
    /// show the colour of their noise poorly.
    pub noise_at_most: f64,
}

impl Rests {
    /// The means of the rests of some records. With the largest distance of the proof masses from the axes of a slow rotation [m], arcs of such rotation
    /// count as rests, if the attitudes of all show an ellipsoid; with `None` they do not. The colour of the noise is pooled over all rests. A rest
    /// whose samples are not steady is left out. `progress` is asked again and again.
    ///
    /// # Errors
    /// [`ReductionError`] if a record is invalid (lengths, times), too short, or stuck or saturated in a rest, or when the caller stops.
    pub fn of(records: &[(RecordSlice, Option<f64>)], progress: OnProgress<()>) -> Result<Rests, ReductionError> {
        let located = records.iter().map(|&(samples, turning_radius)| {
            let located = Survey::of(samples)?.locate_rests(turning_radius.is_some())?;
            let fits = averaged(&located, samples, turning_radius, progress)?;
            Ok((located, fits))
        });
        let mut located: Vec<(Located, Vec<PlateauFit>)> = located.collect::<Result<_, ReductionError>>()?;
        if Ellipsoid::through(&means_of(&located)).is_none() {
            for (_, fits) in &mut located {
                fits.retain(|fit| !fit.turns());
            }
        }
        let coarse = Ellipsoid::nearest(&means_of(&located));
        let of_record = |(&(samples, _), (located, fits)): (&(RecordSlice, _), &(Located, Vec<PlateauFit>))| {
            let white = white_noise(samples, fits, &coarse, located.sample_noise());
            let part = AttitudePart::of(samples, fits, &coarse, &white);
            ((white, part), uncertain_sizes(fits, &white, &coarse, part))
        };
        let (trembling, uncertain): (Vec<_>, Vec<_>) = records.iter().zip(&located).map(of_record).unzip();
        advance(progress, ())?;
        let with_noise = located
            .iter_mut()
            .zip(&trembling)
            .flat_map(|((_, fits), (white, part))| fits.iter_mut().map(move |fit| (fit, *white, part.mean)));
        let ellipsoid = draw_out(with_noise, coarse);
        advance(progress, ())?;
        let mut along = Vec::new();
        for (&(samples, _), (located, fits)) in records.iter().zip(&located) {
            along.extend(noise_along(samples, fits, &ellipsoid, located.sample_noise())?);
        }
        let reduced = located.into_iter().map(|(located, fits)| {
            let of_rest = |fit: PlateauFit| {
                let along = ellipsoid.normal(&fit.mean);
                fit.of_rest(&along, located.sample_noise())
            };
            let rests = fits.into_iter().map(of_rest).collect();
            ReducedMounting::of_rests(located, rests)
        });
        let reduced: Vec<ReducedMounting> = reduced.collect();
        advance(progress, ())?;
        let noise = NoiseModel::pool_rests(&reduced, &along);
        advance(progress, ())?;
        let means = reduced.iter().zip(&uncertain).map(|(record, uncertain)| {
            let mut means = record.means(&noise);
            for (mean, variance) in means.iter_mut().zip(uncertain) {
                let along = ellipsoid.normal(&mean.mean);
                mean.covariance += along * along.transpose() * *variance;
            }
            means
        });
        let means = means.collect();
        advance(progress, ())?;
        Ok(Rests { means, noise_at_most: noise.at_most(&reduced) })
    }
}

/// The means of all records.
fn means_of(located: &[(Located, Vec<PlateauFit>)]) -> Vec<Vector3<f64>> {
    located.iter().flat_map(|(_, fits)| fits.iter().map(|fit| fit.mean)).collect()
}

/// Variances of the sizes of the rests of a record [m^2/s^4], as far as it is open which `part` of what trembles is attitude. That is one error
/// `c` of all rests; variances `c_k sum |c_j|` of their own are no smaller than it for any combination, since `c c^T <= diag(c_k sum c_j)`.
fn uncertain_sizes(fits: &[PlateauFit], white: &Vector3<f64>, ellipsoid: &Ellipsoid, part: AttitudePart) -> Vec<f64> {
    let error = |fit: &PlateauFit| {
        let trembles = if fit.turns() { 0.0 } else { trembles(fit, &fit.mean, white, ellipsoid) };
        0.5 * trembles * part.standard_uncertainty * (fit.mean - ellipsoid.centre()).norm()
    };
    let errors: Vec<f64> = fits.iter().map(error).collect();
    let sum: f64 = errors.iter().sum();
    errors.into_iter().map(|error| error * sum).collect()
}

/// The rests of a record that are steady, and its arcs that are smooth. A rest at the end of the range refuses the record: without it a
/// face would be missing in silence.
fn averaged(
    located: &Located,
    samples: RecordSlice,
    turning_radius: Option<f64>,
    progress: OnProgress<()>,
) -> Result<Vec<PlateauFit>, ReductionError> {
    let is_smooth =
        |fit: &PlateauFit| turning_radius.is_none_or(|radius| is_smooth(fit, located.sample_noise(), radius));
    let mut fits = Vec::new();
    for rest in 0..located.windows().len() {
        advance(progress, ())?;
        match located.average(rest, samples) {
            Err(beyond @ (ReductionError::Saturated { .. } | ReductionError::Stuck { .. })) => return Err(beyond),
            fit => fits.extend(fit.ok().filter(is_smooth)),
        }
    }
    Ok(fits)
}
