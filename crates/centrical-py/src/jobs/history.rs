//! `history`: a store of calibrations, and what many of them say.

use std::ffi::CString;
use std::path::PathBuf;

use centrical_report::{PagesRequest, chart_plots, unit_history_plots, write_history_pages, write_plots};
use centrical_session::{
    Added, Calibrated, ChartLimits, ChartRequest, ComparedUnits, Date, Depth, Error, Failure, OnProgress,
    ParameterLimits, Past, Place, Quantity, Row, RuleSet, Selection, Store, UnitHistoryRequest, UnitsHistoryRequest,
    add_result, add_results, advance, by_unit, chart_of_one, check_store, list_store, read_batches, read_calibrations,
    read_limits, station_history, unit_history_among, units_history,
};
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;

use crate::given::GivenResult;
use crate::progress::{self, Shown};
use crate::words::{Amount, one_of, refused};

/// The calibrations in the order of time, with a warning for those that have no day for a date.
fn read(results: &[PathBuf], selection: &Selection, progress: OnProgress) -> Result<Vec<Calibrated>, Error> {
    let Past { calibrations, undated } = read_calibrations(results, selection, progress)?;
    let expected = "a day such as 2026-10-05";
    for calibration in undated {
        let words = format!("{calibration}, expected {expected}: left out").replace('\0', " ");
        let words = CString::new(words).unwrap_or_default();
        // A filter may turn a warning into an error.
        Python::attach(|py| PyErr::warn(py, &py.get_type::<PyUserWarning>(), &words, 1))
            .map_err(|_| Error::content(&results[0], Place::Whole, calibration, expected))?;
    }
    if calibrations.is_empty() {
        let asked = "results, as model, serial and station ask for";
        let expected = if selection.names_any() { asked } else { "results" };
        return Err(Error::content(&results[0], Place::Whole, "no such calibration", expected));
    }
    Ok(calibrations)
}

/// Model and serial number of the unit, and the station.
type Chosen = (Option<String>, Option<String>, Option<String>);

/// Adds results to a store: how many were new, how many known.
#[pyfunction]
pub fn add_to_store(
    py: Python,
    store: PathBuf,
    results: Vec<GivenResult>,
    rows_only: bool,
    shown: Shown,
) -> PyResult<(usize, usize)> {
    let (mut files, mut read) = (Vec::new(), Vec::new());
    for result in results {
        match result {
            GivenResult::Path(file) => files.push(file),
            GivenResult::Read(result) => read.push(result),
        }
    }
    let added = progress::run(py, &shown, |work| {
        let mut added = add_results(&store, &files, rows_only, &|count| work.count(count))?;
        for result in &read {
            let of_one = add_result(&store, &result.get().result, rows_only)?;
            added = Added { new: added.new + of_one.new, known: added.known + of_one.known };
            advance(&|count| work.count(count), 1)?;
        }
        Ok(added)
    })?;
    Ok((added.new, added.known))
}

/// Adds a session without a result to a store, a row with its message; the key of the row.
#[pyfunction]
pub fn add_failure(
    py: Python,
    store: PathBuf,
    session: &str,
    message: String,
    file: String,
    found: String,
    expected: String,
) -> PyResult<String> {
    let row = Row::failed(session, Failure { message, file, place: String::new(), found, expected });
    let key = row.key.clone();
    progress::run(py, &None, |_| Store::create(&store)?.add(vec![row]))?;
    Ok(key)
}

/// `centrical-history-list/1`.
#[pyfunction]
pub fn history_list(py: Python, store: PathBuf, chosen: Chosen, check: bool) -> PyResult<String> {
    progress::run(py, &None, |work| {
        let (selection, progress) = (selection(Depth::Summary, chosen), |done| work.advance(done));
        let list =
            if check { check_store(&store, selection, &progress)? } else { list_store(&store, selection, &progress)? };
        list.to_json()
    })
}

/// `centrical-unit-history/1`; with a folder `out` the plots as well.
#[pyfunction]
pub fn history_unit(
    py: Python,
    results: Vec<PathBuf>,
    chosen: Chosen,
    limit: Option<Amount>,
    on: Option<String>,
    until: Option<String>,
    confidence: Option<f64>,
    trend: bool,
    together: bool,
    out: Option<PathBuf>,
) -> PyResult<String> {
    let confidence = confidence.unwrap_or(UnitHistoryRequest::COVERAGE);
    if !(confidence > 0.5 && confidence < 1.0) {
        return Err(refused("confidence", format!("found {confidence}, expected a number between 0.5 and 1")));
    }
    let limit = Amount::checked(limit, "limit", Quantity::largest_error)?;
    let day = |name: &'static str, day: Option<String>| {
        let refuse = |day: &str| refused(name, format!("found {day:?}, expected a day such as 2026-10-05"));
        day.map(|day| day.parse::<Date>().map_err(|_| refuse(&day))).transpose()
    };
    let (on, until) = (day("on", on)?, day("until", until)?);
    let request = UnitHistoryRequest { trend, until, limit, on, coverage: confidence };
    let (model, serial, station) = chosen;
    let read_of = if together { None } else { serial.clone() };
    of_calibrations(py, results, selection(Depth::Whole, (model, read_of, station)), |calibrations, results| {
        let report = unit_history_among(calibrations, serial.as_deref(), request).map_err(|none| none.of(results))?;
        if let Some(folder) = &out {
            write_plots(folder, &unit_history_plots(&report, &ParameterLimits::default()), results)?;
        }
        report.to_json()
    })
}

