//! `centrical init FILES... --out experiment.toml`: an experiment file from what the files show.

use std::path::{Path, PathBuf};

use crate::output::{Outcome, Printing, print};
use centrical_report::Screen;
use centrical_session::{Draft, Error, InitRequest, init, unwatched, write_whole};
use clap::ValueEnum;

/// Draft experiment.toml from records and telemetry: what the files show, what is likely, and what only a person knows.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical init records/ telemetry/ --out experiment.toml")]
pub struct Arguments {
    /// Records and telemetry, or folders of them
    #[arg(required = true, value_name = "FILE|FOLDER")]
    inputs: Vec<PathBuf>,
    /// The experiment file to write; a file that exists is not overwritten. Without it the draft is printed
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Folder of a tumble of the unit: its scale and bias, gravity, serial number and rests are taken
    #[arg(long, value_name = "DIR")]
    tumble: Option<PathBuf>,
    /// Positions to write out where the readings do not show them
    #[arg(long, value_name = "PRESET")]
    positions: Option<Positions>,
    #[command(flatten)]
    printing: Printing,
}

/// Positions written out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Positions {
    /// The six positions of the source
    Six,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let six_positions = arguments.positions == Some(Positions::Six);
    let (inputs, out, tumble) = (arguments.inputs.clone(), arguments.out.clone(), arguments.tumble.clone());
    let draft = init(&InitRequest { inputs, out, tumble, six_positions }, &unwatched)?;
    if let Some(file) = &arguments.out {
        write_whole(file, draft.text.as_bytes())?;
    }
    match &arguments.out {
        // Without a file the draft itself is what was asked for.
        None if !arguments.printing.json => print(&draft.text)?,
        file => arguments.printing.show(
            || file.as_deref().map_or_else(Screen::default, |file| summary(file, &draft)),
            || draft.report(file.as_deref()).to_json(),
        )?,
    }
    Ok(Outcome::Done)
}

/// What remains to be done.
fn summary(file: &Path, draft: &Draft) -> Screen {
    let mut screen = Screen::default();
    let text = format!(
        "Written to {}. Guesses to check: {}. Lines to fill in: {}",
        file.display(),
        draft.guesses,
        draft.fill_in.len()
    );
    screen.say(0, &text);
    for entry in &draft.fill_in {
        screen.say(2, &format!("line {}: {}: {}", entry.line, entry.key, entry.reason));
    }
    for file in &draft.unused {
        screen.say(2, &format!("not used: {file}"));
    }
    screen.say(0, &format!("Then: centrical calibrate {}", file.display()));
    screen
}
