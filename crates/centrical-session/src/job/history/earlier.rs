//! The history of the unit of one result, up to that result.

use std::path::{Path, PathBuf};

use centrical::unwatched;

use super::calibrated::Calibrated;
use super::read::read_calibrations;
use super::unit::{UnitHistoryRequest, unit_history};
use crate::document::{CalibrationResult, UnitHistoryReport};
use crate::error::{Error, Place};
use crate::store::{Depth, Selection};

/// What the calibrations in `paths` that were made of the unit of the result in `file` up to its day, and that result, say of the unit.
/// `paths` are results, folders of results, or stores; calibrations of other units in them are passed over.
///
/// # Errors
/// [`Error`] when a path cannot be read, or holds no earlier calibration of that unit with a parameter in common.
pub fn history_up_to(file: &Path, result: &CalibrationResult, paths: &[PathBuf]) -> Result<UnitHistoryReport, Error> {
    let (model, serial) = (&result.session.unit_model, &result.session.unit_serial);
    let selection = Selection {
        depth: Depth::Whole,
        unit_model: Some(model.clone()),
        unit_serial: Some(serial.clone()),
        ..Selection::default()
    };
    // The result is read first: where the paths hold it too, it counts as this file.
    let files: Vec<PathBuf> = std::iter::once(file.to_owned()).chain(paths.iter().cloned()).collect();
    let source = file.display().to_string();
    let all = read_calibrations(&files, &selection, &unwatched)?;
    let (this, others): (Vec<Calibrated>, Vec<Calibrated>) =
        all.calibrations.into_iter().partition(|c| c.source == source);
    let is_earlier =
        |other: &Calibrated| this.first().is_some_and(|this| (other.date, &other.stamp) <= (this.date, &this.stamp));
    let calibrations: Vec<Calibrated> = others.into_iter().filter(is_earlier).chain(this.iter().cloned()).collect();
    unit_history(&calibrations, &[], UnitHistoryRequest::default()).ok_or_else(|| {
        let place = paths.first().map_or(file, PathBuf::as_path);
        let day = this.first().map_or_else(String::new, |this| format!(" up to {}", this.date));
        let expected = format!("one or more of {model}, serial \"{serial}\",{day} with a parameter in common");
        Error::content(place, Place::Whole, "no earlier calibration of the unit", expected)
    })
}
