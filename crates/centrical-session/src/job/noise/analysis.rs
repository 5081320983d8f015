//! Noise of a record: stability deviations, spectrum and noise terms of every column of readings.

use centrical::OnProgress;
use centrical::reduction::Staircase;
use centrical::stability::{Analysis, Estimator};
use rayon::prelude::*;

use super::series::Series;
use crate::document::{NoiseAnalysis, ReadingNoise};
use crate::error::Error;

/// Analyses the readings of a file by the estimators. `progress` is asked again and again, with no bytes.
///
/// # Errors
/// [`Error::Noise`] if a column is not a series of readings: too few, or hardly any two of them evenly spaced;
/// [`Error::Stopped`].
pub fn analyse_noise(series: &Series, estimators: &[Estimator], progress: OnProgress) -> Result<NoiseAnalysis, Error> {
    let columns = series.columns.par_iter();
    let analysed = columns.map(|(name, unit, values)| {
        let failed = |source| Error::noise(&series.file, name, source);
        let noise = Analysis::of(&series.t, values, estimators, &|()| progress(0)).map_err(failed)?;
        let staircase = Staircase::of(&series.t, values, &|()| progress(0))?;
        Ok::<_, Error>(ReadingNoise { name: name.clone(), unit: unit.clone(), staircase, noise })
    });
    Ok(NoiseAnalysis {
        file: series.file.clone(),
        window: [series.t.first(), series.t.last()].map(|t| t.copied().unwrap_or(f64::NAN)),
        confidence: Analysis::CONFIDENCE,
        readings: analysed.collect::<Result<_, Error>>()?,
    })
}
