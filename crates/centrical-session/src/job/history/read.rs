//! Calibrations from results, folders of results, and stores.

use std::collections::{BTreeMap, HashSet};
use std::path::{Path, PathBuf};

use centrical::{OnProgress, advance};

use super::calibrated::{Calibrated, Kinds};
use super::results::collect_results;
use crate::document::{CalibrationResult, OutputSummary, unit_name};
use crate::error::{Error, Place, quoted};
use crate::quantity::Date;
use crate::settings::read_result;
use crate::store::{Depth, Row, Selection, Status, Store};

/// Calibrations of the past.
#[derive(Debug, Clone, Default)]
pub struct Past {
    /// In the order of time.
    pub calibrations: Vec<Calibrated>,
    /// Those of a store that have no day for a date, in words: no history has a place for them.
    pub undated: Vec<String>,
}

/// The calibrations in `paths` that `selection` picks, in the order of time: results; stores; other folders, in which each `result.json` at any
/// depth is one. A result that is met twice counts once; sessions of a store without a result do not count. `progress` is asked at each result and
/// at each row group of a store, with none done.
///
/// # Errors
/// [`Error`] when a result or a store cannot be read, or a file has no day for a date; [`Error::Stopped`].
pub fn read_calibrations(paths: &[PathBuf], selection: &Selection, progress: OnProgress) -> Result<Past, Error> {
    let mut found = Found { selection, progress, kinds: Kinds::default(), keys: HashSet::new(), past: Past::default() };
    for path in paths {
        match Store::open(path) {
            Ok(store) => found.take_store(&store)?,
            Err(_) => found.take_files(path)?,
        }
    }
    let Past { mut calibrations, undated } = found.past;
    calibrations.sort_by(|a, b| {
        let by_time = a.date.cmp(&b.date).then_with(|| a.unit().cmp(&b.unit())).then_with(|| a.stamp.cmp(&b.stamp));
        by_time.then_with(|| a.source.cmp(&b.source))
    });
    refuse_other_outputs(&calibrations)?;
    restate(&mut calibrations);
    Ok(Past { calibrations, undated })
}

/// Refuses calibrations of one unit in counts and in volts, or in m/s^2: nothing says how many counts a volt or 1 m/s^2 is.
fn refuse_other_outputs(calibrations: &[Calibrated]) -> Result<(), Error> {
    let mut first: BTreeMap<(&str, &str), &Calibrated> = BTreeMap::new();
    for calibrated in calibrations {
        refuse_other_output(first.entry(calibrated.unit()).or_insert(calibrated), calibrated)?;
    }
    Ok(())
}

/// Refuses a calibration whose output is in another unit than that of the first.
pub fn refuse_other_output(first: &Calibrated, calibrated: &Calibrated) -> Result<(), Error> {
    let unit = |of: &Calibrated| of.output.as_ref().map_or_else(|| "m/s^2".to_owned(), |output| output.unit.clone());
    let (expected, found) = (unit(first), unit(calibrated));
    if found == expected {
        return Ok(());
    }
    let (file, found) = (Path::new(&calibrated.source), format!("output in {found}"));
    Err(Error::content(file, Place::Whole, found, format!("{expected}, as in {}", first.source)))
}

/// States all calibrations relative to the nominal output of the last one in the same raw unit.
fn restate(calibrations: &mut [Calibrated]) {
    let outputs = calibrations.iter().filter_map(|calibrated| calibrated.output.clone());
    let last: BTreeMap<String, OutputSummary> = outputs.map(|output| (output.unit.clone(), output)).collect();
    for calibrated in calibrations {
        if let Some(last) = calibrated.output.as_ref().and_then(|output| last.get(&output.unit)) {
            calibrated.restate(last);
        }
    }
}

/// The calibrations unit by unit, each in the order of time.
pub fn by_unit(calibrations: Vec<Calibrated>) -> Vec<Vec<Calibrated>> {
    let mut units: BTreeMap<(String, String), Vec<Calibrated>> = BTreeMap::new();
    for calibrated in calibrations {
        let (model, serial) = calibrated.unit();
        units.entry((model.to_owned(), serial.to_owned())).or_default().push(calibrated);
    }
    units.into_values().collect()
}

struct Found<'a> {
    selection: &'a Selection,
    progress: OnProgress<'a>,
    kinds: Kinds,
    keys: HashSet<String>,
    past: Past,
}

impl Found<'_> {
    fn take_store(&mut self, store: &Store) -> Result<(), Error> {
        for row in store.rows(self.selection.clone(), self.progress)? {
            let row = row?;
            if row.status == Status::Done && row.date.parse::<Date>().is_err() {
                let unit = unit_name(&row.unit_model, &row.unit_serial);
                self.past.undated.push(format!("{unit}, {}: {}", row.key, quoted(row.date.as_bytes())));
            } else {
                self.take(store.folder(), row.key.clone(), row)?;
            }
        }
        Ok(())
    }

    fn take_files(&mut self, path: &Path) -> Result<(), Error> {
        let mut files = Vec::new();
        collect_results(path, &mut files)?;
        files.iter().try_for_each(|file| self.take_result(file))
    }

    fn take_result(&mut self, file: &Path) -> Result<(), Error> {
        advance(self.progress, 0)?;
        let text = read_result(file, "a result.json, a folder of them, or a store")?;
        let row = CalibrationResult::parse(file, &text)?.row(text.as_bytes());
        if self.selection.takes(&row) { self.take(file, file.display().to_string(), row) } else { Ok(()) }
    }

    fn take(&mut self, file: &Path, source: String, row: Row) -> Result<(), Error> {
        if row.status == Status::Failed || !self.keys.insert(row.key.clone()) {
            return Ok(());
        }
        let date = row.date.clone();
        let calibrated = Calibrated::of(source, row, &mut self.kinds).ok_or_else(|| {
            let place = Place::Key { table: "session".to_owned(), key: "date".to_owned() };
            Error::content(file, place, quoted(date.as_bytes()), "a day such as 2026-10-05")
        })?;
        let is_condensed = self.selection.depth <= Depth::Errors;
        self.past.calibrations.push(if is_condensed { calibrated.condensed() } else { calibrated });
        Ok(())
    }
}
