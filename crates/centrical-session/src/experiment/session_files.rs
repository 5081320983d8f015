//! The files of a session: records, telemetry and pulses of its mountings.

use std::path::{Path, PathBuf};

use centrical::reduction::{PulseTrain, Record, SpeedTrace};
use centrical::{OnProgress, unwatched};
use centrical_table::{Extent, Source};

use super::rests::RestTable;
use super::session::{EXPERIMENT, Session};
use super::toml_path::TomlPath;
use crate::error::Error;
use crate::record::{PULSES, TELEMETRY, pulses_of, read_records, telemetry_of};
use crate::settings::settings_of;

impl Session {
    /// Reads the whole record of a mounting, by its index.
    ///
    /// # Errors
    /// If the mounting has no record, or as [`read_record`].
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

    /// Reads the telemetry of a mounting, if it has any.
    ///
    /// # Errors
    /// As [`read_record`].
    pub fn telemetry(&self, mounting: usize) -> Result<Option<SpeedTrace>, Error> {
        self.telemetry_to(mounting, Extent::Whole)
    }

    /// The same of telemetry that may still be growing.
    pub(crate) fn telemetry_to(&self, mounting: usize, extent: Extent) -> Result<Option<SpeedTrace>, Error> {
        let file = self.mountings.get(mounting).and_then(|m| m.telemetry.as_ref());
        file.map(|file| telemetry_of(self.folder.open(file, TELEMETRY)?, &self.columns, extent)).transpose()
    }

    /// Reads the pulses of a mounting, if it has any.
    ///
    /// # Errors
    /// As [`read_record`].
    pub fn pulses(&self, mounting: usize) -> Result<Option<PulseTrain>, Error> {
        self.pulses_to(mounting, Extent::Whole)
    }

    /// The same of pulses that may still be coming.
    pub(crate) fn pulses_to(&self, mounting: usize, extent: Extent) -> Result<Option<PulseTrain>, Error> {
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
