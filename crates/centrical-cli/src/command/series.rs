//! `centrical series SESSION...`: many sessions on the cores of this machine.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::atomic::Ordering;

use centrical_report::Screen;
use centrical_session::{
    Error, FailedSession, Method, SeriesRequest, SeriesSummary, calibrate_series, matching_paths, wait_for_store,
};

use crate::interruption::asked_to_end;
use crate::output::{Outcome, Printing, print, remark, say_waiting};
use crate::progress;

/// Calibrate many sessions, one on each core, into a store and a table.
///
/// A session that fails becomes a row with its message. The same command resumes after an interruption: sessions whose files have not
/// changed are not calibrated again, and the table is the same. Exit code 2 when a session failed, 1 when a result is not acceptable.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical series examples/ta-200 --out series")]
pub struct Arguments {
    /// Session folders, or their experiment.toml; a pattern such as "2026-*/unit-?" stands for all that match
    #[arg(required = true, value_name = "SESSION")]
    sessions: Vec<PathBuf>,
    /// Folder for the store, series.parquet and series.csv, created if absent
    #[arg(short, long, value_name = "DIR")]
    out: PathBuf,
    /// Keep the rows alone, about 11 kB each, without result.json
    #[arg(long)]
    rows_only: bool,
    /// Keep each session reduced, some kB: a later model is fitted to it without the records
    #[arg(long)]
    reduced: bool,
    /// How a fit is computed
    #[arg(long, value_enum, default_value_t = SeriesMethod::Batch)]
    method: SeriesMethod,
    /// Sessions at a time [default: one per core]
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
    #[command(flatten)]
    printing: Printing,
}

/// How a fit is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum SeriesMethod {
    /// All plateaus at once
    Batch,
    /// The recursive filter, which gives the same estimates
    Recursive,
    /// The linear fit of [K5.3] alone
    Linear,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let request = SeriesRequest {
        out: arguments.out.clone(),
        method: match arguments.method {
            SeriesMethod::Batch => Method::Exact,
            SeriesMethod::Recursive => Method::Recursive,
            SeriesMethod::Linear => Method::Linear,
        },
        jobs: arguments.jobs,
        rows_only: arguments.rows_only,
        reduced: arguments.reduced,
    };
    let sessions = matching_paths(&arguments.sessions)?;
    wait_for_store(&arguments.out, &say_waiting)?;
    let template = "calibrating {bar:30} {pos}/{len} sessions, {eta} left";
    let asked = asked_to_end();
    let summary = progress::counting(template, Some(sessions.len()), arguments.printing.quiet, |progress| {
        calibrate_series(&sessions, &request, &|count| {
            let goes_on = progress(count);
            if asked.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { goes_on }
        })
    })?;
    remark(&failures(&summary));
    match (arguments.printing.json, arguments.printing.quiet) {
        (true, _) => print(&summary.to_json()?)?,
        (false, false) => print(&text(&summary, arguments))?,
        (false, true) => {}
    }
    Ok(Outcome::of_series(summary.failed, summary.not_acceptable))
}

/// The sessions that failed, which are errors: also for those who asked for quiet.
fn failures(summary: &SeriesSummary) -> Screen {
    let mut screen = Screen::default();
    for FailedSession { session, message } in summary.failures.iter().take(MOST_SHOWN) {
        screen.say(0, &format!("{session} failed: {message}"));
    }
    if summary.failed > MOST_SHOWN {
        screen.say(0, &format!("{} more sessions failed: series.csv has their messages", summary.failed - MOST_SHOWN));
    }
    screen
}

/// Failures that are shown one by one.
const MOST_SHOWN: usize = 10;

fn text(summary: &SeriesSummary, arguments: &Arguments) -> String {
    let table = arguments.out.join("series.parquet");
    format!(
        "{} sessions: {} acceptable, {} not acceptable, {} failed; {} known from before\nWritten to {}\n",
        summary.sessions,
        summary.acceptable,
        summary.not_acceptable,
        summary.failed,
        summary.known,
        table.display()
    )
}
