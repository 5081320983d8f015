//! `centrical history station RESULT|FOLDER...`: one centrifuge over its sessions.

use centrical_report::station_history_text;
use centrical_session::{Depth, Error, station_history};

use super::choice::Choice;
use crate::output::{Outcome, Printing};

/// One centrifuge over its sessions: a tilt, turn or shift that drifts or has changed.
///
/// Every session estimates the geometry, which belongs to the machine. What a unit brings along is left out where units came more than
/// once.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical history station results --station 'north hall'")]
pub struct Arguments {
    #[command(flatten)]
    choice: Choice,
    #[command(flatten)]
    printing: Printing,
}

/// Runs the command. Exit code 1 when a parameter of the machine changes.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let choice = &arguments.choice;
    let calibrations = choice.read(Depth::Values)?;
    let report = station_history(&calibrations).map_err(|none| none.of(&choice.results))?;
    arguments.printing.show(|| station_history_text(&report), || report.to_json())?;
    Ok(Outcome::acceptable(report.is_steady != Some(false)))
}
