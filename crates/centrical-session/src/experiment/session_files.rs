//! The files of a session: records, telemetry and pulses of its mountings; and a session that stands where another is to be written.

use std::path::{Path, PathBuf};

use centrical::reduction::{PulseTrain, Record, SpeedTrace};
use centrical::{OnProgress, unwatched};
use centrical_table::{Extent, Source};

use super::rests::{RestSource, RestTable};
use super::session::{EXPERIMENT, EXPERIMENT_FILE, Session};
use super::toml_path::TomlPath;
use crate::error::{Error, Place};
use crate::record::{PULSES, TELEMETRY, pulses_of, read_records, telemetry_of};
use crate::settings::settings_of;

impl Session {
    /// Reads the whole record of a mounting, by its index.
    ///
    /// # Errors
    /// If the mounting has no record, or as [`RecordReader`](crate::RecordReader).
    pub fn record(&self, mounting: usize) -> Result<Record, Error> {
        self.record_to(mounting, Extent::Whole, &unwatched)
    }

    /// The same as far as it was written. `progress` is called with the number of bytes read.
    ///
    /// # Errors
    /// As [`Session::record`]; [`Error::Stopped`].
    pub(crate) fn record_to(&self, mounting: usize, extent: Extent, progress: OnProgress) -> Result<Record, Error> {
        read_records(self.open_record(mounting)?, &self.columns, extent, progress)
    }

    /// Reads the telemetry of a mounting, if it has any; with [`Extent::Growing`] more may come.
    ///
    /// # Errors
    /// As [`RecordReader`](crate::RecordReader).
    pub fn telemetry(&self, mounting: usize, extent: Extent) -> Result<Option<SpeedTrace>, Error> {
        let file = self.mountings.get(mounting).and_then(|m| m.telemetry.as_ref());
        file.map(|file| telemetry_of(self.folder.open(file, TELEMETRY)?, &self.columns, extent)).transpose()
    }

    /// Reads the pulses of a mounting likewise.
    ///
    /// # Errors
    /// As [`RecordReader`](crate::RecordReader).
    pub(crate) fn pulses(&self, mounting: usize, extent: Extent) -> Result<Option<PulseTrain>, Error> {
        let file = self.mountings.get(mounting).and_then(|m| m.pulses.as_ref());
        let per_revolution = self.pulses_per_revolution();
        let read = |file: &PathBuf| {
            let t = pulses_of(self.folder.open(file, PULSES)?, &self.columns, extent)?;
            Ok(PulseTrain { t, per_revolution })
        };
        file.map(read).transpose()
    }

    /// Pulses of a revolution, of an index mark unless the session says otherwise.
    pub(crate) fn pulses_per_revolution(&self) -> f64 {
        self.speeds.measured.map_or(1.0, |measured| measured.pulses_per_revolution)
    }

    /// Number of the records of a plan, as a simulation writes them: one of each mounting and of each tumble.
    pub fn planned_records(&self) -> usize {
        self.mountings.len() + self.rest_tables.len()
    }

    /// Size of the records [bytes]; of a session that comes already averaged those of its rests alone. Records that are not there
    /// have none.
    pub fn record_bytes(&self) -> u64 {
        let of_arm = self.mountings.iter().filter(|_| self.plateaus.is_none()).flat_map(|files| &files.records);
        let files = of_arm.chain(self.rest_records().flat_map(|(_, recorded)| &recorded.files));
        files.map(|file| self.folder.length(file)).sum()
    }

    /// All files of the session in the order they are named: the experiment file first.
    pub fn files(&self) -> Vec<&Path> {
        let of_mountings = self.mountings.iter().flat_map(|m| m.records.iter().chain(&m.telemetry).chain(&m.pulses));
        let table = self
            .plateaus
            .iter()
            .flat_map(|table| &table.file)
            .chain(self.rest_tables.iter().flat_map(RestTable::files));
        std::iter::once(&self.file).chain(table).chain(of_mountings).map(PathBuf::as_path).collect()
    }

