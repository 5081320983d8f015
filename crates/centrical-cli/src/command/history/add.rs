//! `centrical history add STORE RESULT...`: results into a store.

use std::path::PathBuf;

use centrical_session::{AddedReport, Error, add_results, matching_paths};

use crate::outcome::Outcome;
use crate::output::print;
use crate::progress;

/// Add results to a store, which is made if it is not there. Results that it has are left as they are.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical history add store results/a results/b/result.json")]
pub struct Arguments {
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
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let bar = progress::results(arguments.quiet);
    let added = add_results(
        &arguments.store,
        &matching_paths(&arguments.results)?,
        arguments.rows_only,
        &progress::counting(&bar),
    )?;
    bar.finish_and_clear();
    match (arguments.json, arguments.quiet) {
        (true, _) => print(&AddedReport::of(added.new, added.known).to_json()?)?,
        (false, false) => print(&format!("{} new, {} known\n", added.new, added.known))?,
        (false, true) => {}
    }
    Ok(Outcome::Done)
}
