//! `centrical history add|list|page STORE`: a store, its calibrations, its pages.

use std::path::PathBuf;

use centrical_report::{PagesRequest, history_list_text, write_history_pages};
use centrical_session::{
    AddedReport, Error, Place, Selection, add_results, check_store, list_store, matching_paths, unwatched,
    wait_for_store,
};

use crate::given::largest_error;
use crate::output::{Outcome, Printing, print, say_waiting};
use crate::progress;

/// Add results to a store, which is created if absent. Results that are in it already stay as they are.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical history add store results/a results/b/result.json")]
pub struct Add {
    /// Folder of the store
    store: PathBuf,
    /// Results, or folders: every result.json in them and below; a pattern such as "results/*.json" stands for all that match
    #[arg(required = true, value_name = "RESULT")]
    results: Vec<PathBuf>,
    /// Keep the rows alone, about 11 kB each, without copies of result.json
    #[arg(long)]
    rows_only: bool,
    /// Print the counts as JSON
    #[arg(short, long)]
    json: bool,
    /// Print nothing, and no progress; messages of errors and the exit code stay
    #[arg(short, long)]
    quiet: bool,
}

/// Runs the command.
pub fn add(arguments: &Add) -> Result<Outcome, Error> {
    let results = matching_paths(&arguments.results)?;
    wait_for_store(&arguments.store, &say_waiting)?;
    let added = progress::counting("reading {pos} results, {elapsed}", None, arguments.quiet, |progress| {
        add_results(&arguments.store, &results, arguments.rows_only, progress)
    })?;
    match (arguments.json, arguments.quiet) {
        (true, _) => print(&AddedReport::of(added.new, added.known).to_json()?)?,
        (false, false) => print(&format!("{} new, {} known\n", added.new, added.known))?,
        (false, true) => {}
    }
    Ok(Outcome::Done)
}

/// List the calibrations of a store by unit and day.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical history list store --serial 0001")]
pub struct List {
    /// Folder of the store
    store: PathBuf,
    /// List units of this model alone
    #[arg(long)]
    model: Option<String>,
    /// List units of this serial number alone
    #[arg(long)]
    serial: Option<String>,
    /// List calibrations of this station alone
    #[arg(long)]
    station: Option<String>,
    /// Name probable mistakes: one unit under two names, one session twice, days to come, copies that are missing or changed
    #[arg(long)]
    check: bool,
    #[command(flatten)]
    printing: Printing,
}

/// Runs the command. Exit code 1 when a check finds something.
pub fn list(arguments: &List) -> Result<Outcome, Error> {
    let selection = Selection {
        unit_model: arguments.model.clone(),
        unit_serial: arguments.serial.clone(),
        station: arguments.station.clone(),
        ..Selection::default()
    };
    let names_any = selection.names_any();
    let list = if arguments.check {
        check_store(&arguments.store, selection, &unwatched)?
    } else {
        list_store(&arguments.store, selection, &unwatched)?
    };
    if names_any && list.calibrations.is_empty() {
        let expected = "a calibration, as --model, --serial and --station ask for";
        return Err(Error::content(&arguments.store, Place::Whole, "no such calibration", expected));
    }
    arguments.printing.show(|| history_list_text(&list), || list.to_json())?;
    Ok(Outcome::acceptable(list.doubts.is_none_or(|doubts| doubts.is_empty())))
}

/// Write the pages of a store: the list of its calibrations, and a page for each model of units, each station, and each unit with
/// two calibrations or more.
///
/// Lists are sorted and filtered in the browser, without a server. A later run leaves the pages of units without a new calibration as they are.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical history page store --out pages --limit '300 ug'")]
pub struct Page {
    /// Folder of the store
    store: PathBuf,
    /// Folder of the pages; index.html is the first
    #[arg(short, long)]
    out: PathBuf,
    #[command(flatten)]
    options: PageOptions,
    /// Print nothing
    #[arg(short, long)]
    quiet: bool,
}

/// What the pages of a store show beside its calibrations.
#[derive(Debug, Clone, clap::Args)]
pub struct PageOptions {
    /// Of a store: largest error of a compensated reading, for the due dates: '300 ug'
    #[arg(long, value_parser = largest_error)]
    limit: Option<f64>,
    /// Of a store: file with limits of parameters ([decision]), for Cp, Cpk and the drawings
    #[arg(long, value_name = "FILE")]
    laboratory: Option<PathBuf>,
    /// Of a store: table with the columns serial and batch, as text; batches are compared
    #[arg(long, value_name = "FILE")]
    batches: Option<PathBuf>,
    /// Of a store: acceptable sessions whose values give the limits of control charts
    #[arg(long, default_value_t = 20)]
    accepted: usize,
}

impl PageOptions {
    /// The request for the pages.
    pub fn request(&self) -> PagesRequest {
        PagesRequest {
            limit: self.limit,
            laboratory: self.laboratory.clone(),
            batches: self.batches.clone(),
            accepted: self.accepted,
        }
    }
}

/// Runs the command.
pub fn page(arguments: &Page) -> Result<Outcome, Error> {
    let pages = write_history_pages(&arguments.store, &arguments.out, &arguments.options.request(), &unwatched)?;
    if !arguments.quiet {
        print(&format!("{pages} pages written to {}, index.html first\n", arguments.out.display()))?;
    }
    Ok(Outcome::Done)
}
