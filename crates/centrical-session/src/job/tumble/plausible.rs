//! What makes a record of rests worth nothing, found before a fit would say so in its own way: a newtonometer that does not answer, a unit that
//! is not the one stated, attitudes that leave an axis out.

use std::path::{Path, PathBuf};

use centrical::reduction::{Record, Rests};
use nalgebra::Vector3;

use super::request::TumbleRequest;
use crate::error::{Error, Place};
use crate::job::reduce::{is_of_gravity, mean_size};
use crate::quantity::Dimension;

/// Least part of the size of the rests through which each newtonometer is turned: half of its range, as by a turn of 6 deg. With less
/// its scale is its bias, and the fit goes astray.
const LEAST_TURN: f64 = 0.1;

/// Units that readings are mistaken for.
const UNITS: [&str; 3] = ["m/s^2", "g", "mg"];

/// # Errors
/// If a newtonometer gives one reading throughout.
pub(super) fn answers(request: &TumbleRequest, record: &Record, file: &Path) -> Result<(), Error> {
    for (column, readings) in request.readings.iter().zip(&record.f_z) {
        let mut values = readings.iter().filter(|reading| reading.is_finite());
        let Some(first) = values.next() else { continue };
        if values.all(|reading| reading == first) {
            let found = format!("the same reading in all rows of column {column}");
            let expected = "a newtonometer that answers to turns";
            return Err(Error::content(file, Place::Whole, found, expected));
        }
    }
    Ok(())
}

/// # Errors
/// If the rests of a record [m/s^2] are longer or shorter than gravity is: each record is judged by its own.
pub(super) fn has_unit(request: &TumbleRequest, rests: &Rests) -> Result<(), Error> {
    let sizes = rests.means.iter().map(|means| {
        let means: Vec<Vector3<f64>> = means.iter().map(|rest| rest.mean).collect();
        (!means.is_empty()).then(|| mean_size(&means))
    });
    let sizes: Vec<(&PathBuf, f64)> =
        request.files.iter().zip(sizes).filter_map(|(file, size)| Some((file, size?))).collect();
    let is_gravity = |size: f64| is_of_gravity(size, request.gravity);
    let Some((file, size)) = sizes.iter().find(|(_, size)| !is_gravity(*size)) else { return Ok(()) };
    let factor = |unit: &str| Dimension::Acceleration.factor(unit);
    let as_written = size / factor(&request.unit).unwrap_or(1.0);
    let likely = UNITS.into_iter().find(|unit| factor(unit).is_some_and(|factor| is_gravity(as_written * factor)));
    let found = format!("rests of {as_written:.4} {} on average", request.unit);
    let unit = likely.unwrap_or("counts");
    let others =
        if sizes.iter().any(|(_, size)| is_gravity(*size)) { "this record alone: all need one unit" } else { "" };
    let expected = format!("rests of gravity, {:.5} m/s^2; --unit {unit} would fit {others}", request.gravity);
    Err(Error::content(file, Place::Whole, found, expected.trim_end()))
}

/// # Errors
/// If a newtonometer whose scale is asked for hardly turns in the rests of unknown attitudes.
pub(super) fn turns(request: &TumbleRequest, means: &[Vector3<f64>]) -> Result<(), Error> {
    let (low, high) = means.iter().fold((means[0], means[0]), |(low, high), mean| (low.inf(mean), high.sup(mean)));
    let is_asked = |axis: usize| request.terms.iter().any(|term| *term == format!("G0_{0}{0}", axis + 1));
    let turned = |axis: usize| 0.5 * (high - low)[axis] / mean_size(means);
    if let Some(axis) = (0..3).find(|axis| is_asked(*axis) && turned(*axis) < LEAST_TURN) {
        let found = format!(
            "newtonometer {} between {:.3} and {:.3} m/s^2 in all {} rests",
            axis + 1,
            low[axis],
            high[axis],
            means.len()
        );
        let expected = "readings that differ by a fifth of gravity at least, best of rests in which it points up and others in which it points down, or a \
                        newtonometer that answers";
        return Err(Error::content(&first(request), Place::Whole, found, expected));
    }
    Ok(())
}

/// The record that messages name.
pub(super) fn first(request: &TumbleRequest) -> PathBuf {
    request.files.first().cloned().unwrap_or_default()
}
