//! From records of a unit that was turned by hand to its calibration.

use std::path::Path;

use centrical::reduction::{CoarseScale, Record, RestRecord, Rests};
use centrical::{OnProgress, advance};
use centrical_table::{TableLines, refuse_inputs, write_whole};
use nalgebra::Vector3;

use super::plausible::{answers, first, has_unit, turns};
use super::request::TumbleRequest;
use super::session_text::{ATTITUDES, TABLE, session_text};
use crate::document::{CalibrationResult, Method};
use crate::error::{Error, Place};
use crate::experiment::{
    EXPERIMENT_FILE, Folder, RestSource, Session, refuse_another_session, write_attitudes, write_plateaus,
};
use crate::job::calibrate::calibrate_reduced;
use crate::job::noise::Series;
use crate::job::reduce::{find_rests, refuse_repeated_rests};
use crate::quantity::Dimension;
use crate::record::{EqualColumns, Input, RECORD, Scale, named_columns};
use crate::reduced::{Reduced, ReducedPlateau, rest_rows};

/// A calibration by rests.
#[derive(Debug, Clone, PartialEq)]
pub struct Tumble {
    /// The rests as a session.
    pub session: Session,
    /// The text of its experiment file.
    pub text: String,
    /// The means of the rests.
    pub reduced: Reduced,
    /// What follows from them.
    pub result: CalibrationResult,
}

/// Finds the rests of the records, averages each, and calibrates the unit by them: gravity has the same size in all. The text of
/// the session is that of a file in `folder`. `progress` is called with the number of bytes read.
///
/// # Errors
/// [`Error`] naming the file, the place, what was found and what was expected; [`Error::Stopped`].
pub fn tumble(request: &TumbleRequest, folder: &Path, progress: OnProgress) -> Result<Tumble, Error> {
    let mut records = Vec::with_capacity(request.files.len());
    for file in &request.files {
        let record = record(request, file, progress)?;
        answers(request, &record, file)?;
        records.push(record);
    }
    let mut rests = found(request, &records, progress)?;
    advance(progress, 0)?;
    let coarse = if Dimension::Acceleration.factor(&request.unit).is_some() {
        None
    } else {
        let coarse = coarse(request, &rests)?;
        for record in &mut records {
            in_si(record, &coarse);
        }
        rests = found(request, &records, progress)?;
        Some(coarse)
    };
    let means = means(&rests);
    if request.attitudes.is_none() {
        turns(request, &means)?;
    }
    if coarse.is_none() {
        has_unit(request, &rests)?;
    }
    let known = (request.attitudes.as_ref()).map(|stated| stated.of_rests(&means, &first(request))).transpose()?;
    let text = session_text(request, coarse.as_ref(), &rests);
    let plateaus: Vec<ReducedPlateau> = rests.means.into_iter().flatten().map(ReducedPlateau::from).collect();
    let mut reduced = Reduced { plateaus, ..Reduced::of_table(&[]) };
    let input = |file: &Path| {
        let source = request.folder.open(file, Input::EXPECTED)?;
        Input::of(file.parent().unwrap_or(Path::new("")), &source, progress)
    };
    let inputs = request.inputs().map(input);
    reduced.inputs = inputs.collect::<Result<_, _>>()?;
    refuse_twice(request, &reduced.inputs)?;
    let session = Session::parse_with(&text, &folder.join(EXPERIMENT_FILE), Folder::at(folder), |table, _| {
        table.means = rest_rows(&reduced.plateaus);
        if let (Some(table), Some(known)) = (&mut table.attitudes, &known) {
            table.up_b.clone_from(known);
        }
        Ok(())
    })?;
    refuse_repeated_rests(&session, &reduced, request.files.last().unwrap_or(&session.file))?;
    let result = calibrate_reduced(&blaming_record(&session, request), &reduced, Method::Exact, progress)?;
    Ok(Tumble { session, text, reduced, result })
}

