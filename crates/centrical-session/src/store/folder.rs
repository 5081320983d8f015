//! The folder of a store: where its files are, and the lock of its writers.

use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use centrical_table::{create_folder, holder_of_lock, refuse_inputs};

use crate::error::{Error, Place};
use crate::experiment::EXPERIMENT_FILE;

/// A store of calibrations.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Store {
    folder: PathBuf,
}

/// The right to write into a store, until this is dropped or the process ends.
pub(super) struct Lock {
    _file: File,
}

impl Store {
    /// Opens a store that is there.
    ///
    /// # Errors
    /// [`Error`] if the folder is not there or is not a store.
    pub fn open(folder: &Path) -> Result<Self, Error> {
        let store = Self { folder: folder.to_owned() };
        if store.rows_folder().is_dir() {
            return Ok(store);
        }
        let found = if folder.exists() { "no folder `rows` in it" } else { "no such folder" };
        Err(Error::content(
            folder,
            Place::Whole,
            found,
            "a store of calibrations, as `centrical history add` makes one",
        ))
    }

    /// Opens a store, and makes it if it is not there.
    ///
    /// # Errors
    /// [`Error`] if the folder cannot be made, or is that of a session.
    pub fn create(folder: &Path) -> Result<Self, Error> {
        let store = Self { folder: folder.to_owned() };
        if !store.rows_folder().is_dir() && folder.join(EXPERIMENT_FILE).exists() {
            return Err(Error::content(
                folder,
                Place::Whole,
                "the folder of a session",
                "a folder of its own for the store",
            ));
        }
        create_folder(&store.rows_folder())?;
        Ok(store)
    }

    /// Refuses inputs that are files of the store in `folder`, which need not be there: writers merge its parts and remove them. Copies of
    /// results may be inputs, as a copy is never replaced.
    ///
    /// # Errors
    /// [`Error`] with the file of the store.
    pub fn refuse_inputs(folder: &Path, inputs: &[impl AsRef<Path>]) -> Result<(), Error> {
        Ok(refuse_inputs(&Self { folder: folder.to_owned() }.replaced()?, inputs)?)
    }

    /// The files that writers replace or remove.
    pub(crate) fn replaced(&self) -> Result<Vec<PathBuf>, Error> {
        let rows = if self.rows_folder().is_dir() { self.files_of_rows()? } else { Vec::new() };
        Ok(rows.into_iter().chain(self.left_copies()?).chain([self.lock_file()]).collect())
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Where the copy of a result is, if the store keeps it.
    pub fn result_file(&self, key: &str) -> PathBuf {
        self.results_folder().join(format!("{key}.json"))
    }

    /// Whether the store keeps copies of results.
    pub(crate) fn keeps_results(&self) -> bool {
        self.results_folder().is_dir()
    }

    pub(super) fn rows_folder(&self) -> PathBuf {
        self.folder.join("rows")
    }

    pub(super) fn results_folder(&self) -> PathBuf {
        self.folder.join("results")
    }

    /// The files of the parts, by name. A part never changes, so that the names say whether a row has come.
    ///
    /// # Errors
    /// [`Error`] if the folder cannot be read.
    pub fn parts(&self) -> Result<Vec<PathBuf>, Error> {
        Ok(ending(self.files_of_rows()?, "parquet"))
    }

    /// Temporary files that a process left: only a writer with the lock may ask.
    pub(super) fn orphans(&self) -> Result<Vec<PathBuf>, Error> {
        Ok(ending(self.files_of_rows()?, "tmp").into_iter().chain(self.left_copies()?).collect())
    }

    /// Copies of results that a process left before they were whole.
    fn left_copies(&self) -> Result<Vec<PathBuf>, Error> {
        if !self.keeps_results() {
            return Ok(Vec::new());
        }
        Ok(ending(files_of(&self.results_folder())?, "tmp"))
    }

    fn files_of_rows(&self) -> Result<Vec<PathBuf>, Error> {
        let mut files = files_of(&self.rows_folder())?;
        files.sort();
        Ok(files)
    }

    fn lock_file(&self) -> PathBuf {
        self.folder.join("lock")
    }

    /// Waits until no other process writes into the store.
    pub(super) fn lock(&self) -> Result<Lock, Error> {
        let file = self.open_lock()?;
        file.lock().map_err(|error| Error::writing(&self.lock_file(), error))?;
        Ok(Lock { _file: file })
    }

    fn open_lock(&self) -> Result<File, Error> {
        let path = self.lock_file();
        File::options().create(true).append(true).open(&path).map_err(|error| Error::writing(&path, error))
    }
}

/// Waits until no other process writes into the store in `folder`, which need not be there. `say` takes the note of who is waited for, once that
/// has lasted for two seconds.
///
/// # Errors
/// [`Error`] if the folder does not take the lock.
pub fn wait_for_store(folder: &Path, say: &dyn Fn(&str)) -> Result<(), Error> {
    const LONG: Duration = Duration::from_secs(2);
    const AGAIN: Duration = Duration::from_millis(50);
    let Ok(store) = Store::open(folder) else { return Ok(()) };
    let (file, begun) = (store.open_lock()?, Instant::now());
    let mut is_said = false;
    while let Err(TryLockError::WouldBlock) = file.try_lock() {
        if !is_said && begun.elapsed() >= LONG {
            let holder = holder_of_lock(&file);
            say(&format!("waiting for the store {}: another process writes into it{holder}", folder.display()));
            is_said = true;
        }
        thread::sleep(AGAIN);
    }
    Ok(())
}

/// The files of a folder, in any order.
fn files_of(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let failed = |error| Error::reading(folder, error, "a folder of a store");
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).map_err(failed)? {
        files.push(entry.map_err(failed)?.path());
    }
    Ok(files)
}

fn ending(mut files: Vec<PathBuf>, end: &str) -> Vec<PathBuf> {
    files.retain(|file| file.extension().is_some_and(|e| e == end));
    files
}
