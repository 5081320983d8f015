//! The columns of records and telemetry: what takes their numbers to SI, and a table that is checked by them as it is read. Its units
//! are those that are stated, and rows that lack a reading become what is stated of them.

use std::path::{Path, PathBuf};

use centrical::history::DAYS_IN_YEAR;
use centrical_table::{
    ColumnName, Extent, Field, Rows, Rule, Source, Stamps, TableLines, TableReader, UnitsFound, is_missing, to_scale,
};
use schemars::JsonSchema;
use serde::Deserialize;

use crate::error::{Error, Place};
use crate::units::Dimension;

/// What a record, the record of a newtonometer, telemetry, and times of pulses are expected to be.
pub(crate) const RECORD: &str = "a record";
pub(crate) const NEWTONOMETER_RECORD: &str = "the record of a newtonometer";
pub(crate) const TELEMETRY: &str = "telemetry";
pub(crate) const PULSES: &str = "times of pulses";

/// How rows that lack a reading are left out, for messages.
pub(crate) const LEFT_OUT: &str = "missing_readings = \"left out\" under [columns]";

/// The columns of records and telemetry.
#[derive(Debug, Clone, PartialEq)]
pub struct Columns {
    /// Time, in records.
    pub time: Column,
    /// Time, in the telemetry.
    pub telemetry_time: Column,
    /// Times of pulses.
    pub pulse: Column,
    /// Readings of newtonometers 1, 2, 3.
    pub f: [Column; 3],
    /// Speed, in the telemetry.
    pub speed: Column,
    /// Where the table begins in the text of a record, if that is not to be recognised.
    pub record_lines: TableLines,
    /// The same in the telemetry.
    pub telemetry_lines: TableLines,
    /// What becomes of rows that lack a reading.
    pub missing_readings: MissingReadings,
}

/// What becomes of the rows of a record that lack a reading: its field is empty, or a word for no number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
pub enum MissingReadings {
    /// The record is refused.
    #[default]
    #[serde(rename = "refused")]
    Refused,
    /// They are left out, as samples that the recorder lost.
    #[serde(rename = "left out")]
    LeftOut,
}

/// One column: how it is found and what takes it to SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// How it is found.
    pub name: ColumnName,
    /// Unit of its numbers, for messages.
    pub unit: String,
    /// What takes its numbers to SI.
    pub scale: Scale,
}

/// `(raw - offset) factor`: from the numbers in a file to SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// Raw value at zero [raw unit].
    pub offset: f64,
    /// SI per raw unit.
    pub factor: f64,
}

impl Scale {
    /// `raw factor`.
    pub const fn factor(factor: f64) -> Self {
        Self { offset: 0.0, factor }
    }

    /// The number in a file that stands for `si`.
    pub(crate) fn raw(self, si: f64) -> f64 {
        si / self.factor + self.offset
    }

    /// Takes the numbers of a column to SI, in place.
    pub(crate) fn apply(self, values: &mut [f64]) {
        if self != Self::factor(1.0) {
            to_scale(values, self.offset, self.factor);
        }
    }
}

/// First and last of the times of a record, of telemetry or of pulses [s].
#[derive(Debug, Clone, Copy)]
pub(crate) struct TimeSpan(pub [f64; 2]);

impl TimeSpan {
    /// Before the first time.
    pub const EMPTY: Self = Self([f64::INFINITY, f64::NEG_INFINITY]);

    /// Takes in further times, which do not run backwards.
    pub fn see(&mut self, times: &[f64]) {
        if let (Some(first), Some(last)) = (times.first(), times.last()) {
            self.0 = [self.0[0].min(*first), self.0[1].max(*last)];
        }
    }

    /// After the last time: refuses years, since time is in another unit then.
    ///
    /// # Errors
    /// [`Error`] at `place` in `file`, with the length.
    pub fn refuse_years(self, file: &Path, place: Place) -> Result<(), Error> {
        /// Longest record of a laboratory [years].
        const LONGEST: f64 = 10.0;
        let years = (self.0[1] - self.0[0]) / (DAYS_IN_YEAR * 86_400.0);
        if years > LONGEST {
            let expected =
                "time in s; another unit stands beside its column, as in time = { column = \"t\", unit = \"ns\" }";
            return Err(Error::content(file, place, format!("readings over {years:.0} years"), expected));
        }
        Ok(())
    }
}

