//! What is asked of a series.

use std::path::PathBuf;

use crate::document::Method;

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
