//! A table of a session: its units are those that are stated, and rows that lack a reading become what is stated of them.

use std::path::{Path, PathBuf};

use centrical_table::{Extent, Field, Rows, Source, TableLines, TableReader, UnitsFound};

use super::columns::{Column, MissingReadings, fields};
use crate::error::{Error, Place};
use crate::quantity::Dimension;

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

/// Names and units of columns as the session states them, until those of the file are known.
pub(crate) struct StatedUnits(Option<Vec<(String, String)>>);

impl StatedUnits {
    /// Names and units in the order of the values.
    pub fn new(columns: Vec<(String, String)>) -> Self {
        Self(Some(columns))
    }

    /// Those of columns.
    pub fn of<'a>(columns: impl IntoIterator<Item = &'a Column>) -> Self {
        Self::new(columns.into_iter().map(|column| (column.name.to_string(), column.unit.clone())).collect())
    }

    /// Sees, once, that the units of the file are the stated ones. A file contradicts nothing where it names no unit, or names one in
    /// words that are not understood.
    ///
    /// # Errors
    /// If the file names another unit.
    pub fn check(&mut self, file: &Path, table: &TableReader) -> Result<(), Error> {
        let (Some(stated), Some(UnitsFound { line, units })) = (self.0.take(), table.units()) else { return Ok(()) };
        for (found, (name, stated)) in units.iter().zip(stated) {
            let Some(found) = found.filter(|found| !stated.is_empty() && !is_same(found, &stated)) else { continue };
            let place = Place::Line { line, column: Some(name) };
            return Err(Error::content(file, place, format!("the unit {found}"), expected(&stated, found)));
        }
        Ok(())
    }
}

/// The stated unit, and where it is stated.
fn expected(stated: &str, found: &str) -> String {
    match stated {
        _ if Dimension::Time.factor(stated).is_some() || stated == "samples" => {
            format!("{stated}, as the session says ([columns]: time = {{ column = ..., unit = \"{found}\" }})")
        }
        _ if Dimension::Speed.factor(stated).is_some() => {
            format!("{stated}, as the session says (speed_unit in [columns])")
        }
        _ => format!("{stated}, as the session says (output_unit in [unit], or a unit in [columns])"),
    }
}

/// Whether two names are of one unit.
fn is_same(one: &str, other: &str) -> bool {
    const DIMENSIONS: [Dimension; 4] = [Dimension::Acceleration, Dimension::Time, Dimension::Speed, Dimension::Angle];
    let is_same =
        |dimension: Dimension| dimension.factor(one).is_some_and(|factor| dimension.factor(other) == Some(factor));
    one == other || DIMENSIONS.into_iter().any(is_same)
}
