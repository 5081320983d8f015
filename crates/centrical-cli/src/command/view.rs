//! `centrical view DIR|RESULT...`: finished work in browsers.

use std::path::PathBuf;

use centrical_live::{Results, Server};
use centrical_session::Error;

use crate::outcome::Outcome;
use crate::serving::{USUAL, remain, serve};

/// Show results in browsers without writing files: a list with verdicts, a report each, two compared; and the live page of a
/// watch whose folder it is.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical view results/")]
pub struct Arguments {
    /// Folders, which are searched for result.json, and results
    #[arg(num_args = 1.., required = true, value_name = "DIR|RESULT")]
    paths: Vec<PathBuf>,
    /// Address; other machines see the pages only where it is one that they reach
    #[arg(long, value_name = "ADDRESS", default_value = USUAL)]
    serve: String,
    /// A name of this machine by which browsers call it, beside localhost and addresses; may be repeated
    #[arg(long, value_name = "NAME")]
    serve_name: Vec<String>,
}

/// Runs the command, until Ctrl-C.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let site = Results::new(&arguments.paths)?;
    let url = serve(Server::bind(&arguments.serve, &arguments.serve_name)?, site)?;
    remain(&url);
    Ok(Outcome::Done)
}
