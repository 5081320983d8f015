//! From a record of readings to a record of specific forces, in memory that does not grow with it.

use std::path::{Path, PathBuf};

use centrical::reduction::RecordSlice;
use centrical_compensate::{Certificate, Compensation};
use centrical_table::Rows;
use rayon::prelude::*;

use crate::document::CalibrationResult;
use crate::error::{Error, Place};
use crate::experiment::Session;
use crate::record::{Columns, RecordReader, stretch};
use crate::record_writer::RecordWriter;

/// What became of a record.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Compensated {
    /// Readings.
    pub readings: u64,
    /// Of these, readings that no specific force within the range gives; they are written as NaN.
    pub outside: u64,
    /// The first of those.
    pub first_outside: Option<FirstOutside>,
    /// Decimals of the specific forces as they are written [m/s^2], if they are rounded.
    pub decimals: Option<u32>,
}

/// A reading from out of range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstOutside {
    /// Its time [s].
    pub t: f64,
    /// The reading [m/s^2].
    pub reading: [f64; 3],
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
    /// The session that says columns and units of the record.
    pub session: Option<PathBuf>,
    /// Largest specific force on each axis [m/s^2]; `None` for what the calibration allows.
    pub range: Option<f64>,
}

/// Compensates a record by the result of a calibration, and says where the inverse is unique.
///
/// # Errors
/// As [`compensate_record`]; and if the result has no error model that can be inverted.
pub fn compensate(request: &CompensationRequest) -> Result<(Compensated, Certificate), Error> {
    let result = CalibrationResult::read(&request.result)?;
    let file = || request.result.clone();
    let terms = result.error_terms().map_err(|source| Error::ErrorModel { file: file(), source })?;
    let compensation = (request.range.map_or_else(|| result.compensation_range(&terms), Ok))
        .and_then(|range| Compensation::new(&terms, range))
        .map_err(|source| Error::NotInvertible { file: file(), source })?;
    let columns = match &request.session {
        Some(session) => Session::read(session)?.columns,
        None => Columns::default(),
    };
    let compensated = compensate_record(&compensation, &request.record, &columns, &request.out)?;
    Ok((compensated, *compensation.certificate()))
}

/// Compensates the record in `input` into `output`, CSV or Parquet by its name. The same bytes on any machine.
///
/// Time is written as it was read, to the bit. So are specific forces as Parquet has them; as CSV has them, they are rounded to at
/// most `10^-12` of the range ([`RecordWriter::create_rounded`]).
///
/// # Errors
/// As [`RecordReader`] for `input` and [`RecordWriter`] for `output`, which is not touched then.
pub fn compensate_record(
    compensation: &Compensation,
    input: &Path,
    columns: &Columns,
    output: &Path,
) -> Result<Compensated, Error> {
    // On a thread of those that share the work: another one would be waited for, batch by batch.
    rayon::scope(|_| on_this_thread(compensation, input, columns, output))
}

fn on_this_thread(
    compensation: &Compensation,
    input: &Path,
    columns: &Columns,
    output: &Path,
) -> Result<Compensated, Error> {
    let mut writer = RecordWriter::create_rounded(output, compensation.certificate().range)?;
    let mut sum = Compensated { decimals: writer.decimals(), ..Compensated::default() };
    let mut record = RecordReader::open(input, columns)?;
    while let Some(batch) = record.next_batch()? {
        let compensated = batch.par_iter_mut().map(|rows| compensate_rows(compensation, input, rows));
        for rows in compensated.collect::<Vec<_>>() {
            sum.add(&rows?);
        }
        let stretches: Vec<RecordSlice> = batch.iter().map(stretch).collect();
        writer.write_all(&stretches)?;
    }
    writer.finish()?;
    Ok(sum)
}

/// Compensates readings in place.
fn compensate_rows(compensation: &Compensation, input: &Path, rows: &mut Rows) -> Result<Compensated, Error> {
    let [t, f @ ..] = rows.as_mut_slice() else { return Ok(Compensated::default()) };
    let readings = f.to_vec();
    let mut columns = f.iter_mut();
    let f = [(); 3].map(|()| columns.next().map_or_else(Default::default, Vec::as_mut_slice));
    let outside = compensation
        .apply_all(f)
        .map_err(|unequal| Error::content(input, Place::Whole, unequal.to_string(), "columns of equal length"))?;
    let reading = |k: usize| [0, 1, 2].map(|axis: usize| readings[axis][k]);
    Ok(Compensated {
        readings: t.len() as u64,
        outside: outside.count as u64,
        first_outside: outside.first.map(|k| FirstOutside { t: t[k], reading: reading(k) }),
        decimals: None,
    })
}

impl Compensated {
    /// What became of these readings and of later ones.
    fn add(&mut self, later: &Self) {
        self.readings += later.readings;
        self.outside += later.outside;
        self.first_outside = self.first_outside.or(later.first_outside);
    }
}
