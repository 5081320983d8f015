//! Calibrations from results, folders of results, and stores; batches of units, and limits of a laboratory.

use std::collections::{BTreeMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};

use centrical::{OnProgress, advance};

use super::calibrated::{Calibrated, CalibratedParameter, Kinds};
use crate::document::{CalibrationResult, OutputSummary, unit_name};
use crate::error::{Error, Place, quoted};
use crate::laboratory::{Laboratory, Limitable, Limited};
use crate::quantity::Date;
use crate::settings::{read_result, read_settings};
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

/// Name of a result in a folder.
const RESULT: &str = "result.json";

/// Adds the file, or every result in a folder and below, by name.
///
/// # Errors
/// [`Error`] when a folder cannot be read.
pub fn collect_results(path: &Path, files: &mut Vec<PathBuf>) -> Result<(), Error> {
    if !path.is_dir() {
        files.push(path.to_owned());
        return Ok(());
    }
    walk(path, files)
}

fn walk(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), Error> {
    let failed = |error| Error::reading(folder, error, "a folder of results");
    let mut entries = Vec::new();
    for entry in fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        // A link to a folder may lead back here.
        entries.push((entry.path(), entry.file_type().map_err(failed)?.is_dir()));
    }
    entries.sort();
    for (path, is_folder) in entries {
        if is_folder {
            walk(&path, files)?;
        } else if path.file_name().is_some_and(|name| name == RESULT) {
            files.push(path);
        }
    }
    Ok(())
}

/// Batches by serial number: a text with a serial number and a batch in each line, divided by a comma, a semicolon or a tab; a first line
/// "serial,batch", blank lines and lines that begin with "#" do not count.
///
/// # Errors
/// [`Error`] for a line of other than two words, and a unit in two batches.
pub fn read_batches(file: &Path) -> Result<BTreeMap<String, String>, Error> {
    let text = read_settings(file, "a table of serial numbers and batches")?;
    let mut batches = BTreeMap::new();
    // Spreadsheets write a byte order mark.
    for (n, line) in text
        .trim_start_matches('\u{feff}')
        .lines()
        .enumerate()
        .filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'))
    {
        let words: Vec<&str> = line.split([',', ';', '\t']).map(str::trim).collect();
        let refuse = |expected: &str| {
            let place = Place::Line { line: n as u64 + 1, column: None };
            Err(Error::content(file, place, quoted(line.as_bytes()), expected))
        };
        match words.as_slice() {
            ["serial", "batch"] if batches.is_empty() => {}
            [serial, batch] if !serial.is_empty() && !batch.is_empty() => {
                let before = batches.insert((*serial).to_owned(), (*batch).to_owned());
                if before.is_some_and(|before| before != *batch) {
                    return refuse("each unit in one batch");
                }
            }
            _ => return refuse("a serial number and a batch, divided by a comma"),
        }
    }
    Ok(batches)
}

/// Limits of parameters by name, SI: lowest and highest value.
pub type ParameterLimits = BTreeMap<String, (Option<f64>, Option<f64>)>;

/// The limits of parameters in the decision of the laboratory's `file`, for the parameters of `calibrations`. Limits of the compensated reading
/// are passed over.
///
/// # Errors
/// [`Error`] when the file is wrong, or a limit names no parameter of any of the calibrations.
pub fn read_limits(file: &Path, calibrations: &[Calibrated]) -> Result<ParameterLimits, Error> {
    let laboratory = Laboratory::read(file)?;
    let mut by_name: BTreeMap<&str, &CalibratedParameter> = BTreeMap::new();
    for calibrated in calibrations {
        by_name.extend(calibrated.parameters.iter().map(|p| (p.name.as_str(), p)));
    }
    let parameters = by_name.values().map(|p| Limitable { name: &p.name, unit: &p.unit, group: p.group });
    let limits = laboratory.limits(file, &parameters.collect::<Vec<_>>())?;
    let of_parameter = limits.into_iter().filter_map(|limit| match limit.of {
        Limited::Parameter(name) => Some((name, (limit.low.map(|end| end.si), limit.high.map(|end| end.si)))),
        Limited::CompensatedReading(_) => None,
    });
    Ok(of_parameter.collect())
}
