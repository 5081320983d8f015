//! The request for a draft, and its text with marks: found, guessed, to be filled in.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use centrical_table::harmless_line;

use crate::document::{DraftReport, LineToFillIn};
use crate::error::{Error, Place};

/// What `experiment.toml` is to be drafted from.
#[derive(Debug, Clone, PartialEq)]
pub struct InitRequest {
    /// Files of records and telemetry, or folders of them.
    pub inputs: Vec<PathBuf>,
    /// The experiment file that will be written, if one is. It names the others relative to its folder.
    pub out: Option<PathBuf>,
    /// Folder of a tumble of the unit: its scale and bias, gravity, and its rests are taken.
    pub tumble: Option<PathBuf>,
    /// Whether to write the source's six positions out where the files do not show the positions.
    pub six_positions: bool,
}

impl InitRequest {
    /// The folder of the experiment file; the current one if it is not written.
    pub(super) fn folder(&self) -> &Path {
        let folder = self.out.as_deref().and_then(Path::parent);
        folder.filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
    }

    /// Refuses an experiment file that is there.
    pub(super) fn refuse_existing(&self) -> Result<(), Error> {
        let Some(file) = self.out.as_ref().filter(|file| file.exists()) else { return Ok(()) };
        let expected = "a new file: no draft replaces what was written";
        Err(Error::content(file, Place::Whole, "a file that exists", expected))
    }
}

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
    /// The draft as a JSON document, written to `file` if to any.
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

/// The path as the experiment file names it, with slashes.
pub(super) fn relative(path: &Path, folder: &Path) -> String {
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let (path, folder) = (absolute(path), absolute(folder));
    let path = path.strip_prefix(&folder).map(Path::to_owned).unwrap_or(path);
    path.components()
        .map(|c| c.as_os_str().to_string_lossy().into_owned())
        .collect::<Vec<_>>()
        .join("/")
        .replace("//", "/")
}
