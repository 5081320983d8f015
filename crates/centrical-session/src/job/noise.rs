//! The noise of a record, or of one plateau of a session.

use std::path::PathBuf;

use centrical::reduction::Staircase;
use centrical::stability::{Analysis, Estimator, NoiseError, leave_out_spikes};
use centrical::{OnProgress, Stopped, advance};
use centrical_table::{ColumnName, Extent, Rule, Source, TableLines};
use rayon::prelude::*;

use super::reduce::reduce;
use crate::document::{NoiseAnalysis, ReadingNoise};
use crate::error::{Error, Place};
use crate::experiment::{Folder, PlateauName, Session};
use crate::record::{CheckedTable, Column, Columns, RECORD, Scale, StatedUnits, TableForm, TimeSpan, named_columns};
use crate::units::Dimension;

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
        let is_coded = matches!(noise.terms, Err(NoiseError::ErrorCode { .. }));
        let staircase = if is_coded { None } else { staircase(&series.t, values, &|()| progress(0))? };
        Ok::<_, Error>(ReadingNoise { name: name.clone(), unit: unit.clone(), staircase, noise })
    });
    Ok(NoiseAnalysis {
        file: series.file.clone(),
        window: [series.t.first(), series.t.last()].map(|t| t.copied().unwrap_or(f64::NAN)),
        confidence: Analysis::CONFIDENCE,
        readings: analysed.collect::<Result<_, Error>>()?,
    })
}

/// Whether readings move from one steady stretch to another, those that are missing or spikes left out.
fn staircase(t: &[f64], values: &[f64], progress: OnProgress<()>) -> Result<Option<Staircase>, Stopped> {
    let mut values = values.to_owned();
    leave_out_spikes(&mut values, progress)?;
    let kept = t.iter().zip(values).filter(|(_, value)| value.is_finite());
    let (t, values): (Vec<f64>, Vec<f64>) = kept.unzip();
    Staircase::of(&t, &values, progress)
}

/// Columns of readings, and their time.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// The file.
    pub file: PathBuf,
    /// Time [s].
    pub t: Vec<f64>,
    /// Name, unit and values of each column; accelerations are in m/s^2.
    pub columns: Vec<(String, String, Vec<f64>)>,
}

impl Series {
    /// Reads the columns `readings` of a file from `window[0]` to `window[1]` on its clock [s]. `progress` is called with the
    /// number of bytes read.
    ///
    /// # Errors
    /// As of a record; and if nothing is in the window.
    pub fn read(
        source: Source,
        lines: TableLines,
        time: &Column,
        readings: &[Column],
        window: [f64; 2],
        progress: OnProgress,
    ) -> Result<Self, Error> {
        let mut fields = vec![time.field(Rule::Ascending { stamps: true })];
        fields.extend(readings.iter().map(|column| column.field(Rule::OrMissing)));
        let (mut t, mut values) = (Vec::new(), vec![Vec::new(); readings.len()]);
        let mut span = TimeSpan::EMPTY;
        let file = source.name().to_owned();
        let columns = || std::iter::once(time).chain(readings);
        let form = TableForm { lines, missing: None, expected: RECORD };
        let mut table = CheckedTable::open(source, Extent::Whole, &fields, StatedUnits::of(columns()), form)?;
        let mut bytes = 0;
        while let Some(batch) = table.next_batch()? {
            for rows in batch.iter_mut().filter(|rows| !rows[0].is_empty()) {
                rows.iter_mut().zip(columns()).for_each(|(values, column)| column.scale.apply(values));
                let times = &rows[0];
                span.see(times);
                let inside = times.partition_point(|t| *t < window[0])..times.partition_point(|t| *t <= window[1]);
                t.extend_from_slice(&times[inside.clone()]);
                for (kept, values) in values.iter_mut().zip(&rows[1..]) {
                    kept.extend_from_slice(&values[inside.clone()]);
                }
            }
            let read = table.reader.bytes();
            advance(progress, read - std::mem::replace(&mut bytes, read))?;
        }
        span.refuse_years(&file, Place::Whole)?;
        if t.is_empty() {
            let TimeSpan(ends) = span;
            let found = format!("nothing from {} s to {} s", window[0], window[1]);
            let expected = format!("a stretch of the record, which runs from {} s to {} s", ends[0], ends[1]);
            return Err(Error::content(&file, Place::Whole, found, expected));
        }
        let named = |(column, values): (&Column, Vec<f64>)| (column.name.to_string(), si_unit(column), values);
        Ok(Self { file, t, columns: readings.iter().zip(values).map(named).collect() })
    }

    /// The readings of a mounting whose newtonometers have a file each.
    fn of_files(session: &Session, mounting: usize, window: [f64; 2], progress: OnProgress) -> Result<Self, Error> {
        let record = session.record_to(mounting, Extent::Whole, progress)?;
        let inside = record.as_slice().between(window);
        let named = |(column, values): (&Column, &[f64])| (column.name.to_string(), si_unit(column), values.to_vec());
        let columns = session.columns.f.iter().zip(inside.f_z).map(named).collect();
        Ok(Self { file: session.record_file(mounting)?.to_owned(), t: inside.t.to_vec(), columns })
    }

    /// The readings of one plateau on the arm of a session, in the window that a calibration would use; without a name those of
    /// the longest plateau at rest. Its name as well.
    ///
    /// # Errors
    /// As of a calibration; and if the session has no such plateau, or came already averaged.
    pub fn of_plateau(
        session: &Session,
        name: Option<PlateauName>,
        progress: OnProgress,
    ) -> Result<(Self, PlateauName), Error> {
        let session = &session.clone().on_arm();
        let (_, reduced) = reduce(session, progress)?;
        let set_points = &session.experiment.set_points;
        let length = |k: &usize| reduced.plateaus[*k].window().map_or(0.0, |[from, to]| to - from);
        let longest = || {
            (0..set_points.len()).filter(|k| set_points[*k].is_rest()).max_by(|a, b| length(a).total_cmp(&length(b)))
        };
        let set_point = name.map_or_else(|| Ok(longest()), |name| name.set_point(session).map(Some))?;
        let none = |found: &str| Error::content(&session.file, Place::Whole, found, "a plateau at rest in a record");
        let set_point = set_point.ok_or_else(|| none("no plateau at rest"))?;
        let files = &session.mountings[set_points[set_point].mounting];
        let (Some(window), Some(record)) = (reduced.plateaus[set_point].window(), files.records.first()) else {
            return Err(none("plateaus already averaged"));
        };
        let columns = &session.columns;
        if files.records.len() > 1 {
            // A mean of neighbours has less noise than they have.
            if reduced.mountings[set_points[set_point].mounting].interpolated.is_some() {
                let expected =
                    "samples as they were recorded: analyse the file of each newtonometer by itself (noise FILE)";
                return Err(Error::content(record, Place::Whole, "readings interpolated to common stamps", expected));
            }
            let series = Self::of_files(session, set_points[set_point].mounting, window, progress)?;
            return Ok((series, PlateauName::of(session, set_point)));
        }
        let series = Self::read(
            session.folder.open(record, RECORD)?,
            columns.record_lines,
            &columns.time,
            &columns.f,
            window,
            progress,
        )?;
        Ok((series, PlateauName::of(session, set_point)))
    }
}

/// Unit of the values of a column as read: m/s^2, or the file's own unit where nothing takes its numbers to SI.
fn si_unit(column: &Column) -> String {
    let is_raw = column.scale == Scale::factor(1.0) && Dimension::Acceleration.factor(&column.unit).is_none();
    if is_raw { column.unit.clone() } else { "m/s^2".to_owned() }
}
