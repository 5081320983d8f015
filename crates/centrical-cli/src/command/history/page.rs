//! `centrical history page STORE --out DIR`: the pages of a store.

use std::path::PathBuf;

use centrical_report::{PagesRequest, write_history_pages};
use centrical_session::{Error, unwatched};

use crate::given::largest_error;
use crate::outcome::Outcome;
use crate::output::print;

/// Write the pages of a store: the list of its calibrations, and a page for each model of units, each station, and each unit with
/// two calibrations or more.
///
/// Lists are sorted and filtered in the browser, without a server. A later run leaves the pages of units without a new calibration as they are.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical history page store --out pages --limit '300 ug'")]
pub struct Arguments {
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
    /// What is asked of the pages.
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
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let pages = write_history_pages(&arguments.store, &arguments.out, &arguments.options.request(), &unwatched)?;
    if !arguments.quiet {
        print(&format!("{pages} pages written to {}, index.html first\n", arguments.out.display()))?;
    }
    Ok(Outcome::Done)
}
