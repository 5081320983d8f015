//! `centrical history add STORE RESULT...`: results into a store.

use std::path::PathBuf;

use centrical_session::{Error, add_results, unwatched};

use crate::outcome::Outcome;
use crate::output::print;

/// Add results to a store, which is made if it is not there. Results that it has are left as they are.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical history add store results/a results/b/result.json")]
pub struct Arguments {
    /// Folder of the store
    store: PathBuf,
    /// Results, or folders: every result.json in them and below
    #[arg(required = true, value_name = "RESULT")]
    results: Vec<PathBuf>,
    /// Keep the rows alone, about 11 kB each, without copies of result.json
    #[arg(long)]
    rows_only: bool,
    /// Print nothing; messages of errors and the exit code stay
    #[arg(short, long)]
    quiet: bool,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let added = add_results(&arguments.store, &arguments.results, arguments.rows_only, &unwatched)?;
    if !arguments.quiet {
        print(&format!("{} new, {} known\n", added.new, added.known))?;
    }
    Ok(Outcome::Done)
}
