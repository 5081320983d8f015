//! Files as they were when they were read: a result names the bytes that it was made from.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;

use centrical::unwatched;
use centrical_table::Source;

use crate::error::{Error, Place};
use crate::record::Input;

/// What each of some files was when it was read; copies share it.
#[derive(Debug, Clone, Default)]
pub(crate) struct FileMarks(Arc<Mutex<BTreeMap<PathBuf, Mark>>>);

/// Length and time of the last change, `None` of a file that is not on disk; and the hash of what is read once and kept.
#[derive(Debug, Clone)]
struct Mark {
    look: Option<(u64, Option<SystemTime>)>,
    sha256: Option<String>,
}

impl FileMarks {
    /// Those of `files` now, before they are read.
    pub fn of<'f>(files: impl IntoIterator<Item = &'f Path>) -> Self {
        let marks = files.into_iter().map(|file| (file.to_owned(), Mark { look: look(file), sha256: None }));
        Self(Arc::new(Mutex::new(marks.collect())))
    }

    /// These, and those of further files now.
    pub fn and<'f>(&self, files: impl IntoIterator<Item = &'f Path>) -> Self {
        let further = Self::of(files);
        further.marks().extend(self.marks().clone());
        further
    }

    /// Marks a file by what it holds, before it is read; one of more than 64 MiB, which may be no such file at all, by length and time alone.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn mark(&self, source: &Source) -> Result<(), Error> {
        let look = look(source.name());
        let sha256 = (source.length() <= 64 << 20).then(|| hash(source)).transpose()?;
        self.marks().insert(source.name().to_owned(), Mark { look, sha256 });
        Ok(())
    }

    /// Refuses a file that has changed since, or is gone.
    ///
    /// # Errors
    /// [`Error`] with that file.
    pub fn refuse_changed(&self) -> Result<(), Error> {
        self.refuse(|file, before| before.is_of(file))
    }

    /// Refuses a file that has changed since. One that is not there may be about to be replaced by itself.
    ///
    /// # Errors
    /// [`Error`] with that file.
    pub fn refuse_replaced(&self) -> Result<(), Error> {
        self.refuse(|file, before| !file.exists() || before.is_of(file))
    }

    fn refuse(&self, is_same: impl Fn(&Path, &Mark) -> bool) -> Result<(), Error> {
        let marks = self.marks();
        let Some((file, _)) = marks.iter().find(|(file, before)| !is_same(file, before)) else { return Ok(()) };
        let expected = "one that nobody changes while the command runs; run it again";
        Err(Error::content(file, Place::Whole, "another file than was read before", expected))
    }

    fn marks(&self) -> MutexGuard<'_, BTreeMap<PathBuf, Mark>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Mark {
    /// Whether `file` is as it was; where its time is another, by what it holds.
    fn is_of(&self, file: &Path) -> bool {
        let now = look(file);
        let holds_the_same = || {
            self.sha256.is_some() && Source::open(file, Input::EXPECTED).ok().and_then(|s| hash(&s).ok()) == self.sha256
        };
        now == self.look || now.is_some() && holds_the_same()
    }
}

impl PartialEq for FileMarks {
    /// What was read does not depend on when.
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Eq for FileMarks {}

fn look(file: &Path) -> Option<(u64, Option<SystemTime>)> {
    fs::metadata(file).ok().map(|metadata| (metadata.len(), metadata.modified().ok()))
}

fn hash(source: &Source) -> Result<String, Error> {
    Ok(Input::of(Path::new(""), source, &unwatched)?.sha256)
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

    #[test]
    fn a_file_that_is_kept_is_known_by_what_it_holds() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("rests.csv");
        fs::write(&file, "1").unwrap();
        let kept = FileMarks::default();
        kept.mark(&Source::open(&file, "a table").unwrap()).unwrap();
        let marks = kept.and([file.as_path()]);
        let touch =
            || fs::File::options().write(true).open(&file).unwrap().set_modified(SystemTime::UNIX_EPOCH).unwrap();
        touch();
        assert!(marks.refuse_changed().is_ok());
        fs::remove_file(&file).unwrap();
        assert!(kept.refuse_replaced().is_ok());
        assert!(kept.refuse_changed().is_err());
        fs::write(&file, "2").unwrap();
        touch();
        assert!(kept.refuse_replaced().is_err());
    }
}
