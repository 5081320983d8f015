//! `centrical history page STORE --out DIR`: the pages of a store.

use std::path::PathBuf;

use centrical_report::write_history_pages;
use centrical_session::Error;

use crate::command::compensate::acceleration;
use crate::outcome::Outcome;
use crate::output::print;

/// Write the pages of a store: the list of its calibrations, a page for each unit with two or more, and for each station.
///
/// The list is sorted and filtered in the browser, without a server.
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

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let pages = write_history_pages(&arguments.store, &arguments.out, arguments.limit)?;
    if !arguments.quiet {
        print(&format!("{pages} pages written to {}, index.html first\n", arguments.out.display()))?;
    }
    Ok(Outcome::Done)
}
