//! What a command prints: text for people, a JSON document, or no more than was asked for.

use centrical_report::Screen;
use centrical_session::Error;

use crate::output::{print, show};

/// How a command prints.
#[derive(Debug, Clone, Copy, clap::Args)]
pub struct Printing {
    /// Print a JSON document instead of text; docs/json.md describes it
    #[arg(short, long)]
    pub json: bool,
    /// Print only what was asked for, without progress; messages of errors and the exit code stay
    #[arg(short, long)]
    pub quiet: bool,
}

impl Printing {
    /// Prints the JSON document if it was asked for, and the text unless the command is to be quiet.
    ///
    /// # Errors
    /// [`Error`] when the document cannot be made or standard output does not take it.
    pub fn show(
        self,
        text: impl FnOnce() -> Screen,
        json: impl FnOnce() -> Result<String, Error>,
    ) -> Result<(), Error> {
        match (self.json, self.quiet) {
            (true, _) => print(&json()?),
            (false, false) => show(&text()),
            (false, true) => Ok(()),
        }
    }
}
