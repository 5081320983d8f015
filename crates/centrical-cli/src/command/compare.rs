//! `centrical compare A.json B.json`: two calibrations of one unit.

use std::io::{self, Write};
use std::path::PathBuf;

use centrical::uncertainty;
use centrical_report::comparison_table;
use centrical_session::{CalibrationResult, Error, customary};

use crate::Outcome;

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

/// Chance produces differences as large as these once in a hundred comparisons.
const CHANCE: f64 = 0.01;

/// Runs the command. Exit code 1 when the two do not agree.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let (first, second) = (CalibrationResult::read(&arguments.first)?, CalibrationResult::read(&arguments.second)?);
    let comparison = uncertainty::compare(&first.of_unit(), &second.of_unit());
    let customary_of = |name: &str| {
        let parameter = first.parameter(name);
        parameter.map_or((1.0, String::new()), |p| {
            let (factor, unit) = customary(&p.unit, p.group);
            (factor, unit.to_owned())
        })
    };
    let text = comparison_table(&comparison, &customary_of, arguments.years.filter(|years| *years != 0.0));
    let _ = io::stdout().write_all(text.as_bytes());
    let agree = comparison.probability.is_some_and(|probability| probability > CHANCE);
    Ok(if agree { Outcome::Done } else { Outcome::NotAcceptable })
}
