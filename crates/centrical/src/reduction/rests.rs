//! Records of a unit that was turned by hand or on a table: the mean of every rest, without a schedule.

use nalgebra::Vector3;

use super::average::{PlateauFit, ReducedMounting, average};
use super::colour::{NoiseModel, plateau_means};
use super::ellipsoid::Ellipsoid;
use super::error::ReductionError;
use super::locate::{Located, locate_rests};
use super::plateau::PlateauMean;
use super::record::RecordSlice;
use super::survey::Survey;
use super::turning::{draw_out, is_smooth, noise_along};
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
    let all = located.iter().flat_map(|(_, fits)| fits.iter().map(|fit| fit.mean));
    if Ellipsoid::through(&all.collect::<Vec<Vector3<f64>>>()).is_none() {
        for (_, fits) in &mut located {
            fits.retain(|fit| !fit.turns());
        }
    }
    let with_noise = located.iter_mut().flat_map(|(located, fits)| {
        let white = *located.sample_noise();
        fits.iter_mut().map(move |fit| (fit, white))
    });
    let ellipsoid = draw_out(with_noise);
    advance(progress, ())?;
    let mut along = Vec::new();
    for (record, (located, fits)) in records.iter().zip(&located) {
        along.extend(noise_along(record.samples, fits, &ellipsoid, located.sample_noise())?);
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
