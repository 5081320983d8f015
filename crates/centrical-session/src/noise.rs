//! Noise of a record: stability deviations, spectrum and noise terms of every column of readings.

mod json;
mod series;

use std::path::{Path, PathBuf};

use centrical::stability::{Analysis, CONFIDENCE, Estimator, analyse};
use rayon::prelude::*;

pub use self::json::NOISE_SCHEMA;
pub use self::series::Series;
use crate::error::Error;

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
    /// Its noise.
    pub noise: Analysis,
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
            let noise = analyse(&series.t, values, estimators).map_err(failed)?;
            Ok(ReadingNoise { name: name.clone(), unit: unit.clone(), noise })
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
    /// [`Error::Io`] when the folder does not take it.
    pub fn write(&self, file: &Path) -> Result<(), Error> {
        crate::write::write_whole(file, self.to_json().as_bytes())
    }
}
