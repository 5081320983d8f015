//! A bar for a person who waits; nothing when the output is not a terminal.

use indicatif::{ProgressBar, ProgressStyle};

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
