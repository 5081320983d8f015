//! The errors of the readings as tables.

use centrical_session::{CalibrationResult, MICRO_G};
use nalgebra::Vector3;

use super::content::{Align, Row, Table};
use super::tables::axis_titles;
use crate::evaluation::{ReadingError, reading_errors};
use crate::language::Language;

/// What is shown of an error: along each axis root mean square and largest magnitude.
type Size = [(f64, f64); 3];

/// The row of errors before compensation, unless the nominal values of a raw output were found so as to make them small.
fn as_received<T>(before: T, result: &CalibrationResult) -> Option<T> {
    (!result.model.nominal_found).then_some(before)
}

/// Before, after (on an arm without the plateau's speed error), and the expanded uncertainty of compensation: the root mean square of
/// each axis. None if the unit cannot be compensated.
pub(super) fn headline_table(result: &CalibrationResult, language: Language) -> Option<Table> {
    let [before, after, speed_free, uncertainty] = sizes(result, language)?;
    let after = if result.model.has_arm() { speed_free } else { after };
    let rows = as_received(before, result).into_iter().chain([after, uncertainty]);
    let rows = rows.map(|(name, size)| Row::Cells(cells(name, size.map(|(rms, _)| rms), language)));
    Some(table(rows.collect(), language))
}

/// Before, after, on an arm also without the plateau's speed error, and the expanded uncertainty of compensation: root mean squares,
/// then largest magnitudes. None if the unit cannot be compensated.
pub(super) fn error_table(result: &CalibrationResult, language: Language) -> Option<Table> {
    let messages = language.messages();
    let [before, after, speed_free, uncertainty] = sizes(result, language)?;
    let speed_free = result.model.has_arm().then_some(speed_free);
    let sizes: Vec<_> =
        as_received(before, result).into_iter().chain([after]).chain(speed_free).chain([uncertainty]).collect();
    let part = |heading: &str, of: fn((f64, f64)) -> f64| {
        let rows = sizes.iter().map(|(name, size)| Row::Cells(cells(name, size.map(of), language)));
        std::iter::once(Row::Group(heading.to_owned())).chain(rows).collect::<Vec<_>>()
    };
    let rows = [part(messages.root_mean_square, |(rms, _)| rms), part(messages.largest, |(_, largest)| largest)];
    Some(table(rows.concat(), language))
}

/// What [`error_table`] shows.
pub(super) fn error_note(result: &CalibrationResult, language: Language) -> &'static str {
    let messages = language.messages();
    if result.model.has_arm() { messages.residual_error_note } else { messages.residual_error_note_of_rests }
}

fn table(rows: Vec<Row>, language: Language) -> Table {
    let messages = language.messages();
    let [axis_1, axis_2, axis_3] = axis_titles(language);
    let columns = [
        ("", 0.43, Align::Left),
        (messages.unit, 0.12, Align::Left),
        (&axis_1, 0.15, Align::Right),
        (&axis_2, 0.15, Align::Right),
        (&axis_3, 0.15, Align::Right),
    ];
    Table { rows, ..Table::numbers(columns, []) }
}

/// A row in one unit: that in which its largest number is below a thousand.
fn cells(name: &str, values: [f64; 3], language: Language) -> Vec<String> {
    let largest = values.into_iter().fold(0.0, f64::max);
    let (size, unit) = if largest < 1e3 * MICRO_G { (MICRO_G, "ug") } else { (1e3 * MICRO_G, "mg") };
    // To three digits of the largest, so that the numbers of a row end at one place.
    let places = if largest / size >= 100.0 {
        0
    } else if largest / size >= 10.0 {
        1
    } else {
        2
    };
    let numbers = values.map(|value| language.fixed(value / size, places));
    [name.to_owned(), language.unit(unit)].into_iter().chain(numbers).collect()
}

fn sizes(result: &CalibrationResult, language: Language) -> Option<[(&'static str, Size); 4]> {
    let messages = language.messages();
    let errors = &reading_errors(result)?;
    Some([
        (messages.before, size(errors, |e| e.before)),
        (messages.after, size(errors, |e| e.after)),
        (messages.after_speed_free, size(errors, |e| e.speed_free)),
        (messages.compensation_uncertainty, size(errors, |e| e.expanded_prediction)),
    ])
}

/// Root mean square and largest magnitude along each axis.
fn size(errors: &[ReadingError], of: impl Fn(&ReadingError) -> Vector3<f64>) -> Size {
    let count = errors.len().max(1) as f64;
    [0, 1, 2].map(|axis| {
        let values = || errors.iter().map(|error| of(error)[axis]);
        let square: f64 = values().map(|value| value * value).sum();
        ((square / count).sqrt(), values().map(f64::abs).fold(0.0, f64::max))
    })
}