impl Default for Columns {
    /// `t` [s], `f1`, `f2`, `f3` [m/s^2], `omega` [rad/s].
    fn default() -> Self {
        Self {
            time: Column::si("t", "s"),
            telemetry_time: Column::si("t", "s"),
            pulse: Column::si("t", "s"),
            f: ["f1", "f2", "f3"].map(|name| Column::si(name, "m/s^2")),
            speed: Column::si("omega", "rad/s"),
            record_lines: TableLines::default(),
            telemetry_lines: TableLines::default(),
            missing_readings: MissingReadings::default(),
        }
    }
}

impl Columns {
    /// Those of a record, time first.
    pub(super) fn of_record(&self) -> [&Column; 4] {
        let [f1, f2, f3] = &self.f;
        [&self.time, f1, f2, f3]
    }
}

impl Column {
    /// A column whose numbers are in SI.
    pub fn si(name: &str, unit: &str) -> Self {
        Self { name: ColumnName::Name(name.to_owned()), unit: unit.to_owned(), scale: Scale::factor(1.0) }
    }

    /// The column as a field of a table.
    pub(crate) fn field(&self, rule: Rule) -> Field {
        Field { name: self.name.clone(), expected: format!("a number in {}", self.unit), rule }
    }
}

/// The columns of a record without a session, as they are named by hand: time in s, or samples at a rate [Hz]; and readings,
/// whose numbers stay as they are unless `unit` is one of acceleration.
pub(crate) fn named_columns(
    time: &ColumnName,
    rate: Option<f64>,
    readings: &[ColumnName],
    unit: &str,
) -> (Column, Vec<Column>) {
    let column = |name: &ColumnName, unit: &str, factor| Column {
        name: name.clone(),
        unit: unit.to_owned(),
        scale: Scale::factor(factor),
    };
    let time = match rate {
        Some(rate) => column(&ColumnName::Row, "samples", 1.0 / rate),
        None => column(time, "s", 1.0),
    };
    let factor = Dimension::Acceleration.factor(unit).unwrap_or(1.0);
    (time, readings.iter().map(|name| column(name, unit, factor)).collect())
}

impl MissingReadings {
    /// Leaves out the rows that lack a reading, if so stated; the first column is time.
    pub(crate) fn leave_out(self, rows: &mut Rows) {
        self.leave_out_stamped(rows, &mut Stamps::default());
    }

    /// The same of rows with stamps.
    pub(crate) fn leave_out_stamped(self, rows: &mut Rows, stamps: &mut Stamps) {
        if self == Self::Refused {
            return;
        }
        let is_whole = |row: usize| rows[1..].iter().all(|readings| !readings[row].is_nan());
        let whole: Vec<bool> = (0..rows[0].len()).map(is_whole).collect();
        if whole.contains(&false) {
            *stamps = std::mem::take(stamps).of_rows(&whole);
            for column in rows {
                let mut whole = whole.iter();
                column.retain(|_| whole.next() == Some(&true));
            }
        }
    }

    /// An error about a reading that is missing says how such rows are left out; a row needs its `time`.
    fn explain(self, error: centrical_table::Error, time: &str) -> centrical_table::Error {
        use centrical_table::Error::Content;
        match error {
            Content { file, place, found, expected }
                if self == Self::Refused
                    && (found == "no value" || is_missing(found.trim_matches('"')))
                    && place.column() != Some(time) =>
            {
                let expected = format!("{expected}, or {LEFT_OUT}");
                Content { file, place, found, expected }
            }
            other => other,
        }
    }
}

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
    /// Name of the first column.
    time: String,
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
        let time = fields.first().map_or_else(String::new, |field| field.name.to_string());
        Ok(Self { file, reader, missing: form.missing, time, units })
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
            Some(missing) => missing.explain(error, &self.time),
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

/// Columns as fields of a table, the first of them time, the others readings.
fn fields(columns: &[&Column], missing: MissingReadings) -> Vec<Field> {
    let rule = |k: usize, column: &Column| match k {
        // A stamp is in seconds, whatever the numbers would be in.
        0 => Rule::Ascending { stamps: column.scale == Scale::factor(1.0) },
        _ if missing == MissingReadings::LeftOut => Rule::OrMissing,
        _ => Rule::Any,
    };
    columns.iter().enumerate().map(|(k, column)| column.field(rule(k, column))).collect()
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
