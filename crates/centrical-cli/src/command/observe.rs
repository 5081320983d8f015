//! `centrical observe SESSION|PLAN.toml`: rank, undetermined combinations, causes, remedies.

use std::io::{self, Write};
use std::path::PathBuf;

use centrical_report::observation_text;
use centrical_session::{Error, ObservabilityReport, subject};

use crate::Outcome;

/// Analyse observability: rank, undetermined combinations, causes, remedies; before or after the experiment.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The session folder, its experiment.toml, or a plan: the same form without records, or a preset
    design: PathBuf,
    /// Print the report as JSON instead of text
    #[arg(long)]
    json: bool,
    /// A linear combination of parameters to examine, such as "dR_2[A] + drho_22"; may be repeated
    #[arg(long, value_name = "SUM", allow_hyphen_values = true)]
    combination: Vec<String>,
}

/// Runs the command. Not acceptable: an instrument's parameter is lost, or the rank is a matter of rounding.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let subject = subject(&arguments.design, &|_| ())?;
    let report = ObservabilityReport::of(&subject, &arguments.combination)?;
    let text = if arguments.json { report.to_json()? } else { observation_text(&report) };
    // A reader that has seen enough (`| head`) is no failure.
    let _ = io::stdout().write_all(text.as_bytes());
    Ok(if report.is_acceptable() { Outcome::Done } else { Outcome::NotAcceptable })
}
