//! The request for pages, and the findings of a whole store: its list, its models of units, its stations.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use centrical_session::{
    Calibrated, ChartLimits, ChartRequest, ComparedUnits, Date, Depth, Error, HistoryLine, HistoryList, OnProgress,
    ParameterLimits, RuleSet, Selection, StationHistoryReport, UnitsHistoryReport, UnitsHistoryRequest, advance,
    by_unit, chart, list_store, read_batches, read_calibrations, read_limits, station_history, unit_means,
    units_history,
};
use rayon::prelude::*;

use crate::render::{
    Indexed, ListedUnit, PageKind, StoreCharts, UnitDue, due_of_page, history_due_page, history_index,
    history_model_page, history_station_page,
};

/// What the pages of a store show beside its calibrations.
#[derive(Debug, Clone, PartialEq)]
pub struct PagesRequest {
    /// Largest error of a compensated reading [m/s^2], for the due dates.
    pub limit: Option<f64>,
    /// A laboratory's file with limits of parameters, for capability and drawings.
    pub laboratory: Option<PathBuf>,
    /// A table of serial numbers and batches.
    pub batches: Option<PathBuf>,
    /// Acceptable sessions whose values give the limits of control charts.
    pub accepted: usize,
}

impl PagesRequest {
    /// The files that are read.
    pub(super) fn inputs(&self) -> Vec<&Path> {
        self.laboratory.iter().chain(&self.batches).map(PathBuf::as_path).collect()
    }
}

impl Default for PagesRequest {
    fn default() -> Self {
        Self { limit: None, laboratory: None, batches: None, accepted: 20 }
    }
}

/// Name of the list of due dates.
pub const DUE_PAGE: &str = "due.html";

/// Sessions that a control chart shows: the last ones.
const SHOWN: usize = 100;

/// Batches that are drawn each by itself; of more all units are drawn together.
const MOST_BATCHES: usize = 6;

/// The pages that show the whole store.
#[derive(Debug)]
pub struct Overview {
    /// Limits of parameters.
    pub limits: ParameterLimits,
    /// The first page.
    pub index: String,
    /// Pages of models and stations by their files.
    pub pages: BTreeMap<String, String>,
    /// Keys of the calibrations of each unit that has a page, by its file.
    pub units: BTreeMap<String, BTreeSet<String>>,
    /// The limit that units may be due for, if there is one [m/s^2], and all units.
    pub with_limit: Option<(f64, WithPage)>,
}

/// Units as they are listed, with the file of the page where one has a page.
type WithPage = Vec<(Option<String>, ListedUnit)>;

impl Overview {
    /// The list of due dates, by the page of each unit or its beginning; `None` without a limit, or where a page does not say.
    ///
    /// # Errors
    /// That of `page`.
    pub fn due(&self, page: impl Fn(&str) -> Result<Option<String>, Error>) -> Result<Option<String>, Error> {
        let Some((limit, units)) = self.with_limit.as_ref() else { return Ok(None) };
        let mut list = Vec::with_capacity(units.len());
        for (file, unit) in units {
            let due = match file {
                Some(file) => page(file)?.and_then(|page| due_of_page(&page)),
                None => Some(UnitDue::NotKnown),
            };
            let Some(due) = due else { return Ok(None) };
            list.push((unit, due));
        }
        Ok(Some(history_due_page(list, *limit, Date::today())))
    }

    /// Reads the values of all calibrations. `progress` is asked again and again.
    ///
    /// # Errors
    /// [`Error`] when the store cannot be read, or a file of the request is wrong.
    pub fn read(folder: &Path, request: &PagesRequest, progress: OnProgress) -> Result<Self, Error> {
        let list = list_store(folder, Selection::default(), progress)?;
        let selection = Selection { depth: Depth::Errors, ..Selection::default() };
        let calibrations = read_calibrations(&[folder.to_owned()], &selection, progress)?.calibrations;
        let limits = request.laboratory.as_deref().map(|file| read_limits(file, &calibrations)).transpose()?;
        let batches = request.batches.as_deref().map(read_batches).transpose()?;
        let asked = UnitsHistoryRequest { limits: limits.unwrap_or_default(), batches: batches.unwrap_or_default() };
        let mut pages = BTreeMap::new();
        let units = units(&list);
        let listed = Listed { list: &list, pages: &units };
        let stations = stations(&calibrations, listed, request, &mut pages);
        advance(progress, 0)?;
        let models = models(calibrations, listed, &asked, request, &mut pages);
        advance(progress, 0)?;
        let with_limit = request.limit.map(|limit| {
            let file = |unit: &ListedUnit| PageKind::Unit.file(&[&unit.model, &unit.serial]);
            let with_page = |unit: ListedUnit| (Some(file(&unit)).filter(|file| units.contains_key(file)), unit);
            (limit, listed.units(|_| true).into_iter().map(with_page).collect())
        });
        let due = with_limit.as_ref().map(|_| DUE_PAGE);
        let index = history_index(&list, &models, &stations, due, |file| units.contains_key(file));
        Ok(Self { limits: asked.limits, index, pages, units, with_limit })
    }
}

