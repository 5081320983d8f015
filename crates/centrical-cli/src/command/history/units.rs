//! `centrical history units RESULT|FOLDER...`: units of one type beside each other.

use std::path::PathBuf;

use centrical_report::units_history_text;
use centrical_session::{
    ComparedUnits, Depth, Error, UnitsHistoryRequest, by_unit, read_batches, read_limits, units_history,
};

use super::choice::Choice;
use crate::output::{Outcome, Printing};

/// Units of one type beside each other: distribution, outlying units, capability, batches.
///
/// A unit is outlying by its robust distance from the others over all parameters together. The probability stated is that of at least one
/// such distance in a plant of sound units.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical history units results --laboratory laboratory.toml --batches batches.csv")]
pub struct Arguments {
    #[command(flatten)]
    choice: Choice,
    /// File with limits of parameters ([decision]), for Cp and Cpk
    #[arg(short, long, value_name = "FILE")]
    laboratory: Option<PathBuf>,
    /// Table with the columns serial and batch, as text; batches are compared
    #[arg(short, long, value_name = "FILE")]
    batches: Option<PathBuf>,
    #[command(flatten)]
    printing: Printing,
}

/// Runs the command. Exit code 1 when a unit is outlying, drifts or scatters, or batches differ.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let choice = &arguments.choice;
    let calibrations = choice.read(Depth::Errors)?;
    let limits = arguments.laboratory.as_deref().map(|file| read_limits(file, &calibrations)).transpose()?;
    let batches = arguments.batches.as_deref().map(read_batches).transpose()?;
    let request = UnitsHistoryRequest { limits: limits.unwrap_or_default(), batches: batches.unwrap_or_default() };
    let report = ComparedUnits::of(by_unit(calibrations)).and_then(|compared| units_history(&compared, &request));
    let report = report.map_err(|none| none.of(&choice.results))?;
    arguments.printing.show(|| units_history_text(&report), || report.to_json())?;
    Ok(Outcome::acceptable(report.is_sound))
}
