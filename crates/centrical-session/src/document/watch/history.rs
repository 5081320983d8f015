//! `watch-history.jsonl`: one line for each plateau that has come, with all that was known after it; what plots of
//! convergence are made from.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::Path;

use centrical::MeasurementModel;
use centrical::fit::Progress;
use centrical::uncertainty::Test;
use centrical_table::write_whole;
use serde::{Deserialize, Serialize};

use crate::document::json;
use crate::error::Error;
use crate::settings::{from_json, read_result};

/// What was known after a plateau.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HistoryEntry {
    /// Number of the plateau among those that have come, from 1.
    pub plateau: usize,
    /// Index of the plateau in the schedule of all mountings, from 0.
    pub set_point: usize,
    /// Its test against the plateaus before it.
    pub innovation: InnovationSummary,
    /// Whether it does not fit.
    pub alarm: bool,
    /// Whether it was held out.
    pub held_out: bool,
    /// Rank so far.
    pub rank: usize,
    /// The unknowns in the order of results; null while they are not determined.
    pub estimates: Vec<HistoryEstimate>,
}

/// An unknown after a plateau.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HistoryEstimate {
    /// Name.
    pub name: String,
    /// Estimate, SI.
    pub value: Option<f64>,
    /// Its standard uncertainty, SI.
    pub standard_uncertainty: Option<f64>,
}

/// The test of a plateau.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct InnovationSummary {
    /// Normalised innovation squared.
    pub squared: f64,
    /// Combinations of the three readings that could be predicted.
    pub degrees_of_freedom: usize,
    /// Chance of one as large if the plateau fits.
    pub probability: f64,
}

impl From<Test> for InnovationSummary {
    fn from(Test { statistic, degrees_of_freedom, probability }: Test) -> Self {
        Self { squared: statistic, degrees_of_freedom, probability }
    }
}

impl HistoryEstimate {
    /// The unknowns of `model` by name.
    pub fn all(model: &MeasurementModel, progress: &Progress) -> Vec<Self> {
        let estimate = |(parameter, known): (&centrical::Parameter, &Option<(f64, f64)>)| Self {
            name: parameter.name.clone(),
            value: known.map(|(value, _)| value),
            standard_uncertainty: known.map(|(_, uncertainty)| uncertainty),
        };
        model.parameters().iter().zip(&progress.estimates).map(estimate).collect()
    }
}

impl HistoryEntry {
    /// The entry as its line of the history.
    ///
    /// # Errors
    /// [`Error::Json`] when a value has no place in JSON.
    pub fn line(&self) -> Result<String, Error> {
        json::line("watch-history.jsonl", self)
    }
}

/// Adds a line to the history.
///
/// # Errors
/// [`Error::Json`] when a value has no place in JSON, [`Error::Table`] when the file does not take it; it is as it was then.
pub(crate) fn append_history(file: &Path, entry: &HistoryEntry) -> Result<(), Error> {
    let line = json::line("watch-history.jsonl", entry)?;
    let mut open = OpenOptions::new();
    // Only a regular file is followed, not a link or a pipe.
    let is_other = fs::symlink_metadata(file).is_ok_and(|metadata| !metadata.is_file());
    let opened = if is_other {
        Err(io::Error::other("found a path that is not a regular file, expected the history or a free name"))
    } else {
        open.create(true).append(true).open(file)
    };
    let written = opened.and_then(|file| append(file, line.as_bytes()));
    written.map_err(|error| Error::writing(file, error))
}

fn append(mut file: File, line: &[u8]) -> io::Result<()> {
    let before = file.metadata()?.len();
    file.write_all(line).inspect_err(|_| {
        // Best effort: the first error is the one to tell.
        let _ = file.set_len(before);
    })
}

/// The lines that have their end: where a watch was killed or is just writing, the last one may have none yet.
fn ended(text: &str) -> &str {
    text.rfind('\n').map_or("", |end| &text[..=end])
}

/// Reads a history, without a line at its end that is there in part.
///
/// # Errors
/// [`Error`] when the file cannot be read or a line of it is not a state.
pub fn read_history(file: &Path) -> Result<Vec<HistoryEntry>, Error> {
    let expected = "the history of a watch";
    let text = read_result(file, expected)?;
    let entry = |(n, line): (usize, &str)| from_json(file, n + 1, line, expected);
    ended(&text).lines().enumerate().map(entry).collect()
}

/// Keeps the lines of the first `plateaus` and drops what a broken run may have written after them.
///
/// # Errors
/// [`Error::Table`] when the file can be neither read nor written.
pub(crate) fn keep_history(file: &Path, plateaus: usize) -> Result<(), Error> {
    if !file.exists() {
        return Ok(());
    }
    let text = read_result(file, "the history of a watch")?;
    // Earlier programs wrote no line while nothing was taken up.
    let is_of = |line: &&str| serde_json::from_str::<HistoryEntry>(line).is_ok_and(|entry| entry.plateau <= plateaus);
    let kept: String = ended(&text).split_inclusive('\n').take_while(is_of).collect();
    if kept == text { Ok(()) } else { Ok(write_whole(file, kept.as_bytes())?) }
}
