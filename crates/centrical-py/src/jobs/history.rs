//! `history`: a store of calibrations, and what many of them say.

use std::path::PathBuf;

use centrical_session::{
    Date, Depth, Dimension, Error, Failure, Place, Row, Selection, Store, UnitHistoryRequest, UnitsHistoryRequest,
    add_results, by_unit, list_store, read_calibrations, station_history, unit_history, units_history,
};
use pyo3::prelude::*;

use crate::progress::{self, Shown};
use crate::words::{Amount, refused};

/// Adds results to a store: how many were new, how many known.
#[pyfunction]
pub fn add_to_store(
    py: Python,
    store: PathBuf,
    results: Vec<PathBuf>,
    rows_only: bool,
    shown: Shown,
) -> PyResult<(usize, usize)> {
    let added = progress::run(py, &shown, |work| add_results(&store, &results, rows_only, &|count| work.count(count)))?;
    Ok((added.new, added.known))
}

/// Adds a session without a result to a store, a row with its message; whether it was not there.
#[pyfunction]
pub fn add_failure(
    py: Python,
    store: PathBuf,
    session: &str,
    message: String,
    file: String,
    found: String,
    expected: String,
) -> PyResult<bool> {
    let row = Row::failed(session, Failure { message, file, place: String::new(), found, expected });
    progress::run(py, &None, |_| Ok(Store::create(&store)?.add(vec![row])?.new > 0))
}

/// `centrical-history-list/1`, `centrical-unit-history/1`, `centrical-units-history/1` or `centrical-station-history/1`.
#[pyfunction]
pub fn history(
    py: Python,
    results: Vec<PathBuf>,
    of: &str,
    chosen: (Option<String>, Option<String>, Option<String>),
    limit: Option<Amount>,
    until: Option<String>,
    confidence: f64,
    trend: bool,
) -> PyResult<String> {
    if !(confidence > 0.5 && confidence < 1.0) {
        return Err(refused("confidence", format!("found {confidence}, expected a number between 0.5 and 1")));
    }
    let limit = Amount::optional(limit, "limit", Dimension::Acceleration)?;
    let day = |day: String| {
        let refuse = |_| refused("until", format!("found {day:?}, expected a day such as 2026-10-05"));
        day.parse::<Date>().map_err(refuse)
    };
    let until = until.map(day).transpose()?;
    let [first, ..] = results.as_slice() else {
        return Err(refused("results", "found none, expected a store, results or folders of them"));
    };
    let (unit_model, unit_serial, station) = chosen;
    let depth = match of {
        "unit" => Depth::Whole,
        "units" => Depth::Errors,
        _ => Depth::Values,
    };
    let selection = Selection { depth, unit_model, unit_serial, station, keys: None };
    let missing = |expected: &str| Error::content(first, Place::Whole, "no such calibrations", expected);
    if !["list", "unit", "units", "station"].contains(&of) {
        return Err(refused("of", format!("found {of:?}, expected \"list\", \"unit\", \"units\" or \"station\"")));
    }
    progress::run(py, &None, |work| {
        let progress = |done| work.advance(done);
        if of == "list" {
            return list_store(first, Selection { depth: Depth::Summary, ..selection }, &progress)?.to_json();
        }
        let calibrations = read_calibrations(&results, &selection, &progress)?;
        if of == "station" {
            let report = station_history(&calibrations);
            return report.ok_or_else(|| missing("calibrations of the station"))?.to_json();
        }
        let units = by_unit(calibrations);
        match of {
            "unit" => {
                let [own] = units.as_slice() else { return Err(missing("calibrations of one unit")) };
                let request = UnitHistoryRequest { trend, until, limit, coverage: confidence };
                unit_history(own, &[], request)
                    .ok_or_else(|| missing("two calibrations of the unit or more"))?
                    .to_json()
            }
            _ => units_history(&units, &UnitsHistoryRequest::default())
                .ok_or_else(|| missing("calibrations with a parameter in common"))?
                .to_json(),
        }
    })
}
