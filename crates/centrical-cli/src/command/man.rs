//! `centrical man --out DIR`: the manual pages.

use std::path::PathBuf;

use crate::output::{Outcome, print};
use centrical_session::{Error, create_folder, write_whole};
use clap_mangen::Man;

/// Write the manual pages: centrical.1, and a page for each command.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical man --out ~/.local/share/man/man1")]
pub struct Arguments {
    /// Folder for the pages, created if absent
    #[arg(short, long, value_name = "DIR")]
    out: PathBuf,
    /// Print nothing; messages of errors and the exit code stay
    #[arg(short, long)]
    quiet: bool,
}

/// Runs the command on the description of the program.
pub fn run(arguments: &Arguments, program: clap::Command) -> Result<Outcome, Error> {
    let mut program = program.disable_help_subcommand(true);
    program.build();
    create_folder(&arguments.out)?;
    let pages: Vec<clap::Command> = program.get_subcommands().chain([&program]).cloned().collect();
    let count = pages.len();
    for page in pages {
        let page = Man::new(page);
        let file = arguments.out.join(page.get_filename());
        let mut roff = Vec::new();
        page.render(&mut roff).map_err(|error| Error::writing(&file, error))?;
        write_whole(&file, &roff)?;
    }
    if !arguments.quiet {
        print(&format!("{count} pages written to {}\n", arguments.out.display()))?;
    }
    Ok(Outcome::Done)
}
