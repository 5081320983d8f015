//! `centrical history unit RESULT|FOLDER...`: one unit over the years.

use std::path::PathBuf;

use centrical_report::{unit_history_plots, unit_history_text, write_plots};
use centrical_session::{Date, Depth, Error, ParameterLimits, UnitHistoryRequest, unit_history_among};

use super::choice::Choice;
use crate::given::largest_error;
use crate::output::{Outcome, Printing};

/// One unit over the years: scatter between sessions, drift, forecast, due date.
///
/// Two calibrations show whether the unit was the same; three show a trend. With --together the scatter between sessions is the one that all
/// units of the type have in common, for units with few calibrations each.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical history unit results --serial 0042 --limit '300 ug' --out history")]
pub struct Arguments {
    #[command(flatten)]
    choice: Choice,
    /// Largest error of a compensated reading, for the due date: '300 ug'
    #[arg(short, long, value_parser = largest_error)]
    limit: Option<f64>,
    /// Day on which the limit is to hold [default: today]
    #[arg(long, value_name = "DAY")]
    on: Option<Date>,
    /// Day of the forecasts [default: a year after the last calibration]
    #[arg(short, long, value_name = "DAY")]
    until: Option<Date>,
    /// Probability of all intervals, and that of a reading within its limit
    #[arg(long, default_value_t = UnitHistoryRequest::COVERAGE)]
    confidence: f64,
    /// Take parameters as constant but for the scatter between sessions
    #[arg(long)]
    without_trend: bool,
    /// Take the scatter between sessions from all units of the model
    #[arg(long)]
    together: bool,
    /// Folder for a plot of each parameter
    #[arg(short, long)]
    out: Option<PathBuf>,
    #[command(flatten)]
    printing: Printing,
}

/// Runs the command. Exit code 1 when a reading may be beyond its limit on the day that is asked for, or the last calibration has an objection.
/// Scatter and drift are what a history measures, and no failure.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let choice = &arguments.choice;
    if !(arguments.confidence > 0.5 && arguments.confidence < 1.0) {
        return Err(choice.refuse(format!("--confidence {}", arguments.confidence), "a probability between 0.5 and 1"));
    }
    let read_of = if arguments.together { Choice { serial: None, ..choice.clone() } } else { choice.clone() };
    let calibrations = read_of.read(Depth::Whole)?;
    choice.remark_alike();
    let request = UnitHistoryRequest {
        trend: !arguments.without_trend,
        until: arguments.until,
        limit: arguments.limit,
        on: arguments.on,
        coverage: arguments.confidence,
    };
    let report = unit_history_among(calibrations, choice.serial.as_deref(), request);
    let report = report.map_err(|none| none.of(&choice.results))?;
    if let Some(folder) = &arguments.out {
        write_plots(folder, &unit_history_plots(&report, &ParameterLimits::default()), &choice.results)?;
    }
    arguments.printing.show(|| unit_history_text(&report), || report.to_json())?;
    Ok(Outcome::acceptable(report.is_acceptable()))
}
