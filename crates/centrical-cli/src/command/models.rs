//! `centrical models SESSION`: which error model the data support.

use std::path::PathBuf;

use centrical_report::selection_table;
use centrical_session::{Error, Session, select_model};

use crate::outcome::Outcome;
use crate::output::show;
use crate::progress;

/// Fit rival models to a session and compare them by F test, BIC and hold-out.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The session folder, or its experiment.toml
    session: PathBuf,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let session = Session::read(&arguments.session)?;
    let bar = progress::reading(&session);
    let selection = select_model(&session, &|bytes| bar.inc(bytes))?;
    bar.finish_and_clear();
    show(&selection_table(&selection))?;
    Ok(Outcome::Done)
}
