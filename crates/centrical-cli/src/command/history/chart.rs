//! `centrical history chart PARAMETER RESULT|FOLDER...`: control charts of one parameter.

use std::path::PathBuf;

use centrical_report::{chart_plots, chart_text, write_plots};
use centrical_session::{ChartLimits, ChartRequest, Depth, Error, RuleSet, chart_of_one};

use super::choice::Choice;
use crate::output::{Outcome, Printing};

/// Control charts of one parameter: individuals and moving range, EWMA, CUSUM.
///
/// A chart says where to look: where nothing changes, charts of 100 sessions with limits from 20 give a false signal in one of two. `history
/// units` and `history station` say what is certain.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical history chart alpha_1 results --accepted 25 --out charts")]
pub struct Arguments {
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
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
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
