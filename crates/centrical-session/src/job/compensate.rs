//! From a record of readings to a record of specific forces, in memory that does not grow with it.

use std::path::{Path, PathBuf};

use centrical::reduction::RecordSlice;
use centrical::{OnProgress, advance};
use centrical_compensate::{Certificate, Compensation, Outside, Term, UnequalLengths};
use centrical_table::{Rows, Stamps};
use rayon::prelude::*;

use super::axes::Axes;
use crate::document::{
    COMPENSATION_SCHEMA, CalibrationResult, CompensationReport, FirstReading, OutputSummary, Program, ReadingsBeyond,
    ResultObjection,
};
use crate::error::{Error, Place};
use crate::experiment::{Session, refuse_inputs};
use crate::record::RecordWriter;
use crate::record::{Columns, RecordReader, stretch};

/// What became of a record.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CompensatedRecord {
    /// Unit in which the readings were taken.
    pub unit: String,
    /// Readings.
    pub readings: u64,
    /// Of these, readings that no specific force within the range gives; they are written as NaN.
    pub outside: ReadingsBeyond,
    /// Readings beyond the calibrated range: the error model is extrapolated there.
    pub beyond: ReadingsBeyond,
    /// Decimals of the specific forces as they are written [m/s^2], if they are rounded.
    pub decimals: Option<u32>,
}

/// What is compensated, and how far.
#[derive(Debug, Clone, PartialEq)]
pub struct CompensationRequest {
    /// The result of a calibration.
    pub result: PathBuf,
    /// The record.
    pub record: PathBuf,
    /// File for the specific forces.
    pub out: PathBuf,
    /// The session that says columns and units of the record; if none, readings are in the unit of the calibration's records.
    pub session: Option<PathBuf>,
    /// Largest specific force on each axis [m/s^2]; `None` for what the calibration allows.
    pub range: Option<f64>,
    /// Whether a reading beyond the calibrated range is an error.
    pub within_calibration: bool,
    /// Axes of the specific forces; those of the result if none.
    pub axes: Option<Axes>,
}

/// Where readings are those of the calibration.
#[derive(Debug, Clone, Copy)]
struct Calibrated {
    /// Largest reading on each axis [m/s^2].
    limit: [f64; 3],
    /// Whether one beyond it is refused.
    is_demanded: bool,
}

impl Calibrated {
    /// No limit.
    const ANYWHERE: Self = Self { limit: [f64::INFINITY; 3], is_demanded: false };
}

/// Compensates a record by the result of a calibration, and says where the inverse is unique, and what objections there are to the result.
/// `progress` is called with the number of bytes read.
///
/// # Errors
/// As [`compensate_record`]; if the result has no error model that can be inverted; and if the session is of another unit.
pub fn compensate(
    request: &CompensationRequest,
    progress: OnProgress,
) -> Result<(CompensatedRecord, Certificate, Vec<ResultObjection>), Error> {
    let result = CalibrationResult::read(&request.result)?;
    let result = match &request.axes {
        Some(axes) => axes.of(result, &request.result)?,
        None => result,
    };
    let compensation = result.compensation(&request.result, request.range)?;
    let mut inputs = vec![request.result.clone(), request.record.clone()];
    let columns = match &request.session {
        Some(session) => {
            let session = Session::read(session)?;
            if session.mountings.iter().any(|files| files.records.len() > 1) {
                let expected = "a session whose records have the readings of all newtonometers in one file, as the record to \
                                be compensated has them";
                return Err(Error::content(&session.file, Place::Whole, "one file for each newtonometer", expected));
            }
            refuse_another(&session, &result, &request.result)?;
            inputs.extend(session.files().into_iter().map(Path::to_owned));
            session.columns
        }
        None => result.output.as_ref().map_or_else(Columns::default, OutputSummary::columns),
    };
    refuse_inputs(std::slice::from_ref(&request.out), &inputs)?;
    let calibrated = Calibrated { limit: result.calibrated_readings(), is_demanded: request.within_calibration };
    // On a thread of those that share the work: another one would be waited for, batch by batch.
    let compensated = rayon::scope(|_| {
        on_this_thread(&compensation, &calibrated, &request.record, &columns, &request.out, progress)
    })?;
    Ok((compensated, *compensation.certificate(), result.objections()))
}

/// Refuses a session of another unit than that of the result in `file`, or with another nominal output in counts or volts.
fn refuse_another(session: &Session, result: &CalibrationResult, file: &Path) -> Result<(), Error> {
    let refuse = |found: String, expected: String| {
        Err(Error::content(&session.file, Place::Whole, found, format!("{expected}, as in {}", file.display())))
    };
    let names = [
        ("model", &session.unit_model, &result.session.unit_model),
        ("serial number", &session.unit_serial, &result.session.unit_serial),
    ];
    let other = names.into_iter().find(|(_, own, of)| !own.is_empty() && !of.is_empty() && own != of);
    if let Some((what, own, of)) = other {
        return refuse(format!("a unit of the {what} {own:?}"), format!("{of:?}"));
    }
    // The coefficients are relative to the nominal output. All units of acceleration are one.
    let own = OutputSummary::of(session).filter(OutputSummary::is_raw);
    let nominal = |output: Option<&OutputSummary>| match output {
        Some(output) => format!("{} of scale {:?} and bias {:?}", output.unit, output.scale, output.bias),
        None => "output in a unit of acceleration".to_owned(),
    };
    if own.as_ref() == result.raw_output() {
        return Ok(());
    }
    refuse(nominal(own.as_ref()), nominal(result.raw_output()))
}