/// `centrical-units-history/1`.
#[pyfunction]
pub fn history_units(
    py: Python,
    results: Vec<PathBuf>,
    chosen: Chosen,
    laboratory: Option<PathBuf>,
    batches: Option<PathBuf>,
) -> PyResult<String> {
    of_calibrations(py, results, selection(Depth::Errors, chosen), |calibrations, results| {
        let limits = laboratory.as_deref().map(|file| read_limits(file, &calibrations)).transpose()?;
        let batches = batches.as_deref().map(read_batches).transpose()?;
        let request = UnitsHistoryRequest { limits: limits.unwrap_or_default(), batches: batches.unwrap_or_default() };
        let report = ComparedUnits::of(by_unit(calibrations)).and_then(|compared| units_history(&compared, &request));
        report.map_err(|none| none.of(results))?.to_json()
    })
}

/// `centrical-station-history/1`.
#[pyfunction]
pub fn history_station(py: Python, results: Vec<PathBuf>, chosen: Chosen) -> PyResult<String> {
    of_calibrations(py, results, selection(Depth::Values, chosen), |calibrations, results| {
        station_history(&calibrations).map_err(|none| none.of(results))?.to_json()
    })
}

/// The document of control charts; with a folder `out` the plots as well. `stated` are centre and standard deviation [SI], in place of those of
/// the sessions `accepted`.
#[pyfunction]
pub fn history_chart(
    py: Python,
    parameter: &str,
    results: Vec<PathBuf>,
    chosen: Chosen,
    accepted: usize,
    stated: Option<(f64, f64)>,
    rules: &str,
    out: Option<PathBuf>,
) -> PyResult<String> {
    let known = [("nelson", RuleSet::Nelson), ("western-electric", RuleSet::WesternElectric)];
    let rules = one_of("rules", rules, &known)?;
    let is_finite = |(centre, deviation): &(f64, f64)| centre.is_finite() && *deviation > 0.0 && deviation.is_finite();
    if let Some((centre, deviation)) = stated.filter(|stated| !is_finite(stated)) {
        let found = format!("found {deviation} about {centre}, expected a positive deviation about a finite centre");
        return Err(refused("deviation", found));
    }
    let limits = stated.map_or(ChartLimits::Accepted(accepted), |(c, deviation)| ChartLimits::Stated(c, deviation));
    of_calibrations(py, results, selection(Depth::Values, chosen), |calibrations, results| {
        let report = chart_of_one(&calibrations, parameter, ChartRequest { limits, rules, last: None })
            .map_err(|none| none.of(results))?;
        if let Some(folder) = &out {
            write_plots(folder, &chart_plots(&report), results)?;
        }
        report.to_json()
    })
}

/// Writes the pages of a store: how many there are.
#[pyfunction]
pub fn history_pages(
    py: Python,
    store: PathBuf,
    out: PathBuf,
    limit: Option<Amount>,
    laboratory: Option<PathBuf>,
    batches: Option<PathBuf>,
    accepted: usize,
) -> PyResult<usize> {
    let limit = Amount::checked(limit, "limit", Quantity::largest_error)?;
    let request = PagesRequest { limit, laboratory, batches, accepted };
    progress::run(py, &None, |work| write_history_pages(&store, &out, &request, &|done| work.advance(done)))
}

fn selection(depth: Depth, (unit_model, unit_serial, station): Chosen) -> Selection {
    Selection { depth, unit_model, unit_serial, station, keys: None }
}

/// The document that `report` makes of the calibrations in stores and results, one of these at least.
fn of_calibrations(
    py: Python,
    results: Vec<PathBuf>,
    selection: Selection,
    report: impl FnOnce(Vec<Calibrated>, &[PathBuf]) -> Result<String, Error> + Send,
) -> PyResult<String> {
    if results.is_empty() {
        return Err(refused("results", "found none, expected a store, results or folders of them"));
    }
    progress::run(py, &None, |work| report(read(&results, &selection, &|done| work.advance(done))?, &results))
}
