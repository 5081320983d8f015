//! The request for a series, and one session of it: every outcome is a row.

use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use centrical::OnProgress;
use centrical_table::TableFormat;

use crate::document::{CalibrationResult, Method};
use crate::error::{Error, ErrorKind};
use crate::experiment::Session;
use crate::job::calibrate::calibrate_reduced;
use crate::job::reduce::reduce;
use crate::job::reduced_session::write_reduced;
use crate::store::{Failure, Row};

/// File with what became of each session, in the folder of the series.
pub(super) const LEDGER: &str = "series.jsonl";

/// What is done with the sessions of a series.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SeriesRequest {
    /// Folder of the store, of `series.jsonl`, `series.parquet` and `series.csv`.
    pub out: PathBuf,
    /// How the unknowns are estimated.
    pub method: Method,
    /// Sessions calibrated at a time; as many as the machine has cores if absent.
    pub jobs: Option<usize>,
    /// Whether `result.json` is not kept.
    pub rows_only: bool,
    /// Whether each session is kept reduced, some kB in `reduced/KEY`: a later model is fitted to it without the records.
    pub reduced: bool,
}

impl SeriesRequest {
    /// What became of each session.
    pub(super) fn ledger(&self) -> PathBuf {
        self.out.join(LEDGER)
    }

    /// The table of the rows.
    pub(super) fn table(&self) -> PathBuf {
        self.out.join("series.parquet")
    }

    /// The same as text, in short.
    pub(super) fn text(&self) -> PathBuf {
        self.out.join("series.csv")
    }

    /// What is written beside the files of the store, and the reduced sessions.
    pub(super) fn files(&self) -> [PathBuf; 3] {
        [self.ledger(), self.table(), self.text()]
    }
}

/// A session that is done.
pub(super) struct Done {
    /// Its row.
    pub row: Row,
    /// The text of its result.
    pub result: Option<String>,
    /// Files of the session and their SHA-256, in the order of the session; none of a failure.
    pub files: Vec<(std::path::PathBuf, String)>,
}

/// The keys of reduced sessions, each held while such a session is written: sessions of equal files have one folder.
#[derive(Default)]
pub(super) struct Writing(Mutex<HashMap<String, Arc<Mutex<()>>>>);

impl Writing {
    fn of_key(&self, key: &str) -> Arc<Mutex<()>> {
        let mut keys = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        keys.entry(key.to_owned()).or_default().clone()
    }
}

/// Calibrates a session, and writes the reduced one while no other thread writes one of its key; nothing if the caller stopped it. A fault of
/// the program inside one session is a failure of that session.
pub(super) fn calibrated(
    path: &Path,
    request: &SeriesRequest,
    writing: &Writing,
    progress: OnProgress,
) -> Option<Done> {
    let failed =
        |failure| Done { row: Row::failed(&path.display().to_string(), failure), result: None, files: Vec::new() };
    match catch_unwind(AssertUnwindSafe(|| try_calibrate(path, request, writing, progress))) {
        Ok(Ok(done)) => Some(done),
        Ok(Err(error)) if error.kind() == ErrorKind::Stopped => None,
        Ok(Err(error)) => Some(failed(failure(&error))),
        Err(_) => {
            let message = format!("{}: the program failed inside this session", path.display());
            Some(failed(Failure { message, ..Failure::default() }))
        }
    }
}

fn try_calibrate(path: &Path, request: &SeriesRequest, writing: &Writing, progress: OnProgress) -> Result<Done, Error> {
    let session = Session::read(path)?;
    let (session, reduced) = reduce(&session, progress)?;
    let result: CalibrationResult = calibrate_reduced(&session, &reduced, request.method, progress)?;
    let text = result.to_json()?;
    let row = result.row(text.as_bytes());
    if request.reduced {
        let exact = (request.method == Method::Exact).then_some(&result);
        let folder = request.out.join("reduced").join(&row.key);
        let of_key = writing.of_key(&row.key);
        let _one = of_key.lock().unwrap_or_else(PoisonError::into_inner);
        write_reduced(&session, &reduced, exact, TableFormat::Csv, &folder, progress)?;
    }
    let hashes = result.inputs.into_iter().map(|input| input.sha256);
    let files = session.files().into_iter().map(Path::to_owned).zip(hashes).collect();
    Ok(Done { row, result: Some(text), files })
}

fn failure(error: &Error) -> Failure {
    let text = |text: Option<&str>| text.unwrap_or_default().to_owned();
    let place = error.place().map(|place| place.to_string().trim_start_matches([',', ' ']).to_owned());
    Failure {
        message: error.to_string(),
        file: error.file().map(|file| file.display().to_string()).unwrap_or_default(),
        place: place.unwrap_or_default(),
        found: text(error.found()),
        expected: text(error.expected()),
    }
}
