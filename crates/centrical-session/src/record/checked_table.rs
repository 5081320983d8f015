//! A table of a session: its units are those that are stated, and rows that lack a reading become what is stated of them.

use std::path::PathBuf;

use centrical_table::{Extent, Field, Rows, Source, TableLines, TableReader};

use super::columns::{Column, MissingReadings, fields};
use super::units_found::StatedUnits;
use crate::error::Error;

/// What a record, the record of a newtonometer, telemetry, and times of pulses are expected to be.
pub(crate) const RECORD: &str = "a record";
pub(crate) const NEWTONOMETER_RECORD: &str = "the record of a newtonometer";
pub(crate) const TELEMETRY: &str = "telemetry";
pub(crate) const PULSES: &str = "times of pulses";

/// How a table is written, and what it is.
#[derive(Clone, Copy)]
pub(crate) struct Form {
    pub lines: TableLines,
    /// What becomes of rows that lack a reading, in the record of a session.
    pub missing: Option<MissingReadings>,
    pub expected: &'static str,
}

/// A table whose units and readings are checked as it is read.
pub(crate) struct CheckedTable {
    pub file: PathBuf,
    pub reader: TableReader,
    pub missing: Option<MissingReadings>,
    units: StatedUnits,
}

impl CheckedTable {
    /// Opens a table of these fields, in these units.
    pub fn open(
        source: Source,
        extent: Extent,
        fields: &[Field],
        units: StatedUnits,
        form: Form,
    ) -> Result<Self, Error> {
        let file = source.name().to_owned();
        let reader = TableReader::new(source, extent, fields, form.expected, form.lines)?;
        Ok(Self { file, reader, missing: form.missing, units })
    }

    /// Opens a table of columns, the first of them time, the others readings.
    pub fn of_columns(source: Source, extent: Extent, columns: &[&Column], form: Form) -> Result<Self, Error> {
        let fields = fields(columns, form.missing.unwrap_or_default());
        Self::open(source, extent, &fields, StatedUnits::of(columns.iter().copied()), form)
    }

    /// The next rows, several sets of them; none at the end.
    ///
    /// # Errors
    /// As of [`TableReader::next_batch`]; if the file names other units than those that are stated.
    pub fn next_batch(&mut self) -> Result<Option<&mut [Rows]>, Error> {
        let explain = |error| match self.missing {
            Some(missing) => missing.explain(error),
            None => error,
        };
        if self.reader.next_batch().map_err(explain)?.is_none() {
            return Ok(None);
        }
        self.units.check(&self.file, &self.reader)?;
        let batch = self.reader.batch();
        if let Some(missing) = self.missing {
            for rows in &mut *batch {
                missing.leave_out(rows);
            }
        }
        Ok(Some(batch))
    }
}
