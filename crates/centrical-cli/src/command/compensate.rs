//! `centrical compensate RESULT RECORD --out FILE`: from readings to specific force.

use std::path::PathBuf;

use centrical_report::{compensation_text, objections_text};
use centrical_session::{Axes, CompensationRequest, Error, compensate, unwatched};

use crate::given::force_range;
use crate::output::{Outcome, Printing};

/// Convert a record of readings to specific force with a calibration result.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example: centrical compensate results/result.json flight.csv --out forces.parquet --range '120 g'"
)]
pub struct Arguments {
    /// The result of a calibration: result.json
    result: PathBuf,
    /// The record: CSV or Parquet with t [s] and f1, f2, f3 in the unit of the calibration's records, unless --session says otherwise
    record: PathBuf,
    /// Output file: Parquet if its name ends in .parquet or .pq, CSV otherwise
    #[arg(short, long, value_name = "FILE")]
    out: PathBuf,
    /// The session whose experiment.toml names the record's columns and units
    #[arg(long, value_name = "SESSION")]
    session: Option<PathBuf>,
    /// Largest specific force on each axis, such as "200 g"; readings beyond it become nan
    /// [default: twice the largest plateau reading of the calibration, or less where the inverse is not certified so far, but no less than that reading]
    #[arg(long, value_name = "QUANTITY", value_parser = force_range)]
    range: Option<f64>,
    /// Refuse a record whose readings exceed those of the calibration by more than a hundredth, and write nothing
    #[arg(long)]
    within_calibration: bool,
    /// Axes of the specific forces: lower, upper, symmetric, case, or a file with [axes] [default: those of the result]
    #[arg(long, value_name = "AXES|FILE")]
    axes: Option<String>,
    #[command(flatten)]
    printing: Printing,
}

/// Runs the command. Exit code 1 when a reading is out of range, or there is an objection to the calibration.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let request = CompensationRequest {
        result: arguments.result.clone(),
        record: arguments.record.clone(),
        out: arguments.out.clone(),
        session: arguments.session.clone(),
        range: arguments.range,
        within_calibration: arguments.within_calibration,
        axes: arguments.axes.as_deref().map(Axes::from),
    };
    let (compensated, certificate, objections) = compensate(&request, &unwatched)?;
    let text = || {
        let mut screen = compensation_text(&compensated, &certificate, &arguments.out);
        screen.add(objections_text(&objections));
        screen
    };
    arguments.printing.show(text, || compensated.report(&request, &certificate, &objections).to_json())?;
    Ok(Outcome::acceptable(compensated.outside.count == 0 && objections.is_empty()))
}
