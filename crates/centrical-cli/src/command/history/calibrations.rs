//! `centrical history unit|units|station|chart RESULT|FOLDER...`: what many calibrations say.

use std::collections::BTreeSet;
use std::path::PathBuf;

use centrical_report::{
    Emphasis, Screen, chart_plots, chart_text, station_history_text, unit_history_plots, unit_history_text,
    units_history_text, write_plots,
};
use centrical_session::{
    Calibrated, ChartLimits, ChartRequest, ComparedUnits, Date, Depth, Error, ParameterLimits, Past, Place, RuleSet,
    Selection, UnitHistoryRequest, UnitsHistoryRequest, by_unit, chart_of_one, read_batches, read_calibrations,
    read_limits, spelling, station_history, unit_history_among, units_history, unwatched,
};

use crate::given::largest_error;
use crate::output::{Outcome, Printing, remark};

/// One unit over the years: scatter between sessions, drift, forecast, due date.
///
/// Two calibrations show whether the unit was the same; three show a trend. With --together the scatter between sessions is the one that all
/// units of the type have in common, for units with few calibrations each.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical history unit results --serial 0042 --limit '300 ug' --out history")]
pub struct Unit {
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
pub fn unit(arguments: &Unit) -> Result<Outcome, Error> {
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

/// Units of one type beside each other: distribution, outlying units, capability, batches.
///
/// A unit is outlying by its robust distance from the others over all parameters together. The probability stated is that of at least one
/// such distance in a plant of sound units.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical history units results --laboratory laboratory.toml --batches batches.csv")]
pub struct Units {
    #[command(flatten)]
    choice: Choice,
    /// File with limits of parameters ([decision]), for Cp and Cpk
    #[arg(short, long, value_name = "FILE")]
    laboratory: Option<PathBuf>,
    /// Table with the columns serial and batch, as text; batches are compared
    #[arg(short, long, value_name = "FILE")]
    batches: Option<PathBuf>,
    #[command(flatten)]
    printing: Printing,
}

/// Runs the command. Exit code 1 when a unit is outlying, drifts or scatters, or batches differ.
pub fn units(arguments: &Units) -> Result<Outcome, Error> {
    let choice = &arguments.choice;
    let calibrations = choice.read(Depth::Errors)?;
    let limits = arguments.laboratory.as_deref().map(|file| read_limits(file, &calibrations)).transpose()?;
    let batches = arguments.batches.as_deref().map(read_batches).transpose()?;
    let request = UnitsHistoryRequest { limits: limits.unwrap_or_default(), batches: batches.unwrap_or_default() };
    let report = ComparedUnits::of(by_unit(calibrations)).and_then(|compared| units_history(&compared, &request));
    let report = report.map_err(|none| none.of(&choice.results))?;
    arguments.printing.show(|| units_history_text(&report), || report.to_json())?;
    Ok(Outcome::acceptable(report.is_sound))
}

/// One centrifuge over its sessions: a tilt, turn or shift that drifts or has changed.
///
/// Every session estimates the geometry, which belongs to the machine. What a unit brings along is left out where units came more than
/// once.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical history station results --station 'north hall'")]
pub struct Station {
    #[command(flatten)]
    choice: Choice,
    #[command(flatten)]
    printing: Printing,
}

/// Runs the command. Exit code 1 when a parameter of the machine changes.
pub fn station(arguments: &Station) -> Result<Outcome, Error> {
    let choice = &arguments.choice;
    let calibrations = choice.read(Depth::Values)?;
    let report = station_history(&calibrations).map_err(|none| none.of(&choice.results))?;
    arguments.printing.show(|| station_history_text(&report), || report.to_json())?;
    Ok(Outcome::acceptable(report.is_steady != Some(false)))
}

/// Control charts of one parameter: individuals and moving range, EWMA, CUSUM.
///
/// A chart says where to look: where nothing changes, charts of 100 sessions with limits from 20 give a false signal in one of two. `history
/// units` and `history station` say what is certain.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical history chart alpha_1 results --accepted 25 --out charts")]
pub struct Chart {
    /// Name of a parameter: df_1, G0_11, alpha_1
    parameter: String,
    #[command(flatten)]
    choice: Choice,
    /// Acceptable sessions whose values give the limits
    #[arg(short, long, default_value_t = 20, conflicts_with = "centre")]
    accepted: usize,
    /// Mean of the process in control [SI], in place of that of accepted sessions
    #[arg(long, requires = "deviation", allow_hyphen_values = true)]
    centre: Option<f64>,
    /// Standard deviation from value to value [SI]
    #[arg(long, requires = "centre")]
    deviation: Option<f64>,
    /// Rules for single values
    #[arg(long, value_enum, default_value_t)]
    rules: Rules,
    /// Folder for the charts: individuals.svg, moving-ranges.svg, ewma.svg, cusum.svg
    #[arg(short, long)]
    out: Option<PathBuf>,
    #[command(flatten)]
    printing: Printing,
}

#[derive(Debug, Clone, Copy, Default, clap::ValueEnum)]
enum Rules {
    #[default]
    Nelson,
    WesternElectric,
}

/// Runs the command. Exit code 1 when a rule gives a signal.
pub fn chart(arguments: &Chart) -> Result<Outcome, Error> {
    let choice = &arguments.choice;
    let limits = match (arguments.centre, arguments.deviation) {
        (Some(centre), Some(deviation)) if centre.is_finite() && deviation > 0.0 && deviation.is_finite() => {
            ChartLimits::Stated(centre, deviation)
        }
        (Some(centre), Some(deviation)) => {
            let found = format!("--centre {centre} --deviation {deviation}");
            return Err(choice.refuse(found, "a finite centre and a positive finite deviation"));
        }
        _ => ChartLimits::Accepted(arguments.accepted),
    };
    let rules = match arguments.rules {
        Rules::Nelson => RuleSet::Nelson,
        Rules::WesternElectric => RuleSet::WesternElectric,
    };
    let request = ChartRequest { limits, rules, last: None };
    let calibrations = choice.read(Depth::Values)?;
    let report = chart_of_one(&calibrations, &arguments.parameter, request);
    let report = report.map_err(|none| none.of(&choice.results))?;
    if let Some(folder) = &arguments.out {
        write_plots(folder, &chart_plots(&report), &choice.results)?;
    }
    arguments.printing.show(|| chart_text(&report), || report.to_json())?;
    Ok(Outcome::acceptable(report.signals.is_empty()))
}

/// Results, and what they have to be of.
#[derive(Debug, Clone, clap::Args)]
pub struct Choice {
    /// Stores, results of calibrations, or folders of results: each result.json at any depth
    #[arg(required = true, value_name = "STORE|RESULT|FOLDER")]
    pub results: Vec<PathBuf>,
    /// Model of the unit
    #[arg(long)]
    pub model: Option<String>,
    /// Serial number of the unit
    #[arg(long)]
    pub serial: Option<String>,
    /// Centrifuge, as its sessions call it
    #[arg(long)]
    pub station: Option<String>,
}

impl Choice {
    /// The calibrations, in the order of time, read to a depth.
    pub fn read(&self, depth: Depth) -> Result<Vec<Calibrated>, Error> {
        let selection = Selection {
            depth,
            unit_model: self.model.clone(),
            unit_serial: self.serial.clone(),
            station: self.station.clone(),
            ..Selection::default()
        };
        let Past { calibrations, undated } = read_calibrations(&self.results, &selection, &unwatched)?;
        remark_undated(&undated);
        if calibrations.is_empty() {
            let alike = self.alike();
            let but = if alike.is_empty() { alike } else { format!(" but those of serial {alike}") };
            let asked = "results, as --model, --serial and --station ask for";
            let expected = if selection.names_any() { asked } else { "results" };
            return Err(self.refuse(format!("no such calibration{but}"), expected));
        }
        Ok(calibrations)
    }

    /// Remarks that calibrations of other serial numbers may be of the unit that is asked for.
    pub fn remark_alike(&self) {
        let alike = self.alike();
        if !alike.is_empty() {
            let mut screen = Screen::default();
            let words = format!("calibrations of serial {alike} are not taken: expected one name for one unit");
            screen.marked(Emphasis::Warning, "SPELLING", &words);
            remark(&screen);
        }
    }

    /// Other serial numbers that differ from the one asked for in spaces, hyphens, case, leading zeros or Cyrillic letters alone.
    fn alike(&self) -> String {
        let Some(asked) = &self.serial else { return String::new() };
        let wanted = spelling(asked);
        let all = read_calibrations(&self.results, &Selection::default(), &unwatched).unwrap_or_default().calibrations;
        let alike =
            all.iter().map(|c| c.unit_serial.as_str()).filter(|serial| *serial != asked && spelling(serial) == wanted);
        let alike: BTreeSet<String> = alike.map(|serial| format!("\"{serial}\"")).collect();
        alike.into_iter().collect::<Vec<_>>().join(", ")
    }

    /// An error of the choice as a whole.
    pub fn refuse(&self, found: String, expected: &str) -> Error {
        Error::content(&self.results[0], Place::Whole, found, expected)
    }
}

/// Remarks that no history has calibrations without a day for a date.
fn remark_undated(undated: &[String]) {
    let mut screen = Screen::default();
    for calibration in undated {
        screen.marked(
            Emphasis::Warning,
            "NO DAY",
            &format!("{calibration}, expected a day such as 2026-10-05: left out"),
        );
    }
    remark(&screen);
}
