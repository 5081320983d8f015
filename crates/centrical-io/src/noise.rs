//! Noise of a record: stability deviations, spectrum and noise terms of every column of readings.

mod json;
mod series;

use std::path::{Path, PathBuf};

use centrical::noise::{
    Deviation, Estimator, Gaps, NoiseError, NoiseTerms, Phase, Spectrum, deviations, fit_noise_terms, leave_out_spikes,
    power_spectrum, regular_grid,
};
use centrical_table::write_whole;
use rayon::prelude::*;

pub use self::json::NOISE_SCHEMA;
pub use self::series::Series;
use crate::error::Error;

/// Probability of every interval: one standard deviation of a normal law.
const CONFIDENCE: f64 = 0.683;

/// The noise of a record.
#[derive(Debug, Clone)]
pub struct NoiseAnalysis {
    /// The file.
    pub file: PathBuf,
    /// From, to: the part that was analysed, the record's clock [s].
    pub window: [f64; 2],
    /// Probability of the intervals.
    pub confidence: f64,
    /// One for each column of readings.
    pub readings: Vec<ReadingNoise>,
}

/// The noise of one column of readings.
#[derive(Debug, Clone)]
pub struct ReadingNoise {
    /// The column.
    pub name: String,
    /// Its unit: m/s^2 for accelerations, as in the file otherwise.
    pub unit: String,
    /// Mean of what was used [unit].
    pub mean: f64,
    /// Sampling interval [s].
    pub interval: f64,
    /// Readings used.
    pub samples: usize,
    /// Readings left out as spikes.
    pub spikes: usize,
    /// Samples left out as repeated.
    pub repeated: usize,
    /// What was missing and bridged, spikes among it.
    pub gaps: Gaps,
    /// Deviations by estimator, at averaging factors 1, 2, 4, ...
    pub deviations: Vec<(Estimator, Vec<Deviation>)>,
    /// The spectrum, or why there is none.
    pub spectrum: Result<Spectrum, NoiseError>,
    /// The noise terms, or why there are none.
    pub terms: Result<NoiseTerms, NoiseError>,
}

impl NoiseAnalysis {
    /// Analyses the readings of a file by the estimators.
    ///
    /// # Errors
    /// [`Error::Noise`] if a column is no series of readings: too few, or hardly any two of them evenly spaced.
    pub fn of(series: &Series, estimators: &[Estimator]) -> Result<Self, Error> {
        let columns = series.columns.par_iter();
        let analysed = columns.map(|(name, unit, values)| {
            let failed = |source| Error::Noise { file: series.file.clone(), reading: name.clone(), source };
            ReadingNoise::of(name, unit, &series.t, values, estimators).map_err(failed)
        });
        Ok(Self {
            file: series.file.clone(),
            window: [series.t.first(), series.t.last()].map(|t| t.copied().unwrap_or(f64::NAN)),
            confidence: CONFIDENCE,
            readings: analysed.collect::<Result<_, _>>()?,
        })
    }

    /// The file's name without its folders.
    pub fn file_name(&self) -> String {
        self.file.file_name().unwrap_or(self.file.as_os_str()).to_string_lossy().into_owned()
    }

    /// Writes the analysis as JSON; the file appears whole or not at all.
    ///
    /// # Errors
    /// [`Error::Table`] when the folder does not take it.
    pub fn write(&self, file: &Path) -> Result<(), Error> {
        Ok(write_whole(file, self.to_json().as_bytes())?)
    }
}

impl ReadingNoise {
    fn of(name: &str, unit: &str, t: &[f64], values: &[f64], estimators: &[Estimator]) -> Result<Self, NoiseError> {
        let mut grid = regular_grid(t, values)?;
        let spikes = leave_out_spikes(&mut grid.readings);
        let phase = Phase::integrate(&grid.readings, grid.interval)?;
        let seen = || grid.readings.iter().filter(|y| y.is_finite());
        let samples = seen().count();
        Ok(Self {
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

    /// The noise terms, if they describe the deviations: what may be quoted.
    pub fn quotable(&self) -> Option<&NoiseTerms> {
        self.terms.as_ref().ok().filter(|terms| terms.is_consistent())
    }
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
