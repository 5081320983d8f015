//! `centrical history unit RESULT|FOLDER...`: one unit over the years.

use std::path::PathBuf;

use centrical_report::{unit_history_plots, unit_history_text, write_plots};
use centrical_session::{
    Calibrated, Date, Depth, Error, ParameterLimits, UnitHistoryRequest, by_unit, expected_day, several_units,
    unit_history,
};

use super::choice::Choice;
use crate::given::largest_error;
use crate::outcome::Outcome;
use crate::printing::Printing;

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
    /// Day on which that limit is to hold [default: today]
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
    let all = Choice { serial: None, ..choice.clone() };
    let is_meant = |serial: &str| choice.serial.as_ref().is_none_or(|wanted| wanted == serial);
    let (own, others): (Vec<_>, Vec<_>) = if arguments.together {
        by_unit(all.read(Depth::Whole)?).into_iter().partition(|unit| is_meant(&unit[0].unit_serial))
    } else {
        (by_unit(choice.read(Depth::Whole)?), Vec::new())
    };
    let [calibrations] = own.as_slice() else {
        return Err(choice.refuse(several_units(&own), "calibrations of one, by --serial and --model"));
    };
    let same_model = |unit: &Vec<Calibrated>| unit.first().is_some_and(|c| c.unit_model == calibrations[0].unit_model);
    let others: Vec<_> = others.into_iter().filter(same_model).collect();
    choice.remark_alike();
    for (option, asked) in [("--on", arguments.on), ("--until", arguments.until)] {
        if let Some((day, expected)) = asked.and_then(|day| Some((day, expected_day(day, calibrations)?))) {
            return Err(choice.refuse(format!("{option} {day}"), &expected));
        }
    }
    let request = UnitHistoryRequest {
        trend: !arguments.without_trend,
        until: arguments.until,
        limit: arguments.limit,
        on: Some(arguments.on.unwrap_or_else(Date::today)),
        coverage: arguments.confidence,
    };
    let report = unit_history(calibrations, &others, request).ok_or_else(|| {
        choice.refuse(format!("{} calibration", calibrations.len()), "two or more with a parameter in common")
    })?;
    if let Some(folder) = &arguments.out {
        write_plots(folder, &unit_history_plots(&report, &ParameterLimits::default()), &choice.results)?;
    }
    arguments.printing.show(|| unit_history_text(&report), || report.to_json())?;
    Ok(Outcome::acceptable(report.is_acceptable()))
}