impl Tumble {
    /// Writes the rests as a session into `folder`, which is there, and the result beside.
    ///
    /// # Errors
    /// If the folder holds a session with records or of another unit, or does not take the files, or one of them was read.
    pub fn write(&self, request: &TumbleRequest, folder: &Path) -> Result<(), Error> {
        refuse_another_session(folder, &self.session)?;
        let names = [TABLE, ATTITUDES, EXPERIMENT_FILE, "result.json"];
        let outputs @ [table, attitudes, experiment, result] = &names.map(|name| folder.join(name));
        refuse_inputs(outputs, &request.inputs().collect::<Vec<_>>())?;
        write_plateaus(table, &rest_rows(&self.reduced.plateaus))?;
        for known in self.session.rest_tables.iter().filter_map(|table| table.attitudes.as_ref()) {
            write_attitudes(attitudes, &known.up_b)?;
        }
        write_whole(experiment, self.text.as_bytes())?;
        self.result.write(result)
    }
}

/// The session with the record as its file in messages: its own files are still to be written.
fn blaming_record(session: &Session, request: &TumbleRequest) -> Session {
    let mut blaming = session.clone();
    blaming.file = first(request);
    for table in &mut blaming.rest_tables {
        table.source = RestSource::Table(first(request));
    }
    blaming
}

/// Refuses a record that is given twice: its noise would count for half.
fn refuse_twice(request: &TumbleRequest, inputs: &[Input]) -> Result<(), Error> {
    let records = || request.files.iter().zip(inputs);
    for (n, (file, input)) in records().enumerate() {
        if let Some((before, _)) = records().take(n).find(|(_, before)| before.sha256 == input.sha256) {
            let found = format!("the same bytes as in {}", before.display());
            return Err(Error::content(file, Place::Whole, found, "every record once"));
        }
    }
    Ok(())
}

/// A record as it is, in m/s^2 where its unit is one of acceleration.
fn record(request: &TumbleRequest, file: &Path, progress: OnProgress) -> Result<Record, Error> {
    let (time, readings) = named_columns(&request.time, request.rate, &request.readings, &request.unit);
    let everything = [f64::NEG_INFINITY, f64::INFINITY];
    let series = Series::read(
        request.folder.open(file, RECORD)?,
        TableLines::default(),
        &time,
        &readings,
        everything,
        progress,
    )?;
    let mut columns = series.columns.into_iter().map(|(_, _, values)| values);
    let record = Record { t: series.t, f_z: std::array::from_fn(|_| columns.next().unwrap_or_default()) };
    let mut equal = EqualColumns::of(request.readings.each_ref().map(ToString::to_string));
    equal.see(record.as_slice().f_z);
    equal.refuse(file)?;
    Ok(record)
}

/// The rests of the records, and the arcs if they count.
fn found(request: &TumbleRequest, records: &[Record], progress: OnProgress) -> Result<Rests, Error> {
    let turning_radius = request.turning_radius;
    let records: Vec<RestRecord> =
        records.iter().map(|record| RestRecord { samples: record.as_slice(), turning_radius }).collect();
    find_rests(&records, &first(request), progress)
}

/// The mean readings of the rests of all records.
fn means(rests: &Rests) -> Vec<Vector3<f64>> {
    rests.means.iter().flatten().map(|rest| rest.mean).collect()
}

/// The coarse scale and bias of readings in counts or volts.
fn coarse(request: &TumbleRequest, rests: &Rests) -> Result<CoarseScale, Error> {
    let means = means(rests);
    CoarseScale::of(&means, request.gravity).ok_or_else(|| {
        let found = format!("{} rests that do not show scale and bias of {}", means.len(), request.unit);
        let expected = "rests with each axis about up and about down, six at least";
        Error::content(&first(request), Place::Whole, found, expected)
    })
}

fn in_si(record: &mut Record, CoarseScale { scale, bias }: &CoarseScale) {
    for (axis, values) in record.f_z.iter_mut().enumerate() {
        Scale { offset: bias[axis], factor: 1.0 / scale[axis] }.apply(values);
    }
}
