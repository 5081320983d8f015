//! `Session.from_arrays`: a session whose records, or whose plateaus, are arrays.

use centrical_session::{
    Method, PlateauName, PlateauTable, Record, Recorded, Reduced, Session, SpeedTrace, calibrate_reduced,
    reduce_recorded, reduce_without_inputs,
};
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;

use crate::given::GivenSession;
use crate::progress::{self, Shown, Work};
use crate::result::CalibrationResult;
use crate::words;

type Column<'py> = PyReadonlyArray1<'py, f64>;

/// Time, readings of newtonometers 1, 2, 3, time and speed of the telemetry, times of pulses.
type OfMounting<'py> = (Column<'py>, [Column<'py>; 3], Option<[Column<'py>; 2]>, Option<Column<'py>>);

/// Where the numbers of a session come from.
enum Origin {
    Records(Vec<Recorded>),
    Plateaus(Vec<Vec<f64>>),
}

/// The result of a session whose numbers are arrays: of its records or, if they are given, of its plateaus.
#[pyfunction]
pub fn calibrate_arrays(
    py: Python,
    session: GivenSession,
    records: Vec<OfMounting>,
    plateaus: Option<Vec<Column>>,
    method: &str,
    hold_out: Vec<String>,
    shown: Shown,
) -> PyResult<CalibrationResult> {
    let (method, hold_out) = (words::method(method)?, words::plateaus("hold_out", &hold_out)?);
    let origin = match plateaus {
        Some(columns) => Origin::Plateaus(columns.iter().map(numbers).collect()),
        None => Origin::Records(records.iter().map(recorded).collect()),
    };
    let result = progress::run(py, &shown, |work| calibrated(session.read()?, origin, method, &hold_out, work))?;
    Ok(result.into())
}

/// Names of the columns of a table of plateaus; the last may be absent.
#[pyfunction]
pub fn plateau_columns() -> Vec<&'static str> {
    PlateauTable::columns().collect()
}

fn calibrated(
    session: Session,
    origin: Origin,
    method: Method,
    hold_out: &[PlateauName],
    work: &Work,
) -> Result<centrical_session::CalibrationResult, centrical_session::Error> {
    let fitted = |session: &Session, mut reduced: Reduced| {
        reduced.held_out = hold_out.iter().map(|name| name.set_point(session)).collect::<Result<_, _>>()?;
        calibrate_reduced(session, &reduced, method, &|bytes| work.advance(bytes))
    };
    match origin {
        Origin::Plateaus(columns) => {
            let session = session.with_plateaus(&columns)?;
            let (session, reduced) = reduce_without_inputs(&session, &|bytes| work.advance(bytes))?;
            fitted(&session, reduced)
        }
        Origin::Records(recorded) => {
            work.expect(recorded.len() as u64);
            let (session, reduced) = reduce_recorded(&session, recorded, &|count| work.count(count))?;
            fitted(&session, reduced)
        }
    }
}

fn recorded((t, f, telemetry, pulses): &OfMounting) -> Recorded {
    let trace = |[t, omega]: &[Column; 2]| SpeedTrace { t: numbers(t), omega: numbers(omega) };
    Recorded {
        record: Record { t: numbers(t), f_z: f.each_ref().map(numbers) },
        telemetry: telemetry.as_ref().map(trace),
        pulses: pulses.as_ref().map(numbers),
    }
}

/// The numbers of a column, with any stride; they are converted to SI in place.
fn numbers(column: &Column) -> Vec<f64> {
    column.as_array().to_vec()
}
