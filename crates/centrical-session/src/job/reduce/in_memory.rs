//! Records that are in memory: the same reduction, without files.

use std::mem::take;

use centrical::reduction::{PulseTrain, Record, ReducedMounting, SpeedTrace, Survey};
use centrical::{OnProgress, advance};
use rayon::prelude::*;

use super::mounting::{OfRecord, ShownSpeeds, located};
use crate::error::{Error, Place};
use crate::experiment::{Session, TomlPath};
use crate::record::{Column, LEFT_OUT, MissingReadings, TimeSpan};

/// What was recorded of one mounting, in the units of the session's columns.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Recorded {
    /// The record: time, and the output of newtonometers 1, 2, 3.
    pub record: Record,
    /// The telemetry: time and speed.
    pub telemetry: Option<SpeedTrace>,
    /// Times of the pulses of an index mark or an encoder.
    pub pulses: Option<Vec<f64>>,
}

/// Reduces the mountings of a session, one of `recorded` for each. `progress` is called with the number of mountings reduced.
///
/// # Errors
/// [`Error`] naming the mounting, what was found and what was expected; [`Error::Stopped`].
pub(super) fn reduce_mountings(
    session: &Session,
    recorded: Vec<Recorded>,
    progress: OnProgress<usize>,
) -> Result<Vec<OfRecord>, Error> {
    let (found, expected) = (recorded.len(), session.mountings.len());
    if found != expected {
        let expected = format!("{expected}, one for each mounting");
        return Err(Error::content(&session.file, Place::Whole, format!("{found} records in memory"), expected));
    }
    let mountings = recorded.into_par_iter().enumerate().map(|(number, recorded)| {
        advance(progress, 0)?;
        let reduced = reduce_mounting(session, number, recorded, progress)?;
        advance(progress, 1)?;
        Ok(reduced)
    });
    // Which error is the first does not depend on the threads.
    let mountings: Vec<Result<OfRecord, Error>> = mountings.collect();
    mountings.into_iter().collect()
}

fn reduce_mounting(
    session: &Session,
    number: usize,
    recorded: Recorded,
    progress: OnProgress<usize>,
) -> Result<OfRecord, Error> {
    let Recorded { record, telemetry, pulses } = in_si(session, number, recorded)?;
    let refused = |source| Error::reduction(&session.file, number, source);
    let survey = Survey::of(record.as_slice()).map_err(refused)?.with_resolution(session.type_b.resolution);
    advance(progress, 0)?;
    let counted = pulses.filter(|_| session.speeds.counts_pulses());
    let pulses = counted.map(|t| PulseTrain { t, per_revolution: session.pulses_per_revolution() });
    let located = located(session, number, &session.file, &survey, &ShownSpeeds { telemetry, pulses })?;
    let means = (0..located.windows().len()).map(|plateau| {
        advance(progress, 0)?;
        located.average(plateau, record.as_slice()).map_err(refused)
    });
    let means = means.collect::<Result<_, _>>()?;
    Ok(OfRecord::new(number, &survey, ReducedMounting::new(located, means), None))
}

/// The numbers of the columns in SI.
fn in_si(session: &Session, number: usize, recorded: Recorded) -> Result<Recorded, Error> {
    let Recorded { mut record, mut telemetry, mut pulses } = recorded;
    let columns = &session.columns;
    let times_in_si = |key: &str, column: &Column, times: &mut [f64]| {
        column.scale.apply(times);
        let mut span = TimeSpan::EMPTY;
        span.see(times);
        span.refuse_years(&session.file, TomlPath::entry(&session.file, "mounting", number).key(key))
    };
    times_in_si("record", &columns.time, &mut record.t)?;
    record.f_z.iter_mut().zip(&columns.f).for_each(|(values, column)| column.scale.apply(values));
    if let Some(SpeedTrace { t, omega }) = &mut telemetry {
        times_in_si("telemetry", &columns.telemetry_time, t)?;
        columns.speed.scale.apply(omega);
    }
    if let Some(times) = &mut pulses {
        times_in_si("pulses", &columns.pulse, times)?;
    }
    leave_out_missing(session, number, &mut record)?;
    Ok(Recorded { record, telemetry, pulses })
}

/// Leaves out the samples that lack a reading, or refuses the record, as that of a file.
fn leave_out_missing(session: &Session, number: usize, record: &mut Record) -> Result<(), Error> {
    let missing = |j: usize| record.f_z[j].iter().position(|f| f.is_nan()).map(|sample| (sample, j));
    // Columns of different lengths are refused later.
    let Some((sample, j)) =
        (0..3).filter_map(missing).min().filter(|_| record.f_z.iter().all(|f| f.len() == record.t.len()))
    else {
        return Ok(());
    };
    let columns = &session.columns;
    if columns.missing_readings == MissingReadings::Refused {
        let place = TomlPath::entry(&session.file, "mounting", number).key("record");
        let found = format!("no reading f{} in sample {}", j + 1, sample + 1);
        let expected = format!("a number in {}, or {LEFT_OUT}", columns.f[j].unit);
        return Err(Error::content(&session.file, place, found, expected));
    }
    let [f1, f2, f3] = &mut record.f_z;
    let mut rows = vec![take(&mut record.t), take(f1), take(f2), take(f3)];
    columns.missing_readings.leave_out(&mut rows);
    for (column, whole) in std::iter::once(&mut record.t).chain(&mut record.f_z).zip(rows) {
        *column = whole;
    }
    Ok(())
}
