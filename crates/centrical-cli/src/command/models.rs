//! `centrical models SESSION`: which error model the data support.

use std::path::PathBuf;

use centrical_report::selection_table;
use centrical_session::{Error, ModelsReport, Session, select_model};

use crate::output::{Outcome, Printing};
use crate::progress;

/// Fit rival models to a session and compare them by F test, BIC and hold-out.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical models examples/ta-200")]
pub struct Arguments {
    /// The session folder, or its experiment.toml
    session: PathBuf,
    #[command(flatten)]
    printing: Printing,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let session = Session::read(&arguments.session)?;
    let selection = progress::reading(&session, arguments.printing, |progress| select_model(&session, progress))?;
    let json = || ModelsReport::of(&selection, &session.title).to_json();
    arguments.printing.show(|| selection_table(&selection), json)?;
    Ok(Outcome::Done)
}
