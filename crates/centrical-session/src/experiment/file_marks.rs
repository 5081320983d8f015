//! Files as they were when they were read: a result names the bytes that it was made from.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::error::{Error, Place};

/// Length and time of the last change of each of some files; `None` of one that is not on disk.
#[derive(Debug, Clone, Default)]
pub(crate) struct FileMarks(Vec<(PathBuf, Option<Mark>)>);

type Mark = (u64, Option<SystemTime>);

impl FileMarks {
    /// Those of `files` now.
    pub fn of<'f>(files: impl IntoIterator<Item = &'f Path>) -> Self {
        Self(files.into_iter().map(|file| (file.to_owned(), mark(file))).collect())
    }

    /// Refuses a file that has changed since.
    ///
    /// # Errors
    /// [`Error`] with that file.
    pub fn refuse_changed(&self) -> Result<(), Error> {
        let Some((file, _)) = self.0.iter().find(|(file, before)| mark(file) != *before) else { return Ok(()) };
        let expected = "one that nobody changes while the command runs; run it again";
        Err(Error::content(file, Place::Whole, "another file than was read before", expected))
    }
}

impl PartialEq for FileMarks {
    /// What was read does not depend on when.
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

fn mark(file: &Path) -> Option<Mark> {
    fs::metadata(file).ok().map(|metadata| (metadata.len(), metadata.modified().ok()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_changes_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let [kept, changed] = ["kept", "changed"].map(|name| folder.path().join(name));
        for file in [&kept, &changed] {
            fs::write(file, "1").unwrap();
        }
        let marks = FileMarks::of([kept.as_path(), changed.as_path(), Path::new("in memory")]);
        assert!(marks.refuse_changed().is_ok());
        fs::write(&changed, "12").unwrap();
        let error = marks.refuse_changed().unwrap_err().to_string();
        assert!(error.contains("changed: found another file than was read before"), "{error}");
    }
}
