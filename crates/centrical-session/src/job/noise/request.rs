//! Which readings are analysed, and how.

use std::path::PathBuf;

use centrical::OnProgress;
use centrical::reduction::Staircase;
use centrical::stability::{Analysis, Estimator};
use centrical_table::{ColumnName, TableLines};
use rayon::prelude::*;

use super::series::Series;
use crate::document::{NoiseAnalysis, ReadingNoise};
use crate::error::{Error, Place};
use crate::experiment::{Folder, PlateauName, Session};
use crate::record::{Columns, RECORD, named_columns};

/// Which readings are analysed, and how.
#[derive(Debug, Clone, PartialEq)]
pub struct NoiseRequest {
    /// A record, or a session.
    pub file: PathBuf,
    /// Where the record is.
    pub folder: Folder,
    /// Plateau of the session; `None` for the longest at rest.
    pub plateau: Option<PlateauName>,
    /// The session that says columns and units of the record, in place of the four fields below.
    pub session: Option<PathBuf>,
    /// Column of time [s].
    pub time: ColumnName,
    /// Sampling rate of a record without a column of time [Hz].
    pub rate: Option<f64>,
    /// Columns of readings.
    pub readings: Vec<ColumnName>,
    /// Unit of the readings.
    pub unit: String,
    /// From, to on the clock of the record [s].
    pub window: [f64; 2],
    /// Estimators; one that is named twice counts once.
    pub estimators: Vec<Estimator>,
}

/// Analyses the noise of a record or of a plateau of a session, which is named then. `progress` is called with the number of bytes
/// read, from any thread, and with none while they are analysed.
///
/// # Errors
/// [`Error`] naming the file, the place, what was found and what was expected.
pub fn noise_of(request: &NoiseRequest, progress: OnProgress) -> Result<(NoiseAnalysis, Option<PlateauName>), Error> {
    let NoiseRequest { file, estimators, .. } = request;
    let [from, to] = request.window;
    let asked = || format!("--from {from} s and --to {to} s");
    if from >= to {
        return Err(Error::content(file, Place::Whole, asked(), "a beginning before the end"));
    }
    if Session::is_named_by(file) {
        if from.is_finite() || to.is_finite() {
            let expected = "one plateau of the session by --plateau, or the file of a record";
            return Err(Error::content(file, Place::Whole, asked(), expected));
        }
        let (analysis, name) = noise_of_plateau(&Session::read(file)?, request.plateau, estimators, progress)?;
        return Ok((analysis, Some(name)));
    }
    Ok((analyse_noise(&series(request, progress)?, &each_once(estimators), progress)?, None))
}

/// Analyses the noise of a plateau of a session; without a name of the longest at rest. Its name as well.
///
/// # Errors
/// As [`noise_of`].
pub fn noise_of_plateau(
    session: &Session,
    plateau: Option<PlateauName>,
    estimators: &[Estimator],
    progress: OnProgress,
) -> Result<(NoiseAnalysis, PlateauName), Error> {
    let (series, name) = Series::of_plateau(session, plateau, progress)?;
    Ok((analyse_noise(&series, &each_once(estimators), progress)?, name))
}

fn each_once(estimators: &[Estimator]) -> Vec<Estimator> {
    let mut once: Vec<Estimator> = Vec::new();
    for estimator in estimators {
        if !once.contains(estimator) {
            once.push(*estimator);
        }
    }
    once
}

/// The readings of a record.
fn series(request: &NoiseRequest, progress: OnProgress) -> Result<Series, Error> {
    let mut lines = TableLines::default();
    let (time, readings) = match &request.session {
        Some(session) => {
            let Columns { time, f, record_lines, .. } = Session::read(session)?.columns;
            lines = record_lines;
            (time, f.to_vec())
        }
        None => named_columns(&request.time, request.rate, &request.readings, &request.unit),
    };
    let source = request.folder.open(&request.file, RECORD)?;
    Series::read(source, lines, &time, &readings, request.window, progress)
}

/// Analyses the readings of a file by the estimators. `progress` is asked again and again, with no bytes.
///
/// # Errors
/// [`Error::Noise`] if a column is not a series of readings: too few, or hardly any two of them evenly spaced;
/// [`Error::Stopped`].
fn analyse_noise(series: &Series, estimators: &[Estimator], progress: OnProgress) -> Result<NoiseAnalysis, Error> {
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
