//! Why a look at a folder brought nothing.

use std::path::{Path, PathBuf};
use std::time::Duration;

/// Why a look at a folder brought nothing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Note {
    /// A file has not come.
    WaitingFor(PathBuf),
    /// A record cannot be read yet, and why.
    NotYet(String),
    /// A record counts as finished, since it has not changed for so long.
    Silent { file: PathBuf, after: Duration },
}

impl Note {
    /// It in words.
    pub fn text(&self) -> String {
        match self {
            Self::WaitingFor(file) => format!("waiting for {}", file.display()),
            Self::NotYet(why) => format!("not yet: {why}"),
            Self::Silent { file, after } => format!(
                "{} counts as finished, since it has not changed for {} s; --quiet SECONDS waits for longer gaps",
                file.display(),
                after.as_secs_f64()
            ),
        }
    }

    /// The file that is waited for, if one is.
    pub fn awaited(&self) -> Option<&Path> {
        match self {
            Self::WaitingFor(file) => Some(file),
            Self::NotYet(_) | Self::Silent { .. } => None,
        }
    }
}
