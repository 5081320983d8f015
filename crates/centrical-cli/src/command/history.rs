//! `centrical history ...`: many calibrations.

mod chart;
mod choice;
mod station;
mod unit;
mod units;

use centrical_session::Error;

use crate::outcome::Outcome;

/// Many calibrations: a unit over the years, units beside each other, a station over its sessions, control charts.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, clap::Subcommand)]
enum Command {
    Unit(unit::Arguments),
    Units(units::Arguments),
    Station(station::Arguments),
    Chart(chart::Arguments),
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    match &arguments.command {
        Command::Unit(arguments) => unit::run(arguments),
        Command::Units(arguments) => units::run(arguments),
        Command::Station(arguments) => station::run(arguments),
        Command::Chart(arguments) => chart::run(arguments),
    }
}
