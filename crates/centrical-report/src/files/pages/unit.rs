//! Pages of units.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use centrical_session::{
    Calibrated, Date, Depth, Error, OnProgress, ParameterLimits, Selection, UnitHistoryReport, UnitHistoryRequest,
    read_calibrations, sha256, unit_history, unwatched,
};

use super::overview::{Overview, PagesRequest, charts};
use crate::render::{due_comment, history_unit_page, no_unit_history_page};

/// The units that have a page.
#[derive(Debug)]
pub struct UnitPages {
    folder: PathBuf,
    limits: ParameterLimits,
    limit: Option<f64>,
    accepted: usize,
    units: BTreeMap<String, BTreeSet<String>>,
}

impl UnitPages {
    /// The units with two calibrations or more.
    pub fn of(folder: &Path, overview: &Overview, request: &PagesRequest) -> Self {
        Self {
            folder: folder.to_owned(),
            limits: overview.limits.clone(),
            limit: request.limit,
            accepted: request.accepted,
            units: overview.units.clone(),
        }
    }

    /// Number of units.
    pub fn count(&self) -> usize {
        self.units.len()
    }

    /// The files of the units and the keys of their calibrations.
    pub fn units(&self) -> impl Iterator<Item = (&str, &BTreeSet<String>)> {
        self.units.iter().map(|(file, keys)| (file.as_str(), keys))
    }

    /// The page of this name.
    ///
    /// # Errors
    /// [`Error`] when the store cannot be read.
    pub fn page(&self, file: &str) -> Result<Option<String>, Error> {
        let Some(keys) = self.units.get(file) else { return Ok(None) };
        let calibrations = self.read(keys.clone(), &unwatched)?;
        Ok((!calibrations.is_empty()).then(|| self.made(&calibrations)))
    }

    /// Whole calibrations, in the order of time. `progress` is asked again and again.
    ///
    /// # Errors
    /// [`Error`] when the store cannot be read.
    pub fn read(&self, keys: BTreeSet<String>, progress: OnProgress) -> Result<Vec<Calibrated>, Error> {
        let selection = Selection { depth: Depth::Whole, keys: Some(keys), ..Selection::default() };
        Ok(read_calibrations(std::slice::from_ref(&self.folder), &selection, progress)?.calibrations)
    }

    /// The page of a unit by its calibrations, in the order of time.
    pub fn made(&self, calibrations: &[Calibrated]) -> String {
        let on = self.limit.map(|_| Date::today());
        let request = UnitHistoryRequest { limit: self.limit, on, ..UnitHistoryRequest::default() };
        let report = unit_history(calibrations, &[], request);
        let due = self.limit.map_or_else(String::new, |_| due_comment(report.as_ref()));
        self.shown(calibrations, report.as_ref()).replacen(DOCTYPE, &format!("{DOCTYPE}{due}"), 1)
    }

    fn shown(&self, calibrations: &[Calibrated], report: Option<&UnitHistoryReport>) -> String {
        let Some(report) = report else {
            return no_unit_history_page(&calibrations[0].unit_model, &calibrations[0].unit_serial);
        };
        let names: Vec<&str> = report.parameters.iter().map(|p| p.name.as_str()).collect();
        let charts = charts(&calibrations.iter().collect::<Vec<_>>(), &names, self.accepted);
        history_unit_page(report, &self.limits, &charts)
    }

    /// What a page is made of: the calibrations, what is asked, and the program.
    pub fn origin(&self, keys: &BTreeSet<String>) -> String {
        let program = env!("CARGO_PKG_VERSION");
        // Whether a unit is overdue is a question of the day.
        let day = self.limit.map_or_else(String::new, |_| Date::today().to_string());
        let mut origin = format!("{program} {FORM} {day} {:?} {:?} {}", self.limit, self.limits, self.accepted);
        origin.extend(keys.iter().map(String::as_str));
        sha256(origin.as_bytes())
    }
}

/// How a page begins.
pub const DOCTYPE: &str = "<!DOCTYPE html>\n";

/// Counts up when a page of the same calibrations looks otherwise.
const FORM: u32 = 6;