    /// Opens the file of a mounting's record, or the three of its newtonometers.
    pub(crate) fn open_record(&self, mounting: usize) -> Result<Vec<Source>, Error> {
        self.record_file(mounting)?;
        self.folder.open_record(&self.mountings[mounting].records)
    }

    /// The text of the experiment file.
    pub(crate) fn experiment_text(&self) -> Result<String, Error> {
        settings_of(&self.folder.open(&self.file, EXPERIMENT)?, EXPERIMENT)
    }

    /// The file of a mounting's record, the first of several.
    pub(crate) fn record_file(&self, mounting: usize) -> Result<&Path, Error> {
        let record = self.mountings.get(mounting).and_then(|m| m.records.first());
        record.map(PathBuf::as_path).ok_or_else(|| {
            TomlPath::entry(&self.file, "mounting", mounting).unexpected("record", "no record", "the path of one")
        })
    }
}

/// Folders above an output in which a session may lie that reads a file there.
const ABOVE: usize = 3;

/// Refuses outputs over one of `inputs`, or over a file of a session whose records are there: nothing restores them.
///
/// # Errors
/// [`Error`] with the output.
pub fn refuse_inputs(outputs: &[PathBuf], inputs: &[impl AsRef<Path>]) -> Result<(), Error> {
    centrical_table::refuse_inputs(outputs, inputs)?;
    for output in outputs.iter().filter(|output| output.is_file()) {
        let whole = std::path::absolute(output).unwrap_or_else(|_| output.clone());
        for folder in whole.ancestors().skip(1).take(ABOVE).filter(|folder| folder.join(EXPERIMENT_FILE).is_file()) {
            let session = Session::read_before_rests(folder).ok().filter(|session| session.record_bytes() > 0);
            let files = session.iter().flat_map(Session::files).collect::<Vec<_>>();
            if centrical_table::refuse_inputs(std::slice::from_ref(output), &files).is_err() {
                let found = format!("a file of the session in {}", folder.display());
                return Err(Error::content(output, Place::Whole, found, "another file for the output"));
            }
        }
    }
    Ok(())
}

/// Refuses a folder that holds a session.
///
/// # Errors
/// [`Error`] with its experiment file.
pub(crate) fn refuse_session(folder: &Path) -> Result<(), Error> {
    refuse(folder, "a folder without one", |_| false)
}

/// The same, but for means alone of the unit of `session`: such a session this program writes, and can write again.
///
/// # Errors
/// As [`refuse_session`].
pub(crate) fn refuse_another_session(folder: &Path, session: &Session) -> Result<(), Error> {
    let may_be_replaced = |there: &Session| is_of_means(there) && is_of_unit(there, session);
    refuse(folder, "a folder without one, or with one of plateau means alone and of the same unit", may_be_replaced)
}

fn refuse(folder: &Path, expected: &str, may_be_replaced: impl Fn(&Session) -> bool) -> Result<(), Error> {
    let file = folder.join(EXPERIMENT_FILE);
    if !file.exists() || Session::read_before_rests(&file).is_ok_and(|session| may_be_replaced(&session)) {
        return Ok(());
    }
    Err(Error::content(&file, Place::Whole, "a session", expected))
}

/// Whether all readings of a session are means, in tables.
fn is_of_means(session: &Session) -> bool {
    let is_table = |source: &RestSource| matches!(source, RestSource::Table(_));
    session.plateaus.is_some() != session.mountings.is_empty()
        && session.rest_tables.iter().all(|table| is_table(&table.source))
}

/// Whether a session is of the unit of `other`, or does not say which it is of.
fn is_of_unit<'s>(session: &'s Session, other: &'s Session) -> bool {
    let unit = |session: &'s Session| [session.unit_model.as_str(), session.unit_serial.as_str()];
    unit(session) == ["", ""] || unit(session) == unit(other)
}
