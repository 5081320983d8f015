//! Records of the unit and telemetry of the centrifuge, in SI.

use std::path::Path;

use crate::error::Error;
use crate::table::{self, ColumnName, Extent, Field, Rule};

/// The columns of records and telemetry.
#[derive(Debug, Clone, PartialEq)]
pub struct Columns {
    /// Time, in both.
    pub time: Column,
    /// Readings of newtonometers 1, 2, 3.
    pub f: [Column; 3],
    /// Speed, in the telemetry.
    pub speed: Column,
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

/// One continuous record of a mounting.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Record {
    /// Time by the unit's clock [s].
    pub t: Vec<f64>,
    /// Readings of newtonometers 1, 2, 3 [m/s^2].
    pub f: [Vec<f64>; 3],
}

/// A stretch of a record: slices of equal length.
#[derive(Debug, Clone, Copy)]
pub struct RecordBlock<'a> {
    /// Time by the unit's clock [s].
    pub t: &'a [f64],
    /// Readings of newtonometers 1, 2, 3 [m/s^2].
    pub f: [&'a [f64]; 3],
}

/// The centrifuge's own account of its speed.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Telemetry {
    /// Time by the centrifuge's clock [s].
    pub t: Vec<f64>,
    /// Angular speed [rad/s], with the sign that the telemetry gives it.
    pub omega: Vec<f64>,
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

    fn apply(self, values: &mut [f64]) {
        if self != Self::factor(1.0) {
            for value in values {
                *value = (*value - self.offset) * self.factor;
            }
        }
    }
}

impl Default for Columns {
    /// `t` [s], `f1`, `f2`, `f3` [m/s^2], `omega` [rad/s].
    fn default() -> Self {
        Self {
            time: Column::si("t", "s"),
            f: ["f1", "f2", "f3"].map(|name| Column::si(name, "m/s^2")),
            speed: Column::si("omega", "rad/s"),
        }
    }
}

impl Column {
    /// A column whose numbers are in SI.
    pub fn si(name: &str, unit: &str) -> Self {
        Self { name: ColumnName::Name(name.to_owned()), unit: unit.to_owned(), scale: Scale::factor(1.0) }
    }

    fn field(&self, rule: Rule) -> Field {
        Field { name: self.name.clone(), expected: format!("a number in {}", self.unit), rule }
    }
}

impl Record {
    /// Reads the whole record of `file`.
    ///
    /// # Errors
    /// As [`Record::scan`].
    pub fn read(file: &Path, columns: &Columns) -> Result<Self, Error> {
        let mut record = Self::default();
        Self::scan(file, columns, &mut |block| record.extend(block))?;
        Ok(record)
    }

    /// Hands the record of `file` to `visit` block by block, in memory that does not grow with the record.
    ///
    /// Time never decreases from row to row; it may stand still, as real streams repeat samples.
    ///
    /// # Errors
    /// If the file can not be read, has no rows, lacks a column, or a value is no finite number; if time runs
    /// backwards.
    pub fn scan(file: &Path, columns: &Columns, visit: &mut dyn FnMut(RecordBlock)) -> Result<(), Error> {
        Self::scan_extent(file, Extent::Whole, columns, visit)
    }

    /// Reads what has come of a record that is still being written: a last line that is not ended is left for the next
    /// time. A file of another format than text has to appear whole, by renaming.
    ///
    /// # Errors
    /// As [`Record::scan`].
    pub fn read_growing(file: &Path, columns: &Columns) -> Result<Self, Error> {
        let mut record = Self::default();
        Self::scan_extent(file, Extent::Growing, columns, &mut |block| record.extend(block))?;
        Ok(record)
    }

    fn extend(&mut self, block: RecordBlock) {
        self.t.extend_from_slice(block.t);
        for (whole, piece) in self.f.iter_mut().zip(block.f) {
            whole.extend_from_slice(piece);
        }
    }

    fn scan_extent(
        file: &Path,
        extent: Extent,
        columns: &Columns,
        visit: &mut dyn FnMut(RecordBlock),
    ) -> Result<(), Error> {
        let [f1, f2, f3] = &columns.f;
        read_scaled(file, extent, &[&columns.time, f1, f2, f3], "a record", &mut |block| {
            visit(RecordBlock { t: &block[0], f: [&block[1], &block[2], &block[3]] });
        })
    }
}

impl Telemetry {
    /// Reads the telemetry of `file`.
    ///
    /// # Errors
    /// As [`Record::scan`].
    pub fn read(file: &Path, columns: &Columns) -> Result<Self, Error> {
        let mut telemetry = Self::default();
        read_scaled(file, Extent::Whole, &[&columns.time, &columns.speed], "telemetry", &mut |block| {
            telemetry.t.extend_from_slice(&block[0]);
            telemetry.omega.extend_from_slice(&block[1]);
        })?;
        Ok(telemetry)
    }
}

/// Reads columns, the first of them time, and takes them to SI.
fn read_scaled(
    file: &Path,
    extent: Extent,
    columns: &[&Column],
    expected: &str,
    visit: &mut dyn FnMut(&[Vec<f64>]),
) -> Result<(), Error> {
    let time = columns[0];
    // A row's number is not in the file; a stamp is in seconds, whatever the numbers would be in.
    let counted = usize::from(time.name == ColumnName::Row);
    let stamps = Rule::Ascending { stamps: time.scale == Scale::factor(1.0) };
    let rule = |k| if k == 0 { stamps } else { Rule::Any };
    let fields: Vec<Field> =
        columns.iter().enumerate().map(|(k, column)| column.field(rule(k))).skip(counted).collect();
    let mut scaled = vec![Vec::new(); columns.len()];
    let mut rows = 0_u64;
    table::read_extent(file, extent, &fields, expected, &mut |block| {
        let first = rows;
        rows += block[0].len() as u64;
        if counted == 1 {
            scaled[0] = (first..rows).map(|row| row as f64).collect();
        }
        scaled[counted..].swap_with_slice(block);
        for (values, column) in scaled.iter_mut().zip(columns) {
            column.scale.apply(values);
        }
        visit(&scaled);
        scaled[counted..].swap_with_slice(block);
    })
}
