//! A text with marks: what was found, what is guessed, and what is to be filled in.

use std::fmt::Write;
use std::path::Path;

use centrical_table::harmless_line;

use crate::document::{DraftReport, LineToFillIn};

/// A drafted file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Draft {
    /// The text.
    pub text: String,
    /// The lines to be filled in, in their order.
    pub fill_in: Vec<LineToFillIn>,
    /// Number of guesses.
    pub guesses: usize,
    /// Files that are not used, and why.
    pub unused: Vec<String>,
}

/// Stands where a person has to write: the program refuses it by name, so that nothing is forgotten.
pub(super) const UNKNOWN: &str = "\"?\"";

impl Draft {
    /// The draft as a document, written to `file` if to any.
    pub fn report(&self, file: Option<&Path>) -> DraftReport {
        DraftReport::new(file, &self.text, self.guesses, self.fill_in.clone())
    }

    pub(super) fn line(&mut self, line: &str) {
        self.text.push_str(line);
        self.text.push('\n');
    }

    /// A line that the files show.
    pub(super) fn found(&mut self, line: &str, how: &str) {
        let _ = writeln!(self.text, "{line}  # FOUND: {how}");
    }

    /// A line that the files show; or one that is likely, for the reason of the guess.
    pub(super) fn shown(&mut self, guess: Option<&str>, line: &str, how: &str) {
        match guess {
            Some(why) => self.guess(line, why),
            None => self.found(line, how),
        }
    }

    /// A file that is not used, and why: one line, whatever its name holds.
    pub(super) fn unused(&mut self, file: &str) {
        let file = harmless_line(file);
        let _ = writeln!(self.text, "# NOT USED: {file}");
        self.unused.push(file.into_owned());
    }

    /// A line that is likely.
    pub(super) fn guess(&mut self, line: &str, why: &str) {
        self.guesses += 1;
        let _ = writeln!(self.text, "{line}  # GUESS: {why}");
    }

    /// A line to be completed.
    pub(super) fn fill_in(&mut self, key: &str, line: &str, reason: &str) {
        let _ = writeln!(self.text, "{line}  # FILL IN: {reason}");
        let line = self.text.lines().count();
        self.fill_in.push(LineToFillIn { line, key: key.to_owned(), reason: reason.to_owned() });
    }
}
