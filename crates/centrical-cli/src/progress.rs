//! A bar for a person who waits; nothing when the output is not a terminal.

use std::ops::ControlFlow;

use centrical_session::Session;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::printing::Printing;

/// A bar over the records of a session, each read twice, on standard error. indicatif hides it when that is not a
/// terminal.
pub fn reading(session: &Session, printing: Printing) -> ProgressBar {
    const TEMPLATE: &str = "reading {bar:30} {percent}% of two passes, {bytes_per_sec}, {eta} left";
    let bar = bar(Some(2 * session.record_bytes()), printing.quiet);
    if let Ok(style) = ProgressStyle::with_template(TEMPLATE) {
        bar.set_style(style);
    }
    bar
}

/// A bar over `count` mountings on standard error. indicatif hides it when that is not a terminal.
pub fn mountings(doing: &str, count: usize, printing: Printing) -> ProgressBar {
    let bar = bar(Some(count as u64), printing.quiet);
    if let Ok(style) = ProgressStyle::with_template("{msg} {bar:30} {pos}/{len} mountings, {eta} left") {
        bar.set_style(style);
        bar.set_message(doing.to_owned());
    }
    bar
}

/// A bar over `count` calibrations on standard error.
pub fn calibrations(count: usize, printing: Printing) -> ProgressBar {
    let bar = bar(Some(count as u64), printing.quiet);
    if let Ok(style) = ProgressStyle::with_template("calibrating {bar:30} {pos}/{len}, {eta} left") {
        bar.set_style(style);
    }
    bar
}

/// A bar over `count` sessions on standard error.
pub fn sessions(count: usize, quiet: bool) -> ProgressBar {
    let bar = bar(Some(count as u64), quiet);
    if let Ok(style) = ProgressStyle::with_template("calibrating {bar:30} {pos}/{len} sessions, {eta} left") {
        bar.set_style(style);
    }
    bar
}

/// A count of results on standard error: how many there are shows as folders are read.
pub fn results(quiet: bool) -> ProgressBar {
    let bar = bar(None, quiet);
    if let Ok(style) = ProgressStyle::with_template("reading {pos} results, {elapsed}") {
        bar.set_style(style);
    }
    bar
}

/// Moves a bar by what was done.
pub fn on(bar: &ProgressBar) -> impl Fn(u64) -> ControlFlow<()> + Sync {
    |done| {
        bar.inc(done);
        ControlFlow::Continue(())
    }
}

/// The same for what is counted in pieces.
pub fn counting(bar: &ProgressBar) -> impl Fn(usize) -> ControlFlow<()> + Sync {
    |count| on(bar)(count as u64)
}

/// A bar on standard error, or none for a quiet command.
fn bar(length: Option<u64>, quiet: bool) -> ProgressBar {
    let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    ProgressBar::with_draw_target(length, target)
}
