//! `centrical plan PLAN.toml`: the best schedule for a time, or the shortest for target uncertainties.

use std::path::PathBuf;

use centrical_report::{frontier_plot, plan_text};
use centrical_session::{
    Error, PlanRequest, PredictionReport, USUAL_LEVELS, USUAL_TIMES, plan, unwatched, write_whole,
};

use crate::given::{available, level, probability};
use crate::output::{Outcome, Printing};

/// Find the schedule with the smallest uncertainty in the time available, or the shortest one that meets target
/// uncertainties.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical plan examples/plans/best.toml --out schedule.toml")]
pub struct Arguments {
    /// Plan file: an experiment.toml with [candidates], [cost] and [target] in place of mountings
    plan: PathBuf,
    /// Time available, in place of the one in the plan file: "8 h"
    #[arg(long, value_name = "TIME", value_parser = available)]
    time: Option<f64>,
    /// Write the schedule as a plan file for observe, montecarlo and simulate
    #[arg(short, long, value_name = "TOML")]
    out: Option<PathBuf>,
    /// Plan for other times too, and show uncertainty against time beside a uniform plan and [K5.5]
    #[arg(long)]
    frontier: bool,
    /// Draw uncertainty against time to this file
    #[arg(long, value_name = "SVG", requires = "frontier")]
    svg: Option<PathBuf>,
    /// Levels m of [K5.5] on the frontier
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_values_t = USUAL_LEVELS, value_parser = level)]
    levels: Vec<f64>,
    /// Search until the optimality gap over all sets of mountings is below 0.25 %; whole visits add to that gap
    #[arg(long)]
    certify: bool,
    /// Coverage probability of the expanded uncertainties
    #[arg(long, default_value_t = PredictionReport::COVERAGE, value_parser = probability)]
    coverage: f64,
    #[command(flatten)]
    printing: Printing,
}

/// Runs the command. Not acceptable: a parameter of the instrument is not determined, or a goal is missed.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let request = PlanRequest {
        time: arguments.time,
        certify: arguments.certify,
        frontier: if arguments.frontier { USUAL_TIMES.to_vec() } else { Vec::new() },
        levels: arguments.levels.clone(),
        coverage: arguments.coverage,
        outputs: arguments.out.iter().chain(&arguments.svg).cloned().collect(),
    };
    let report = plan(&arguments.plan, &request, &unwatched)?;
    if let Some(file) = &arguments.out {
        write_whole(file, report.session_text(&arguments.plan)?.as_bytes())?;
    }
    if let Some(file) = &arguments.svg {
        write_whole(file, frontier_plot(&report).as_bytes())?;
    }
    arguments.printing.show(|| plan_text(&report), || report.to_json())?;
    Ok(Outcome::acceptable(report.is_acceptable()))
}