/// The units with two calibrations or more: each has a page.
fn units(list: &HistoryList) -> BTreeMap<String, BTreeSet<String>> {
    let mut units: BTreeMap<(&str, &str), BTreeSet<String>> = BTreeMap::new();
    let has_day = |line: &&HistoryLine| line.acceptable.is_some() && line.date.parse::<Date>().is_ok();
    for line in list.calibrations.iter().filter(has_day) {
        units.entry((&line.unit_model, &line.unit_serial)).or_default().insert(line.key.clone());
    }
    let units = units.into_iter().filter(|(_, keys)| keys.len() > 1);
    units.map(|((model, serial), keys)| (PageKind::Unit.file(&[model, serial]), keys)).collect()
}

/// The list of a store, and the units that have a page by its file.
#[derive(Clone, Copy)]
struct Listed<'l> {
    list: &'l HistoryList,
    pages: &'l BTreeMap<String, BTreeSet<String>>,
}

impl Listed<'_> {
    /// The units of the calibrations for which `is_of` holds.
    fn units(self, is_of: impl Fn(&HistoryLine) -> bool) -> Vec<ListedUnit> {
        let lines = self.list.calibrations.iter().filter(|line| is_of(line));
        ListedUnit::all(lines, |file| self.pages.contains_key(file))
    }
}

fn stations(
    calibrations: &[Calibrated],
    listed: Listed,
    request: &PagesRequest,
    pages: &mut BTreeMap<String, String>,
) -> Vec<Indexed<StationHistoryReport>> {
    let mut stations: BTreeMap<&str, Vec<&Calibrated>> = BTreeMap::new();
    for calibrated in calibrations {
        stations.entry(&calibrated.station).or_default().push(calibrated);
    }
    let mut indexed = Vec::new();
    for calibrations in stations.values() {
        let Ok(report) = station_history(calibrations) else { continue };
        let names: Vec<&str> = report.parameters.iter().map(|p| p.name.as_str()).collect();
        let charts = charts(calibrations, &names, request.accepted);
        let units = listed.units(|line| line.station == report.station);
        pages.insert(PageKind::Station.file(&[&report.station]), history_station_page(&report, &units, &charts));
        indexed.push(Indexed { has_signals: charts.has_signals(), report });
    }
    indexed
}

fn models(
    calibrations: Vec<Calibrated>,
    listed: Listed,
    asked: &UnitsHistoryRequest,
    request: &PagesRequest,
    pages: &mut BTreeMap<String, String>,
) -> Vec<Indexed<UnitsHistoryReport>> {
    let mut models: BTreeMap<String, Vec<Vec<Calibrated>>> = BTreeMap::new();
    for unit in by_unit(calibrations) {
        models.entry(unit[0].unit_model.clone()).or_default().push(unit);
    }
    let mut indexed = Vec::new();
    for units in models.into_values() {
        let Ok(compared) = ComparedUnits::of(units) else { continue };
        let units = &compared.units;
        let Ok(report) = units_history(&compared, asked) else { continue };
        let mut all: Vec<&Calibrated> = units.iter().flatten().collect();
        all.sort_by(|a, b| a.date.cmp(&b.date).then_with(|| a.source.cmp(&b.source)));
        let names: Vec<&str> = report.parameters.iter().map(|p| p.name.as_str()).collect();
        let charts = charts(&all, &names, request.accepted);
        let values = distributions(units, &report, asked);
        let units = listed.units(|line| line.unit_model == report.unit_model);
        let page = history_model_page(&report, &values, &units, &asked.limits, &charts);
        pages.insert(PageKind::Model.file(&[&report.unit_model]), page);
        indexed.push(Indexed { has_signals: charts.has_signals(), report });
    }
    indexed
}

/// For each parameter the means of the units, by batches if they are few.
fn distributions(
    units: &[Vec<Calibrated>],
    report: &UnitsHistoryReport,
    asked: &UnitsHistoryRequest,
) -> Vec<Vec<(String, Vec<f64>)>> {
    let batch = |unit: &Vec<Calibrated>| asked.batches.get(&unit[0].unit_serial);
    let batches: BTreeSet<&String> = units.iter().filter_map(batch).collect();
    let by_batch = (2..=MOST_BATCHES).contains(&batches.len());
    let groups = |name: &str| {
        let mut groups: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        for (unit, mean) in units.iter().zip(unit_means(units.iter().map(Vec::as_slice), name)) {
            let group = if by_batch { batch(unit).map(String::as_str) } else { Some("units") };
            if let Some(group) = group {
                groups.entry(group).or_default().push(mean);
            }
        }
        groups.into_iter().map(|(name, values)| (name.to_owned(), values)).collect()
    };
    report.parameters.par_iter().map(|p| groups(&p.name)).collect()
}

/// The charts of parameters over `calibrations` in the order of time.
pub fn charts(calibrations: &[&Calibrated], names: &[&str], accepted: usize) -> StoreCharts {
    let request = ChartRequest { limits: ChartLimits::Accepted(accepted), rules: RuleSet::Nelson, last: Some(SHOWN) };
    let made: Vec<_> = names.par_iter().map(|name| chart(calibrations, name, request)).collect();
    let missing = made.iter().find_map(|chart| chart.as_ref().err().cloned());
    StoreCharts { charts: made.into_iter().flatten().collect(), missing }
}
