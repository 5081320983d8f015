//! A bar for a person who waits; nothing when the output is not a terminal.

use std::ops::ControlFlow;

use crate::output::Printing;
use centrical_session::Session;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar over the records of a session, each read twice.
pub fn reading(session: &Session, printing: Printing) -> ProgressBar {
    let template = "reading {bar:30} {percent}% of two passes, {bytes_per_sec}, {eta} left";
    bar(template, Some(2 * session.record_bytes()), printing.quiet)
}

/// A bar over `count` mountings that are simulated.
pub fn mountings(count: usize, printing: Printing) -> ProgressBar {
    bar("simulating {bar:30} {pos}/{len} mountings, {eta} left", Some(count as u64), printing.quiet)
}

/// A bar over `count` calibrations.
pub fn calibrations(count: usize, printing: Printing) -> ProgressBar {
    bar("calibrating {bar:30} {pos}/{len}, {eta} left", Some(count as u64), printing.quiet)
}

/// A bar over `count` sessions.
pub fn sessions(count: usize, printing: Printing) -> ProgressBar {
    bar("calibrating {bar:30} {pos}/{len} sessions, {eta} left", Some(count as u64), printing.quiet)
}

/// A count of results: how many there are shows as folders are read.
pub fn results(quiet: bool) -> ProgressBar {
    bar("reading {pos} results, {elapsed}", None, quiet)
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

/// A bar on standard error, or none for a quiet command. indicatif hides it when that is not a terminal.
fn bar(template: &str, length: Option<u64>, quiet: bool) -> ProgressBar {
    let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let bar = ProgressBar::with_draw_target(length, target);
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar
}
