//! Noise of a record: stability deviations, spectrum and noise terms of every column of readings.

use centrical::reduction::staircase;
use centrical::stability::{CONFIDENCE, Estimator, analyse};
use rayon::prelude::*;

use super::series::Series;
use crate::document::{NoiseAnalysis, ReadingNoise};
use crate::error::Error;

/// Analyses the readings of a file by the estimators.
///
/// # Errors
/// [`Error::Noise`] if a column is no series of readings: too few, or hardly any two of them evenly spaced.
pub fn analyse_noise(series: &Series, estimators: &[Estimator]) -> Result<NoiseAnalysis, Error> {
    let columns = series.columns.par_iter();
    let analysed = columns.map(|(name, unit, values)| {
        let failed = |source| Error::Noise { file: series.file.clone(), reading: name.clone(), source };
        let noise = analyse(&series.t, values, estimators).map_err(failed)?;
        Ok::<_, Error>(ReadingNoise {
            name: name.clone(),
            unit: unit.clone(),
            staircase: staircase(&series.t, values),
            noise,
        })
    });
    Ok(NoiseAnalysis {
        file: series.file.clone(),
        window: [series.t.first(), series.t.last()].map(|t| t.copied().unwrap_or(f64::NAN)),
        confidence: CONFIDENCE,
        readings: analysed.collect::<Result<_, Error>>()?,
    })
}
