//! `centrical simulate PLAN --truth T.toml --seed N --out SESSION`: a session as a laboratory would deliver it.

use std::path::PathBuf;

use centrical_report::Screen;
use centrical_session::{Error, Session, SimulationReport, Truth, simulate_session};

use crate::given::Format;
use crate::output::{Outcome, Printing};
use crate::progress;

/// Simulate a session: records, telemetry and experiment.toml, with truth.json beside them.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical simulate schedule.toml --truth truth.toml --seed 1 --out session")]
pub struct Arguments {
    /// The plan: an experiment.toml, or the folder that holds it; its mountings need not name records
    plan: PathBuf,
    /// Truth file: the unit's true parameters and the equipment's errors
    #[arg(long, value_name = "TOML")]
    truth: PathBuf,
    /// Random seed
    #[arg(long, value_name = "N")]
    seed: u64,
    /// Folder for the session, created if absent
    #[arg(short, long, value_name = "DIR")]
    out: PathBuf,
    /// Format of records and telemetry
    #[arg(long, value_enum, default_value_t)]
    format: Format,
    #[command(flatten)]
    printing: Printing,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let plan = Session::read(&arguments.plan)?;
    let truth = Truth::read(&arguments.truth, &plan, arguments.seed)?;
    let plan = &truth.plan;
    let records = plan.planned_records();
    let template = "simulating {bar:30} {pos}/{len} mountings, {eta} left";
    progress::counting(template, Some(records), arguments.printing.quiet, |progress| {
        simulate_session(&truth, arguments.seed, arguments.format.into(), &arguments.out, progress)
    })?;
    arguments
        .printing
        .show(Screen::default, || SimulationReport::of(plan, arguments.seed, &arguments.out).to_json())?;
    Ok(Outcome::Done)
}
