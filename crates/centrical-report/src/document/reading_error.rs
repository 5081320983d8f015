//! The errors of the readings as a table.

use centrical_session::{CalibrationResult, MICRO_G};
use nalgebra::Vector3;

use super::content::{Align, Table};
use crate::evaluation::{ReadingError, expanded_of_normal, reading_errors};
use crate::language::Language;

/// Before, after, after less the speed's error, and the expanded uncertainty of compensation: for each axis root mean
/// square and, in brackets, largest magnitude. None if the unit cannot be compensated.
pub(super) fn error_table(result: &CalibrationResult, language: Language) -> Option<Table> {
    let messages = language.messages();
    let errors = &reading_errors(result)?;
    let shown = |(rms, largest): (f64, f64)| {
        let (factor, unit) = if rms < 1e3 * MICRO_G { (1.0 / MICRO_G, "ug") } else { (1e-3 / MICRO_G, "mg") };
        let [rms, largest] = [rms, largest].map(|value| language.significant(value * factor, 3));
        format!("{rms} ({largest}) {}", language.unit(unit))
    };
    let rows = [
        (messages.before, size(errors, |e| e.before).map(shown)),
        (messages.after, size(errors, |e| e.after).map(shown)),
        (messages.after_speed_free, size(errors, |e| e.speed_free).map(shown)),
        (messages.compensation_uncertainty, size(errors, |e| e.prediction.map(expanded_of_normal)).map(shown)),
    ];
    let rows = rows.map(|(name, cells)| std::iter::once(name.to_owned()).chain(cells).collect());
    let [axis_1, axis_2, axis_3] = [1, 2, 3].map(|axis| format!("{} {axis}", messages.axis));
    let columns = [
        ("", 0.34, Align::Left),
        (&axis_1, 0.22, Align::Right),
        (&axis_2, 0.22, Align::Right),
        (&axis_3, 0.22, Align::Right),
    ];
    Some(Table::numbers(columns, rows))
}

/// Root mean square and largest magnitude along each axis.
fn size(errors: &[ReadingError], of: impl Fn(&ReadingError) -> Vector3<f64>) -> [(f64, f64); 3] {
    let count = errors.len().max(1) as f64;
    [0, 1, 2].map(|axis| {
        let values = || errors.iter().map(|error| of(error)[axis]);
        let square: f64 = values().map(|value| value * value).sum();
        ((square / count).sqrt(), values().map(f64::abs).fold(0.0, f64::max))
    })
}
