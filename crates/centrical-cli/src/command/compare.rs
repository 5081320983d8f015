//! `centrical compare RESULT RESULT...`: calibrations of one unit, two by two.

use std::path::PathBuf;

use centrical_report::{Language, comparison_plot, comparison_text};
use centrical_session::{CalibrationResult, ComparisonRequest, Error, compare_results, refuse_inputs, write_whole};

use crate::given::above_zero;
use crate::output::{Outcome, Printing};

/// Compare calibrations of one unit: differences over their uncertainties, drift, and a joint test.
///
/// Each result is compared with the one before it, and the last of more than two with the first.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical compare 2024/result.json 2025/result.json 2026/result.json --svg drift.svg")]
pub struct Arguments {
    /// Results of calibrations, in the order of time
    #[arg(num_args = 2.., required = true, value_name = "RESULT")]
    results: Vec<PathBuf>,
    /// Years between two results, for the drift per year [default: by the dates of their sessions]
    #[arg(long, value_parser = above_zero, allow_hyphen_values = true)]
    years: Option<f64>,
    /// Compare results of other units than the first; they do not agree, whatever their numbers
    #[arg(long)]
    other_units: bool,
    /// Write a plot of the differences over their expanded uncertainties
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    #[command(flatten)]
    printing: Printing,
}

/// Runs the command. Exit code 1 when two results do not agree, or are not of one unit.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let results = arguments.results.iter().map(|file| CalibrationResult::read(file));
    let results = results.collect::<Result<Vec<_>, Error>>()?;
    let named: Vec<_> = arguments.results.iter().map(PathBuf::as_path).zip(&results).collect();
    let request = ComparisonRequest { years: arguments.years, other_units: arguments.other_units };
    let report = compare_results(&named, request)?;
    if let Some(file) = &arguments.svg {
        refuse_inputs(std::slice::from_ref(file), &arguments.results)?;
        write_whole(file, comparison_plot(&report, Language::English).as_bytes())?;
    }
    arguments.printing.show(|| comparison_text(&report, Language::English), || report.to_json())?;
    Ok(Outcome::acceptable(report.agree))
}
