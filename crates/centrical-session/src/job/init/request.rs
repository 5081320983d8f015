//! What is asked for.

use std::path::PathBuf;

/// What `experiment.toml` is to be drafted from.
#[derive(Debug, Clone, PartialEq)]
pub struct InitRequest {
    /// Files of records and telemetry, or folders of them.
    pub inputs: Vec<PathBuf>,
    /// Folder of the experiment file, which names the others relative to itself.
    pub folder: PathBuf,
    /// Folder of a tumble of the unit: its scale and bias, gravity, and its rests are taken.
    pub tumble: Option<PathBuf>,
    /// Whether to write the source's six positions out where the files do not show the positions.
    pub six_positions: bool,
}
