//! A drafted experiment file, as a JSON document: schema `centrical-draft/1`.

use std::path::Path;

use serde::Serialize;

use super::result::Program;

/// Name of the schema's present version.
pub(crate) const DRAFT_SCHEMA: &str = "centrical-draft/1";

/// A drafted experiment file, and what a person has to complete.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct DraftReport {
    /// `centrical-draft/1`.
    pub schema: &'static str,
    /// What made it.
    pub program: Program,
    /// The file that was written; null where the draft is in `text` alone.
    pub file: Option<String>,
    /// The draft.
    pub text: String,
    /// Number of guesses, each marked `GUESS` in the draft.
    pub guesses: usize,
    /// The lines to be filled in, in their order.
    pub fill_in: Vec<LineToFillIn>,
}

/// A line that only a person can complete.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LineToFillIn {
    /// The line, counted from 1.
    pub line: usize,
    /// Table and key.
    pub key: String,
    /// Why the files do not show it, or how to find it.
    pub reason: String,
}

impl DraftReport {
    /// A draft that was written to `file`, if to any.
    pub(crate) fn new(file: Option<&Path>, text: &str, guesses: usize, fill_in: Vec<LineToFillIn>) -> Self {
        Self {
            schema: DRAFT_SCHEMA,
            program: Program::this(),
            file: file.map(|file| file.display().to_string()),
            text: text.to_owned(),
            guesses,
            fill_in,
        }
    }
}
