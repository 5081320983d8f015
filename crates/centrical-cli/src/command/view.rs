//! `centrical view DIR|RESULT...`: finished work in browsers.

use std::path::PathBuf;

use centrical_live::{Results, Server, Stored};
use centrical_session::{Error, Place, Store};

use crate::command::history::PageOptions;
use crate::output::Outcome;
use crate::serving::{USUAL, remain, serve};

/// Show results in browsers without writing files: a list with verdicts, a report each, two compared. The folder of a watch shows
/// its live page. A store shows the pages of `history page`, which follow new calibrations.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical view results/")]
pub struct Arguments {
    /// Folders, which are searched for result.json, and results; or one store
    #[arg(num_args = 1.., required = true, value_name = "DIR|RESULT|STORE")]
    paths: Vec<PathBuf>,
    /// Address of the pages; other machines see them only where they can reach the address
    #[arg(long, value_name = "ADDRESS", default_value = USUAL)]
    serve: String,
    /// A name of this machine by which browsers call it, beside localhost and addresses; may be repeated
    #[arg(long, value_name = "NAME")]
    serve_name: Vec<String>,
    #[command(flatten)]
    options: PageOptions,
}

/// Runs the command, until Ctrl-C.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let bind = || Server::bind(&arguments.serve, &arguments.serve_name);
    let store = arguments.paths.iter().find(|path| Store::open(path).is_ok());
    let url = match (store, arguments.paths.as_slice()) {
        (None, paths) => {
            let site = Results::new(paths)?;
            serve(bind()?, site)?
        }
        (Some(_), [store]) => {
            let site = Stored::new(store, arguments.options.request())?;
            serve(bind()?, site)?
        }
        (Some(store), _) => {
            let expected = "this store alone, or folders of results and results";
            return Err(Error::content(store, Place::Whole, "a store among other paths", expected));
        }
    };
    remain(&url);
    Ok(Outcome::Done)
}