/// Compensates the record in `input` into `output`, CSV or Parquet by its name. The same bytes on any machine.
///
/// Time is written as it was read: a number to the bit, a stamp as a stamp ([`RecordWriter::write_stamped`]). So are specific forces as
/// Parquet has them; as CSV has them, they are rounded to at most `10^-12` of the range ([`RecordWriter::create_rounded`]).
///
/// # Errors
/// As [`RecordReader`] for `input` and [`RecordWriter`] for `output`, which is not touched then; [`Error::Stopped`].
pub fn compensate_record(
    compensation: &Compensation<impl AsRef<[Term]> + Sync>,
    input: &Path,
    columns: &Columns,
    output: &Path,
    progress: OnProgress,
) -> Result<CompensatedRecord, Error> {
    rayon::scope(|_| on_this_thread(compensation, &Calibrated::ANYWHERE, input, columns, output, progress))
}

fn on_this_thread(
    compensation: &Compensation<impl AsRef<[Term]> + Sync>,
    calibrated: &Calibrated,
    input: &Path,
    columns: &Columns,
    output: &Path,
    progress: OnProgress,
) -> Result<CompensatedRecord, Error> {
    let mut record = RecordReader::open(input, columns)?;
    record.keep_stamps();
    let mut writer = RecordWriter::create_rounded(output, compensation.certificate().range)?;
    let unit = columns.f[0].unit.clone();
    let mut sum = CompensatedRecord { unit, decimals: writer.decimals(), ..CompensatedRecord::default() };
    while record.next_batch()?.is_some() {
        let mut stamps = record.take_stamps();
        for (rows, stamps) in record.batch().iter_mut().zip(&mut stamps) {
            columns.missing_readings.leave_out_stamped(rows, stamps);
        }
        let compensated =
            record.batch().par_iter_mut().map(|rows| compensate_rows(compensation, calibrated, input, rows));
        for rows in compensated.collect::<Vec<_>>() {
            sum.add(&rows?);
        }
        if let Some(first) = sum.beyond.first.filter(|_| calibrated.is_demanded) {
            let found = format!("{:?} m/s^2 at t = {} s", first.reading, first.t);
            let expected = format!("readings within the calibration, {:.1?} m/s^2", calibrated.limit);
            return Err(Error::content(input, Place::Whole, found, expected));
        }
        let stretches: Vec<RecordSlice> = record.batch().iter().map(stretch).collect();
        if stamps.iter().all(Stamps::is_empty) {
            writer.write_all(&stretches)?;
        } else {
            stretches.iter().zip(&stamps).try_for_each(|(rows, stamps)| writer.write_stamped(stamps, *rows))?;
        }
        advance(progress, record.newly_read())?;
    }
    writer.finish()?;
    Ok(sum)
}

/// Compensates readings in place.
fn compensate_rows(
    compensation: &Compensation<impl AsRef<[Term]> + Sync>,
    calibrated: &Calibrated,
    input: &Path,
    rows: &mut Rows,
) -> Result<CompensatedRecord, Error> {
    let [t, f @ ..] = rows.as_mut_slice() else { return Ok(CompensatedRecord::default()) };
    let readings = f.to_vec();
    let mut columns = f.iter_mut();
    let f = [(); 3].map(|()| columns.next().map_or_else(Default::default, Vec::as_mut_slice));
    let unequal =
        |unequal: UnequalLengths| Error::content(input, Place::Whole, unequal.to_string(), "columns of equal length");
    let beyond = Outside::beyond(calibrated.limit, f.each_ref().map(|f| &**f)).map_err(unequal)?;
    let outside = compensation.apply_all(f).map_err(unequal)?;
    let first = |k: usize| FirstReading { t: t[k], reading: [0, 1, 2].map(|axis: usize| readings[axis][k]) };
    let [outside, beyond] =
        [outside, beyond].map(|found| ReadingsBeyond { count: found.count as u64, first: found.first.map(first) });
    Ok(CompensatedRecord { readings: t.len() as u64, outside, beyond, ..CompensatedRecord::default() })
}

impl CompensatedRecord {
    /// What became of the record of `request`, as a JSON document.
    pub fn report(
        &self,
        request: &CompensationRequest,
        certificate: &Certificate,
        objections: &[ResultObjection],
    ) -> CompensationReport {
        let [result, record, out] =
            [&request.result, &request.record, &request.out].map(|file| file.display().to_string());
        let largest = certificate.margin * certificate.range;
        CompensationReport {
            schema: COMPENSATION_SCHEMA,
            program: Program::this(),
            result,
            record,
            out,
            acceptable: objections.is_empty(),
            objections: objections.iter().map(Into::into).collect(),
            unit: self.unit.clone(),
            decimals: self.decimals,
            readings: self.readings,
            range: certificate.range,
            largest_range: largest.is_finite().then_some(largest),
            outside_range: self.outside,
            beyond_calibration: self.beyond,
        }
    }

    /// What became of these readings and of later ones.
    fn add(&mut self, later: &Self) {
        self.readings += later.readings;
        self.outside.add(later.outside);
        self.beyond.add(later.beyond);
    }
}
