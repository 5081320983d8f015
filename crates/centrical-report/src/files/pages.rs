//! The pages of a store: its list, and a page for each unit with two or more calibrations and for each station.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use centrical_session::{
    Calibrated, Depth, Error, HistoryList, Selection, UnitHistoryRequest, by_unit, claim_folder, list_store,
    read_calibrations, refuse_inputs, station_history, unit_history, write_whole,
};
use rayon::prelude::*;

use crate::render::{HistoryPages, history_index, history_station_page, history_unit_page};

/// Calibrations that are held together with their covariances, 10 kB each.
const MOST_WHOLE: usize = 4096;

/// Writes the pages of the store in `folder` to `out`, the list as `index.html`, and returns their number. With a `limit`
/// [m/s^2] the pages of units have due dates. Memory is that of a few thousand calibrations and of the values of all.
///
/// # Errors
/// [`Error`] when the store cannot be read or `out` does not take a page.
pub fn write_history_pages(folder: &Path, out: &Path, limit: Option<f64>) -> Result<usize, Error> {
    let index = out.join("index.html");
    refuse_inputs(std::slice::from_ref(&index), &[folder.to_owned()])?;
    let list = list_store(folder, Selection::default())?;
    let _claim = claim_folder(out)?;
    let pages = HistoryPages { stations: stations(folder, out)?, units: units(folder, &list, out, limit)? };
    // The list comes last: it names pages that are there.
    write_whole(&index, history_index(&list, &pages).as_bytes())?;
    Ok(1 + pages.stations.len() + pages.units.len())
}

/// A page for each station with a history: file by name.
fn stations(folder: &Path, out: &Path) -> Result<BTreeMap<String, String>, Error> {
    let mut stations: BTreeMap<String, Vec<Calibrated>> = BTreeMap::new();
    for calibrated in read(folder, Depth::Values, None)? {
        stations.entry(calibrated.station.clone()).or_default().push(calibrated);
    }
    let mut pages = BTreeMap::new();
    for (n, (station, calibrations)) in stations.into_iter().enumerate() {
        if let Some(report) = station_history(&calibrations) {
            let file = format!("station-{n}.html");
            write_whole(&out.join(&file), history_station_page(&report).as_bytes())?;
            pages.insert(station, file);
        }
    }
    Ok(pages)
}

/// A page for each unit with a history: file by model and serial number.
fn units(
    folder: &Path,
    list: &HistoryList,
    out: &Path,
    limit: Option<f64>,
) -> Result<BTreeMap<(String, String), String>, Error> {
    let request = UnitHistoryRequest { trend: true, until: None, limit, coverage: 0.95 };
    let (mut pages, mut first) = (BTreeMap::new(), 0);
    for keys in few_thousand(list) {
        let units = by_unit(read(folder, Depth::Whole, Some(keys))?);
        let write = |(n, unit): (usize, &Vec<Calibrated>)| {
            let Some(report) = unit_history(unit, &[], request) else { return Ok(None) };
            let file = format!("unit-{}.html", first + n);
            write_whole(&out.join(&file), history_unit_page(&report).as_bytes())?;
            Ok(Some(((report.unit_model, report.unit_serial), file)))
        };
        let written: Vec<Option<_>> = units.par_iter().enumerate().map(write).collect::<Result<_, Error>>()?;
        pages.extend(written.into_iter().flatten());
        first += units.len();
    }
    Ok(pages)
}

/// Keys of the calibrations, those of one unit together, a few thousand at a time.
fn few_thousand(list: &HistoryList) -> Vec<BTreeSet<String>> {
    let mut units: BTreeMap<(&str, &str), Vec<&String>> = BTreeMap::new();
    for line in &list.calibrations {
        units.entry((&line.unit_model, &line.unit_serial)).or_default().push(&line.key);
    }
    let mut sets = vec![BTreeSet::new()];
    for keys in units.into_values() {
        if sets.last().is_some_and(|set: &BTreeSet<String>| set.len() + keys.len() > MOST_WHOLE) {
            sets.push(BTreeSet::new());
        }
        if let Some(set) = sets.last_mut() {
            set.extend(keys.into_iter().cloned());
        }
    }
    sets
}

fn read(folder: &Path, depth: Depth, keys: Option<BTreeSet<String>>) -> Result<Vec<Calibrated>, Error> {
    read_calibrations(&[folder.to_owned()], &Selection { depth, keys, ..Selection::default() })
}
