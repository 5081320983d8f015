//! Folders for several files that belong together: one process at a time writes them.

use std::fs::{self, File, TryLockError};
use std::path::Path;

use crate::error::{Error, Place};

/// A folder that this process alone fills, until this is dropped.
#[derive(Debug)]
pub struct ClaimedFolder {
    /// The lock is on the folder itself: nothing remains of it, however the process ends.
    _folder: Option<File>,
}

/// Makes a folder, and those above it, if it is not there, and claims it for this process. Where the system or the file system
/// cannot lock a folder it is not claimed.
///
/// # Errors
/// [`Error::Io`] if it cannot be made; [`Error::Content`] if another process fills it.
pub fn claim_folder(folder: &Path) -> Result<ClaimedFolder, Error> {
    create_folder(folder)?;
    let Ok(open) = File::open(folder) else { return Ok(ClaimedFolder { _folder: None }) };
    match open.try_lock() {
        Ok(()) => Ok(ClaimedFolder { _folder: Some(open) }),
        Err(TryLockError::WouldBlock) => {
            let found = format!("another process at work there{}", holder_of_lock(&open));
            Err(Error::content(folder, Place::Whole, found, "a folder that nobody else fills now"))
        }
        Err(TryLockError::Error(_)) => Ok(ClaimedFolder { _folder: None }),
    }
}

/// Makes a folder, and those above it, if it is not there.
///
/// # Errors
/// [`Error::Io`] if it cannot be made.
pub fn create_folder(folder: &Path) -> Result<(), Error> {
    fs::create_dir_all(folder).map_err(|error| Error::writing(folder, error))
}

/// The process that holds the lock of a file or folder, ` (process 4711)`, as the system lists it: `1: FLOCK ADVISORY WRITE 4711 08:01:1234 0 EOF`.
#[cfg(target_os = "linux")]
pub fn holder_of_lock(locked: &File) -> String {
    use std::os::unix::fs::MetadataExt;
    let process = || {
        let end = format!(":{}", locked.metadata().ok()?.ino());
        let locks = fs::read_to_string("/proc/locks").ok()?;
        let held = locks.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
        let process = |words: Vec<&str>| words.get(5)?.ends_with(&end).then(|| words[4].to_owned());
        held.filter(|words| words.get(1) == Some(&"FLOCK")).find_map(process)
    };
    process().map_or(String::new(), |process| format!(" (process {process})"))
}

/// Nothing: other systems do not list locks.
#[cfg(not(target_os = "linux"))]
pub fn holder_of_lock(_: &File) -> String {
    String::new()
}
