//! What is asked of a series.

use std::path::PathBuf;

use crate::document::Method;

/// File with what became of each session, in the folder of the series.
pub(super) const LEDGER: &str = "series.jsonl";

/// What is done with the sessions of a series.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SeriesRequest {
    /// Folder of the store, of `series.jsonl`, `series.parquet` and `series.csv`.
    pub out: PathBuf,
    /// How the unknowns are estimated.
    pub method: Method,
    /// Sessions calibrated at a time; as many as the machine has cores if absent.
    pub jobs: Option<usize>,
    /// Whether `result.json` is not kept.
    pub rows_only: bool,
    /// Whether each session is kept reduced, some kB in `reduced/KEY`: a later model is fitted to it without the records.
    pub reduced: bool,
}

impl SeriesRequest {
    /// What became of each session.
    pub(super) fn ledger(&self) -> PathBuf {
        self.out.join(LEDGER)
    }

    /// The table of the rows.
    pub(super) fn table(&self) -> PathBuf {
        self.out.join("series.parquet")
    }

    /// The same as text, in short.
    pub(super) fn text(&self) -> PathBuf {
        self.out.join("series.csv")
    }

    /// What is written beside the files of the store, and the reduced sessions.
    pub(super) fn files(&self) -> [PathBuf; 3] {
        [self.ledger(), self.table(), self.text()]
    }
}
