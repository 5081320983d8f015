//! What a series did: a line for each session, `series.jsonl`.
//!
//! A session is known by the SHA-256 of its files, which the calibration computes anyway. Size and time of change stand beside it, so that
//! a file is hashed again only if one of them has changed: a session that was copied or touched is known, and one that is the same costs no
//! reading.

use std::collections::BTreeMap;
use std::fs;
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

use centrical::unwatched;
use centrical_table::{Source, write_whole};
use serde::{Deserialize, Serialize};

use super::one::{Done, LEDGER};
use crate::document::{Method, json_line};
use crate::error::{Error, ErrorKind};
use crate::record::Input;
use crate::store::Status;

/// The lines of earlier runs and of this one.
pub(super) struct Ledger {
    file: PathBuf,
    /// The file, open once there is a line to add.
    output: Option<File>,
    method: Method,
    entries: BTreeMap<String, Entry>,
}

/// What became of a session.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Entry {
    session: String,
    program: String,
    method: Method,
    /// Key of its row.
    key: String,
    /// Whether it has no result, and is tried again.
    failed: bool,
    files: Vec<Known>,
}

/// A file as it was.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Known {
    /// In letters: one of a name that is not in UTF-8 is not found again, and its session is done anew.
    path: String,
    size: u64,
    /// Time of change since 1970 [ns].
    modified: u64,
    sha256: String,
}

/// The key of the last row of each session of the series that was written into `folder`, by the name of the session; none without a series.
///
/// # Errors
/// [`Error`] when the lines of the series cannot be read.
pub fn last_rows(folder: &Path) -> Result<BTreeMap<String, String>, Error> {
    let text = text_of(&folder.join(LEDGER))?;
    Ok(whole_lines(&text).map(|(_, entry)| (entry.session, entry.key)).collect())
}

impl Ledger {
    /// Reads the lines of earlier runs; one that a kill left in part is dropped.
    pub fn read(file: &Path, method: Method) -> Result<Self, Error> {
        let text = text_of(file)?;
        let entries = whole_lines(&text).map(|(_, entry)| (entry.session.clone(), entry)).collect();
        Ok(Self { file: file.to_owned(), output: None, method, entries })
    }

    /// The files of a session that is known.
    pub fn files(&self, session: &Path) -> Vec<&Path> {
        let entry = self.entries.get(&name(session));
        entry.into_iter().flat_map(|entry| &entry.files).map(|known| Path::new(&known.path)).collect()
    }

    /// Whether a session was done by this program and method from the files that it has now.
    pub fn knows(&self, session: &Path) -> bool {
        self.entries.get(&name(session)).is_some_and(|entry| {
            !entry.failed
                && entry.program == env!("CARGO_PKG_VERSION")
                && entry.method == self.method
                && entry.files.iter().all(Known::is_as_it_was)
        })
    }

    /// Adds sessions whose rows are in the store.
    pub fn add<'a>(&mut self, done: impl Iterator<Item = (&'a Path, &'a Done)>) -> Result<(), Error> {
        let mut lines = String::new();
        for (session, done) in done {
            let files = done.files.iter().filter_map(|(path, sha256)| {
                let (size, modified) = stamp(path)?;
                Some(Known { path: path.display().to_string(), size, modified, sha256: sha256.clone() })
            });
            let entry = Entry {
                session: name(session),
                program: env!("CARGO_PKG_VERSION").to_owned(),
                method: self.method,
                key: done.row.key.clone(),
                failed: done.row.status == Status::Failed,
                files: files.collect(),
            };
            lines += &json_line("series.jsonl", &entry)?;
            self.entries.insert(entry.session.clone(), entry);
        }
        let output = match self.output.take() {
            Some(output) => output,
            None => self.begin()?,
        };
        let output = self.output.insert(output);
        output.write_all(lines.as_bytes()).map_err(|error| Error::writing(&self.file, error))
    }

    /// Opens the file for further lines, after one that is not whole is taken out.
    fn begin(&self) -> Result<File, Error> {
        let text = text_of(&self.file)?;
        let whole: String = whole_lines(&text).map(|(line, _)| line).collect();
        if whole != text {
            write_whole(&self.file, whole.as_bytes())?;
        }
        OpenOptions::new().create(true).append(true).open(&self.file).map_err(|error| Error::writing(&self.file, error))
    }

    /// Key of the row of a session.
    pub fn key(&self, session: &Path) -> Option<&str> {
        self.entries.get(&name(session)).map(|entry| entry.key.as_str())
    }
}

impl Known {
    fn is_as_it_was(&self) -> bool {
        let path = Path::new(&self.path);
        if stamp(path) == Some((self.size, self.modified)) {
            return true;
        }
        let hash = Source::open(path, Input::EXPECTED).map_err(Error::from);
        let hash = hash.and_then(|file| Input::of(Path::new(""), &file, &unwatched));
        hash.is_ok_and(|input| input.sha256 == self.sha256)
    }
}

/// Largest file of a series [bytes]: the lines of 500,000 sessions of 24 mountings.
const LARGEST: u64 = 4 << 30;

fn text_of(file: &Path) -> Result<String, Error> {
    let expected = "the lines of a series";
    match Source::open(file, expected).and_then(|source| source.text(LARGEST, expected)).map_err(Error::from) {
        Err(error) if error.kind() == ErrorKind::Missing => Ok(String::new()),
        text => text,
    }
}

/// The lines that are entries of an earlier run, and these.
fn whole_lines(text: &str) -> impl Iterator<Item = (&str, Entry)> {
    let whole = text.split_inclusive('\n').filter(|line| line.ends_with('\n'));
    whole.filter_map(|line| Some((line, serde_json::from_str(line).ok()?)))
}

/// Size and time of change [ns].
fn stamp(path: &Path) -> Option<(u64, u64)> {
    let metadata = fs::metadata(path).ok()?;
    let modified = metadata.modified().ok()?.duration_since(UNIX_EPOCH).ok()?;
    Some((metadata.len(), u64::try_from(modified.as_nanos()).ok()?))
}

fn name(session: &Path) -> String {
    session.display().to_string()
}
