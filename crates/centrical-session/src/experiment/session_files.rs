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

    /// Whether it has records or means, and is no plan.
    pub(super) fn has_readings(&self) -> bool {
        let has_rests = self.rest_tables.iter().any(|table| !table.is_planned());
        self.record_bytes() > 0 || self.plateaus.is_some() || has_rests
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

/// What may stand beside an experiment file and belong to it.
const BESIDE: [&str; 4] = [EXPERIMENT_FILE, "truth.json", "truth.toml", "laboratory.toml"];

/// Refuses outputs over one of `inputs`, or over a file of a session that has readings, or cannot be read: nothing restores them.
///
/// # Errors
/// [`Error`] with the output.
pub fn refuse_inputs(outputs: &[PathBuf], inputs: &[impl AsRef<Path>]) -> Result<(), Error> {
    refuse_but_in(None, outputs, inputs)
}

/// The same, but for the session in `folder`, which may be replaced.
///
/// # Errors
/// As [`refuse_inputs`].
pub(crate) fn refuse_other_inputs(
    folder: &Path,
    outputs: &[PathBuf],
    inputs: &[impl AsRef<Path>],
) -> Result<(), Error> {
    refuse_but_in(Some(&whole(folder)), outputs, inputs)
}

fn refuse_but_in(own: Option<&Path>, outputs: &[PathBuf], inputs: &[impl AsRef<Path>]) -> Result<(), Error> {
    centrical_table::refuse_inputs(outputs, inputs)?;
    for output in outputs.iter().filter(|output| output.is_file()) {
        let may_hold = |folder: &&Path| Some(*folder) != own && folder.join(EXPERIMENT_FILE).is_file();
        for folder in whole(output).ancestors().skip(1).take(ABOVE).filter(may_hold) {
            if centrical_table::refuse_inputs(std::slice::from_ref(output), &irreplaceable(folder)).is_err() {
                let found = format!("a file of the session in {}", folder.display());
                return Err(Error::content(output, Place::Whole, found, "another file for the output"));
            }
        }
    }
    Ok(())
}

fn whole(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}

/// The files of the session in `folder`, if it has readings; of one that cannot be read those beside its experiment file.
fn irreplaceable(folder: &Path) -> Vec<PathBuf> {
    let session = Session::read_before_rests(folder).ok();
    if session.as_ref().is_some_and(|session| !session.has_readings()) {
        return Vec::new();
    }
    let files = session.iter().flat_map(Session::files).map(Path::to_owned);
    files.chain(BESIDE.map(|name| folder.join(name))).collect()
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Rests alone in a table; `gravity` can be spoilt.
    const MEANS: &str = r#"
[session]
title = ""
date = ""
[site]
gravity = "9.81523 m/s^2"
[unit]
output_unit = "m/s^2"
[model]
error_model = ["df_1", "G0_11"]
[[tumble]]
rests = "rests.csv"
"#;

    #[test]
    fn what_cannot_be_made_again_is_not_written_over() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| folder.path().join(name);
        for name in ["rests.csv", "truth.json", "laboratory.toml", "other.csv"] {
            std::fs::write(file(name), "1").unwrap();
        }
        let nothing: [&Path; 0] = [];
        let is_refused = |name: &str| refuse_inputs(&[file(name)], &nothing).is_err();
        std::fs::write(file(EXPERIMENT_FILE), MEANS).unwrap();
        assert!(Session::read_before_rests(folder.path()).is_ok(), "{:?}", Session::read_before_rests(folder.path()));
        let of_session = [EXPERIMENT_FILE, "truth.json", "laboratory.toml"];
        assert!(of_session.iter().chain(&["rests.csv"]).all(|name| is_refused(name)) && !is_refused("other.csv"));
        assert!(refuse_other_inputs(folder.path(), &[file("rests.csv")], &nothing).is_ok());
        std::fs::write(file(EXPERIMENT_FILE), MEANS.replace("gravity", "gravty")).unwrap();
        assert!(of_session.iter().all(|name| is_refused(name)) && !is_refused("other.csv"));
        // A plan can be made again.
        std::fs::write(
            file(EXPERIMENT_FILE),
            MEANS.replace("rests = \"rests.csv\"", "attitudes = \"cube\"\nattitude_uncertainty = \"1 mrad\""),
        )
        .unwrap();
        assert!(Session::read_before_rests(folder.path()).is_ok(), "{:?}", Session::read_before_rests(folder.path()));
        assert!(!is_refused(EXPERIMENT_FILE));
    }
}
