//! `centrical compare A.json B.json`: two calibrations of one unit.

use std::path::PathBuf;

use centrical_report::comparison_table;
use centrical_session::{CalibrationResult, Error, compare_results};

use crate::outcome::Outcome;
use crate::output::show;

/// Compare two calibrations of one unit: differences over their uncertainties, drift, and a joint test.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The result.json of the first calibration
    first: PathBuf,
    /// The result.json of the second
    second: PathBuf,
    /// Years between the two, for the drift per year
    #[arg(long)]
    years: Option<f64>,
}

/// Runs the command. Exit code 1 when the two do not agree, or are not of one unit.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let (first, second) = (CalibrationResult::read(&arguments.first)?, CalibrationResult::read(&arguments.second)?);
    let compared = compare_results(&first, &second);
    show(&comparison_table(&first, &compared, arguments.years))?;
    Ok(Outcome::acceptable(compared.agree))
}
