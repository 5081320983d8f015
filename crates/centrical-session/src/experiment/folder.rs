//! The folder from which the paths in an experiment file start.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use centrical_table::{Bytes, Source};

use super::file_marks::FileMarks;
use crate::error::Error;
use crate::record::{NEWTONOMETER_RECORD, RECORD};

/// A folder of files. Some of them, or all, may be in memory.
#[derive(Clone, PartialEq, Eq, Default)]
pub struct Folder {
    path: PathBuf,
    in_memory: BTreeMap<PathBuf, Bytes>,
    /// What the files were that are read once and kept.
    marks: FileMarks,
}

impl Folder {
    /// The folder at a path, which need not exist if all its files are in memory.
    pub fn at(path: &Path) -> Self {
        Self { path: path.to_owned(), ..Self::default() }
    }

    /// The folder of a file.
    pub fn of(file: &Path) -> Self {
        Self::at(file.parent().unwrap_or(Path::new("")))
    }

    /// The same folder with the file `name`, as an experiment file would name it, in memory.
    #[must_use]
    pub fn with(self, name: &str, bytes: Bytes) -> Self {
        let file = self.join(name);
        self.with_file(&file, bytes)
    }

    /// The same of the file with that path.
    pub(super) fn with_file(mut self, file: &Path, bytes: Bytes) -> Self {
        self.in_memory.insert(file.to_owned(), bytes);
        self
    }

    /// Its path.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// The path of the file that an experiment file names so.
    pub fn join(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Opens the file of that path, which should be what `expected` says.
    pub(crate) fn open(&self, file: &Path, expected: &str) -> Result<Source, Error> {
        match self.in_memory.get(file) {
            Some(bytes) => Ok(Source::in_memory(file, bytes.clone())),
            None => Ok(Source::open(file, expected)?),
        }
    }

    /// Opens a file that is read once and kept, such as a table of means: if it is on disk, it is marked.
    pub(super) fn open_kept(&self, file: &Path, expected: &str) -> Result<Source, Error> {
        let source = self.open(file, expected)?;
        if !self.in_memory.contains_key(file) {
            self.marks.mark(&source)?;
        }
        Ok(source)
    }

    /// What the files were that are kept.
    pub(crate) fn marks(&self) -> &FileMarks {
        &self.marks
    }

    /// Opens the record of a mounting: its file, or the three of its newtonometers.
    pub(crate) fn open_record(&self, files: &[PathBuf]) -> Result<Vec<Source>, Error> {
        let expected = if files.len() == 1 { RECORD } else { NEWTONOMETER_RECORD };
        files.iter().map(|file| self.open(file, expected)).collect()
    }

    /// Length of a file [bytes]; 0 of one that is not there.
    pub(crate) fn length(&self, file: &Path) -> u64 {
        let on_disk = || fs::metadata(file).map_or(0, |metadata| metadata.len());
        self.in_memory.get(file).map_or_else(on_disk, |bytes| bytes.len() as u64)
    }
}

impl std::fmt::Debug for Folder {
    /// Without the bytes and marks.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Folder")
            .field("path", &self.path)
            .field("in_memory", &self.in_memory.keys())
            .finish_non_exhaustive()
    }
}
