//! A bar for a person who waits while a job is done; nothing when the output is not a terminal.

use std::ops::ControlFlow;

use centrical_session::{Error, OnProgress, Session};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::output::Printing;

/// Does a job that reads each record of a session twice.
pub fn reading<T>(
    session: &Session,
    printing: Printing,
    job: impl FnOnce(OnProgress) -> Result<T, Error>,
) -> Result<T, Error> {
    let template = "reading {bar:30} {percent}% of two passes, {bytes_per_sec}, {eta} left";
    under(template, Some(2 * session.record_bytes()), printing.quiet, job)
}

/// Does a job that counts its pieces, `all` of them if their number is known.
pub fn counting<T>(
    template: &str,
    all: Option<usize>,
    quiet: bool,
    job: impl FnOnce(OnProgress<usize>) -> Result<T, Error>,
) -> Result<T, Error> {
    under(template, all.map(|all| all as u64), quiet, |progress| job(&|count| progress(count as u64)))
}

/// Does a job under a bar on standard error, or under none for a quiet command. indicatif hides it when that is not a terminal.
fn under<T>(
    template: &str,
    all: Option<u64>,
    quiet: bool,
    job: impl FnOnce(OnProgress) -> Result<T, Error>,
) -> Result<T, Error> {
    let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let bar = ProgressBar::with_draw_target(all, target);
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    let done = job(&|done| {
        bar.inc(done);
        ControlFlow::Continue(())
    })?;
    bar.finish_and_clear();
    Ok(done)
}
