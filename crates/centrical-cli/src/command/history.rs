//! `centrical history ...`: many calibrations.

mod chart;
mod choice;
mod station;
mod store;
mod unit;
mod units;

use centrical_session::Error;

#[cfg(feature = "serve")]
pub use self::store::PageOptions;
use crate::output::Outcome;

/// Keep calibrations in a store; a unit over the years, units beside each other, a station over its sessions, control charts.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical history unit store --serial 0042")]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, clap::Subcommand)]
enum Command {
    Add(store::Add),
    List(store::List),
    Unit(unit::Arguments),
    Units(units::Arguments),
    Station(station::Arguments),
    Chart(chart::Arguments),
    Page(store::Page),
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    match &arguments.command {
        Command::Add(arguments) => store::add(arguments),
        Command::List(arguments) => store::list(arguments),
        Command::Unit(arguments) => unit::run(arguments),
        Command::Units(arguments) => units::run(arguments),
        Command::Station(arguments) => station::run(arguments),
        Command::Chart(arguments) => chart::run(arguments),
        Command::Page(arguments) => store::page(arguments),
    }
}
