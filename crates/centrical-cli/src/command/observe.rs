//! `centrical observe SESSION|PLAN.toml`: what an experiment can see, why not more, and what would help.

use std::io::{self, Write};
use std::path::PathBuf;

use centrical_report::observation_text;
use centrical_session::{Design, Error, ObservationReport};

use crate::Outcome;

/// Tell what an experiment can see, before or after it is made: rank, lost combinations, reasons, remedies.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The session folder, its experiment.toml, or a plan: the same form without records, or a preset
    design: PathBuf,
    /// Print the report as JSON instead of text
    #[arg(long)]
    json: bool,
    /// A linear combination of parameters to look for, such as "dR_2[A] + drho_22"; may be given several times
    #[arg(long, value_name = "SUM", allow_hyphen_values = true)]
    combination: Vec<String>,
}

/// Runs the command. Not acceptable: an instrument's parameter is lost, or the rank is a matter of rounding.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let design = Design::read(&arguments.design, &|_| ())?;
    let report = ObservationReport::of(&design, &arguments.combination)?;
    let text = if arguments.json { report.to_json() } else { observation_text(&report) };
    // A reader that has seen enough (`| head`) is no failure.
    let _ = io::stdout().write_all(text.as_bytes());
    let is_lost = report.parameters.iter().any(|p| p.of_instrument && !p.estimable);
    Ok(if is_lost || report.doubtful { Outcome::NotAcceptable } else { Outcome::Done })
}
