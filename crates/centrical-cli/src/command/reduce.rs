//! `centrical reduce SESSION --out DIR`: from gigabytes of records to a session of plateau means.

use std::path::PathBuf;

use centrical_report::reduction_text;
use centrical_session::{Error, ReductionReport, Session, reduce_without_inputs, write_reduced};

use crate::given::Format;
use crate::output::{Outcome, Printing};
use crate::progress;

/// Reduce a session's records to plateau means: a session of a few kilobytes, calibrated to the same numbers.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical reduce examples/ta-200 --out reduced")]
pub struct Arguments {
    /// The session folder, or its experiment.toml
    session: PathBuf,
    /// Folder for experiment.toml and the table of plateaus, created if absent
    #[arg(short, long, value_name = "DIR")]
    out: PathBuf,
    /// Format of the table of plateaus: plateaus.csv or plateaus.parquet
    #[arg(long, value_enum, default_value_t)]
    format: Format,
    #[command(flatten)]
    printing: Printing,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let session = Session::read(&arguments.session)?;
    let (session, reduced) = progress::reading(&session, arguments.printing, |progress| {
        let (session, reduced) = reduce_without_inputs(&session, progress)?;
        write_reduced(&session, &reduced, None, arguments.format.into(), &arguments.out, progress)?;
        Ok((session, reduced))
    })?;
    let text = || reduction_text(&reduced, &arguments.out);
    arguments.printing.show(text, || ReductionReport::of(&session, &reduced, &arguments.out).to_json())?;
    Ok(Outcome::Done)
}
