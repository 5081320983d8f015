//! `centrical completions SHELL`: what a shell needs to complete commands and options.

use crate::output::{Outcome, print_as_it_is};
use centrical_session::Error;
use clap_complete::{Shell, generate};

/// Print the completions of commands and options for a shell; README.md says how to install them.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical completions bash > ~/.local/share/bash-completion/completions/centrical")]
pub struct Arguments {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

/// Runs the command on the description of the program.
pub fn run(arguments: &Arguments, program: &mut clap::Command) -> Result<Outcome, Error> {
    let mut script = Vec::new();
    generate(arguments.shell, program, "centrical", &mut script);
    print_as_it_is(&String::from_utf8_lossy(&script))?;
    Ok(Outcome::Done)
}
