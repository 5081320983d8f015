//! `centrical observe SESSION|PLAN.toml`: rank, undetermined combinations, causes, remedies.

use std::path::PathBuf;

use crate::output::{Outcome, Printing};
use centrical_report::observation_text;
use centrical_session::{Error, ObservabilityReport, subject, unwatched};

/// Analyse observability: rank, undetermined combinations, causes, remedies; before or after the experiment.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example: centrical observe examples/plans/four-positions.toml --combination 'dR_2[A] + drho_22'"
)]
pub struct Arguments {
    /// The session folder, its experiment.toml, or a plan: the same form without records, or a preset
    #[arg(value_name = "SESSION|PLAN")]
    subject: PathBuf,
    /// A linear combination of parameters to examine, such as "dR_2[A] + drho_22"; may be repeated
    #[arg(long, value_name = "SUM", allow_hyphen_values = true)]
    combination: Vec<String>,
    #[command(flatten)]
    printing: Printing,
}

/// Runs the command. Not acceptable: a parameter of the instrument is undetermined, or the rank depends on rounding.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let subject = subject(&arguments.subject, &unwatched)?;
    let report = ObservabilityReport::of(&subject, &arguments.combination)?;
    arguments.printing.show(|| observation_text(&report), || report.to_json())?;
    Ok(Outcome::acceptable(report.is_acceptable()))
}
