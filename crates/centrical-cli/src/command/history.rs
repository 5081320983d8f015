//! `centrical history ...`: many calibrations, a subcommand a file.

mod add;
mod chart;
mod choice;
mod list;
mod page;
mod station;
mod unit;
mod units;

use centrical_session::Error;

pub use self::page::PageOptions;
use crate::outcome::Outcome;

/// Keep calibrations in a store; a unit over the years, units beside each other, a station over its sessions, control charts.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical history unit store --serial 0042")]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, clap::Subcommand)]
enum Command {
    Add(add::Arguments),
    List(list::Arguments),
    Unit(unit::Arguments),
    Units(units::Arguments),
    Station(station::Arguments),
    Chart(chart::Arguments),
    Page(page::Arguments),
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    match &arguments.command {
        Command::Add(arguments) => add::run(arguments),
        Command::List(arguments) => list::run(arguments),
        Command::Unit(arguments) => unit::run(arguments),
        Command::Units(arguments) => units::run(arguments),
        Command::Station(arguments) => station::run(arguments),
        Command::Chart(arguments) => chart::run(arguments),
        Command::Page(arguments) => page::run(arguments),
    }
}
