//! `centrical history page STORE --out DIR`: the pages of a store.

use std::collections::BTreeMap;
use std::path::PathBuf;

use centrical_report::{HistoryPages, history_index, history_station_page, history_unit_page};
use centrical_session::{
    Calibrated, Depth, Error, Selection, UnitHistoryRequest, by_unit, claim_folder, list_store, read_calibrations,
    refuse_inputs, station_history, unit_history, write_whole,
};

use crate::command::compensate::acceleration;
use crate::outcome::Outcome;
use crate::output::print;

/// Write the pages of a store: the list of its calibrations, a page for each unit with two or more, and for each station.
///
/// The list is sorted and filtered in the browser, without a server. Compensated readings and due dates are shown up to 5000
/// calibrations; beyond that `history unit` shows them.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical history page store --out pages --limit '300 ug'")]
pub struct Arguments {
    /// Folder of the store
    store: PathBuf,
    /// Folder of the pages; index.html is the first
    #[arg(short, long)]
    out: PathBuf,
    /// Largest error of a compensated reading, for the due dates: '300 ug'
    #[arg(short, long, value_parser = acceleration)]
    limit: Option<f64>,
    /// Print nothing
    #[arg(short, long)]
    quiet: bool,
}

/// Calibrations whose covariances, 10 kB each, are held together.
const MOST_WHOLE: usize = 5000;

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let list = list_store(&arguments.store, Selection::default())?;
    let depth = if list.calibrations.len() > MOST_WHOLE { Depth::Values } else { Depth::Whole };
    let selection = Selection { depth, ..Selection::default() };
    let calibrations = read_calibrations(std::slice::from_ref(&arguments.store), &selection)?;
    let (mut pages, mut files) = (HistoryPages::default(), Vec::new());
    let mut stations: BTreeMap<String, Vec<Calibrated>> = BTreeMap::new();
    for calibrated in &calibrations {
        stations.entry(calibrated.station.clone()).or_default().push(calibrated.clone());
    }
    for (n, (station, calibrations)) in stations.into_iter().enumerate() {
        if let Some(report) = station_history(&calibrations) {
            let file = format!("station-{n}.html");
            files.push((file.clone(), history_station_page(&report)));
            pages.stations.insert(station, file);
        }
    }
    for (n, unit) in by_unit(calibrations).into_iter().enumerate() {
        let request = UnitHistoryRequest { trend: unit.len() > 2, until: None, limit: arguments.limit, coverage: 0.95 };
        if let Some(report) = unit_history(&unit, &[], request) {
            let file = format!("unit-{n}.html");
            files.push((file.clone(), history_unit_page(&report)));
            pages.units.insert((report.unit_model.clone(), report.unit_serial.clone()), file);
        }
    }
    files.push(("index.html".to_owned(), history_index(&list, &pages)));
    let paths: Vec<PathBuf> = files.iter().map(|(name, _)| arguments.out.join(name)).collect();
    refuse_inputs(&paths, std::slice::from_ref(&arguments.store))?;
    let _claim = claim_folder(&arguments.out)?;
    for (path, (_, html)) in paths.iter().zip(&files) {
        write_whole(path, html.as_bytes())?;
    }
    if !arguments.quiet {
        print(&format!("{} pages written to {}, index.html first\n", files.len(), arguments.out.display()))?;
    }
    Ok(Outcome::Done)
}
