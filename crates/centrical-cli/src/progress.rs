//! A bar for a person who waits; nothing when the output is not a terminal.

use centrical_session::Session;
use indicatif::{ProgressBar, ProgressStyle};

/// A bar over the records of a session, each read twice, on standard error. indicatif hides it when that is not a
/// terminal.
pub fn reading(session: &Session) -> ProgressBar {
    const TEMPLATE: &str = "reading {bar:30} {percent}% of two passes, {bytes_per_sec}, {eta} left";
    let bar = ProgressBar::new(2 * session.record_bytes());
    if let Ok(style) = ProgressStyle::with_template(TEMPLATE) {
        bar.set_style(style);
    }
    bar
}

/// A bar over `count` mountings on standard error. indicatif hides it when that is not a terminal.
pub fn mountings(doing: &str, count: usize) -> ProgressBar {
    let bar = ProgressBar::new(count as u64);
    if let Ok(style) = ProgressStyle::with_template("{msg} {bar:30} {pos}/{len} mountings, {eta} left") {
        bar.set_style(style);
        bar.set_message(doing.to_owned());
    }
    bar
}

/// A bar over `count` calibrations on standard error.
pub fn calibrations(count: usize) -> ProgressBar {
    let bar = ProgressBar::new(count as u64);
    if let Ok(style) = ProgressStyle::with_template("calibrating {bar:30} {pos}/{len}, {eta} left") {
        bar.set_style(style);
    }
    bar
}
