//! Which readings are analysed, and how.

use std::path::PathBuf;

use centrical::OnProgress;
use centrical::stability::Estimator;
use centrical_table::{ColumnName, TableLines};

use super::analysis::analyse_noise;
use super::series::Series;
use crate::document::NoiseAnalysis;
use crate::error::Error;
use crate::experiment::{PlateauName, Session};
use crate::record::{Columns, named_columns};

/// Which readings are analysed, and how.
#[derive(Debug, Clone, PartialEq)]
pub struct NoiseRequest {
    /// A record, or a session.
    pub file: PathBuf,
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
    let (series, plateau) = series(request, progress)?;
    let mut estimators: Vec<Estimator> = Vec::new();
    for estimator in &request.estimators {
        if !estimators.contains(estimator) {
            estimators.push(*estimator);
        }
    }
    Ok((analyse_noise(&series, &estimators, progress)?, plateau))
}

fn series(request: &NoiseRequest, progress: OnProgress) -> Result<(Series, Option<PlateauName>), Error> {
    let NoiseRequest { file, .. } = request;
    if file.is_dir() || file.extension().is_some_and(|extension| extension == "toml") {
        let (series, name) = Series::of_plateau(&Session::read(file)?, request.plateau, progress)?;
        return Ok((series, Some(name)));
    }
    let mut lines = TableLines::default();
    let (time, readings) = match &request.session {
        Some(session) => {
            let Columns { time, f, record_lines, .. } = Session::read(session)?.columns;
            lines = record_lines;
            (time, f.to_vec())
        }
        None => named_columns(&request.time, request.rate, &request.readings, &request.unit),
    };
    Ok((Series::read(file, lines, &time, &readings, request.window, progress)?, None))
}
