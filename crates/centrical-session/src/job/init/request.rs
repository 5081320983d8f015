//! What is asked for.

use std::path::{Path, PathBuf};

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
