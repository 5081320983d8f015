//! A session or a record as Python gives it: by a path, or in memory.

use std::path::PathBuf;

use centrical_session::{Bytes, Error, Folder, MountingFiles, Place, Session};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;

use crate::progress::Work;
use crate::result::CalibrationResult;

/// The name of a file that is in memory, and its bytes.
type NamedBytes = (String, PyBackedBytes);

/// Names of record, telemetry and pulses of a mounting, where its experiment file does not name them.
type NamesOfMounting = (String, Option<String>, Option<String>);

/// A session.
pub enum GivenSession {
    /// Its folder, or its experiment file.
    Path(PathBuf),
    /// The text of its experiment file and the path that it stands for, files in memory, and names of files for all mountings or for none.
    InMemory(String, PathBuf, Vec<NamedBytes>, Vec<NamesOfMounting>),
}

impl<'py> FromPyObject<'_, 'py> for GivenSession {
    type Error = PyErr;

    fn extract(given: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        match given.extract() {
            Ok((text, file, files, names)) => Ok(Self::InMemory(text, file, files, names)),
            Err(_) => given.extract().map(Self::Path),
        }
    }
}

impl GivenSession {
    /// Reads the session. Its records are not touched.
    ///
    /// # Errors
    /// As [`Session::read`].
    pub fn read(self) -> Result<Session, Error> {
        let (text, file, files, names) = match self {
            Self::Path(path) => return Session::read(&path),
            Self::InMemory(text, file, files, names) => (text, file, files, names),
        };
        let folder = in_memory(Folder::of(&file), files);
        let path = |name: String| folder.join(&name);
        let of_mounting = |(record, telemetry, pulses): NamesOfMounting| MountingFiles {
            records: vec![path(record)],
            telemetry: telemetry.map(path),
            pulses: pulses.map(path),
        };
        let mountings: Vec<MountingFiles> = names.into_iter().map(of_mounting).collect();
        let mut session = Session::parse_file(&text, &file, folder)?;
        if mountings.len() == session.mountings.len() {
            session.mountings = mountings;
        } else if !mountings.is_empty() {
            let expected = format!("{}, one for each mounting", session.mountings.len());
            let found = format!("{} records in memory", mountings.len());
            return Err(Error::content(&session.file, Place::Whole, found, expected));
        }
        Ok(session)
    }

    /// Reads the session for a job that reads its records twice.
    ///
    /// # Errors
    /// As [`Session::read`].
    pub fn read_for(self, work: &Work) -> Result<Session, Error> {
        let session = self.read()?;
        work.expect(2 * session.record_bytes());
        Ok(session)
    }
}

/// A file of readings.
pub enum GivenFile {
    /// On disk.
    Path(PathBuf),
    /// In memory.
    InMemory(NamedBytes),
}

impl<'py> FromPyObject<'_, 'py> for GivenFile {
    type Error = PyErr;

    fn extract(given: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        given.extract().map_or_else(|_: PyErr| given.extract().map(Self::Path), |named| Ok(Self::InMemory(named)))
    }
}

impl GivenFile {
    /// Its path, and the folder in which it is found.
    pub fn in_folder(self, folder: Folder) -> (PathBuf, Folder) {
        match self {
            Self::Path(path) => (path, folder),
            Self::InMemory(named) => (folder.join(&named.0), in_memory(folder, vec![named])),
        }
    }
}

/// The folder with these files in memory: those of Python themselves, not copies.
fn in_memory(folder: Folder, files: Vec<NamedBytes>) -> Folder {
    files.into_iter().fold(folder, |folder, (name, bytes)| folder.with(&name, Bytes::from_owner(bytes)))
}

/// A result, or its file, or a folder of such files.
#[derive(FromPyObject)]
pub enum GivenResult {
    /// Read before.
    Read(Py<CalibrationResult>),
    /// A file or a folder.
    Path(PathBuf),
}
