//! Noise of a record: stability deviations, spectrum and noise terms of every column of readings.

use centrical::noise::{
    Deviation, Estimator, NoiseError, Phase, deviations, fit_noise_terms, leave_out_spikes, power_spectrum,
    regular_grid,
};
use rayon::prelude::*;

use super::series::Series;
use crate::document::{NoiseAnalysis, ReadingNoise};
use crate::error::Error;

/// Probability of every interval: one standard deviation of a normal law.
const CONFIDENCE: f64 = 0.683;

/// Analyses the readings of a file by the estimators.
///
/// # Errors
/// [`Error::Noise`] if a column is no series of readings: too few, or hardly any two of them evenly spaced.
pub fn analyse_noise(series: &Series, estimators: &[Estimator]) -> Result<NoiseAnalysis, Error> {
    let columns = series.columns.par_iter();
    let analysed = columns.map(|(name, unit, values)| {
        let failed = |source| Error::Noise { file: series.file.clone(), reading: name.clone(), source };
        of_reading(name, unit, &series.t, values, estimators).map_err(failed)
    });
    Ok(NoiseAnalysis {
        file: series.file.clone(),
        window: [series.t.first(), series.t.last()].map(|t| t.copied().unwrap_or(f64::NAN)),
        confidence: CONFIDENCE,
        readings: analysed.collect::<Result<_, _>>()?,
    })
}

fn of_reading(
    name: &str,
    unit: &str,
    t: &[f64],
    values: &[f64],
    estimators: &[Estimator],
) -> Result<ReadingNoise, NoiseError> {
    let mut grid = regular_grid(t, values)?;
    let spikes = leave_out_spikes(&mut grid.readings);
    let phase = Phase::integrate(&grid.readings, grid.interval)?;
    let seen = || grid.readings.iter().filter(|y| y.is_finite());
    let samples = seen().count();
    Ok(ReadingNoise {
        name: name.to_owned(),
        unit: unit.to_owned(),
        mean: seen().sum::<f64>() / samples as f64,
        interval: grid.interval,
        samples,
        spikes,
        repeated: grid.repeated,
        gaps: phase.gaps(),
        deviations: estimators.iter().map(|e| Ok((*e, family(&phase, *e)?))).collect::<Result<_, NoiseError>>()?,
        spectrum: power_spectrum(&grid.readings, grid.interval, segment(grid.readings.len())),
        terms: fit_noise_terms(&phase),
    })
}

/// Deviations at 1, 2, 4, ... sampling intervals, to half the record.
///
/// Estimators that take the product of record and averaging time stop where that is more than some seconds of work.
fn family(phase: &Phase, estimator: Estimator) -> Result<Vec<Deviation>, NoiseError> {
    /// Operations that take some seconds.
    const WORK: usize = 1 << 32;
    let is_product = matches!(estimator, Estimator::ModifiedTotal | Estimator::TimeTotal | Estimator::HadamardTotal);
    let longest = if is_product { WORK / phase.points().len() } else { usize::MAX };
    let factors: Vec<usize> = phase.octaves(2).into_iter().filter(|m| *m <= longest).collect();
    deviations(phase, estimator, &factors, CONFIDENCE)
}

/// Length of the spectrum's segments: a power of two, of which some 16 fit half overlapping; so a density has about 30
/// degrees of freedom. Longer than 2^17 it would show nothing more.
fn segment(readings: usize) -> usize {
    let eighth = (readings / 8).max(8);
    1 << eighth.ilog2().min(17)
}
