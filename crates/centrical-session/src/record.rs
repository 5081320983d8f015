//! Records of the unit and telemetry of the centrifuge, in SI.

mod input;
mod kept;
mod overview;
mod passes;
mod times;

use std::path::Path;

use centrical::reduction::{Record, RecordSlice, SpeedTrace};
use centrical_table::{Block, ColumnName, Extent, Field, Index, Rule, Visitor};

pub use self::input::Input;
pub(crate) use self::kept::{Kept, Room};
pub use self::overview::RecordOverview;
pub(crate) use self::passes::{RecordFile, Windows};
use crate::error::Error;

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

/// Reads the whole record of `file`.
///
/// # Errors
/// As [`scan_record`].
pub fn read_record(file: &Path, columns: &Columns) -> Result<Record, Error> {
    let mut record = Record::default();
    scan_record(file, columns, &mut |stretch| record.extend(stretch))?;
    Ok(record)
}

/// Reads what has come of a record that is still being written: a last line that is not ended is left for the next
/// time. A file of another format than text has to appear whole, by renaming.
///
/// # Errors
/// As [`scan_record`].
pub fn read_growing_record(file: &Path, columns: &Columns) -> Result<Record, Error> {
    let mut record = Record::default();
    columns.of_record().scan(file, Extent::Growing, &mut |stretch| record.extend(stretch))?;
    Ok(record)
}

/// Hands the record of `file` to `visit` stretch by stretch, in memory that does not grow with the record.
///
/// Time never decreases from row to row; it may stand still, as real streams repeat samples.
///
/// # Errors
/// If the file can not be read, has no rows, lacks a column, or a value is no finite number; if time runs
/// backwards.
pub fn scan_record(file: &Path, columns: &Columns, visit: &mut dyn FnMut(RecordSlice)) -> Result<(), Error> {
    columns.of_record().scan(file, Extent::Whole, visit)
}

/// Hands the blocks of the record over, several at a time, to be worked on where they are.
///
/// # Errors
/// As [`scan_record`].
pub(crate) fn scan_blocks(file: &Path, columns: &Columns, visit: &mut dyn FnMut(&mut [Block])) -> Result<(), Error> {
    columns.of_record().read(file, Extent::Whole, &|_| {}, visit).map(|_| ())
}

/// Reads the telemetry of `file`.
///
/// # Errors
/// As [`scan_record`].
pub fn read_telemetry(file: &Path, columns: &Columns) -> Result<SpeedTrace, Error> {
    let mut telemetry = SpeedTrace::default();
    let mut visit = |block: &Block| {
        telemetry.t.extend_from_slice(&block[0]);
        telemetry.omega.extend_from_slice(&block[1]);
    };
    Wanted { columns: vec![&columns.time, &columns.speed], expected: "telemetry" }.read(
        file,
        Extent::Whole,
        &|_| {},
        &mut |blocks| blocks.iter().for_each(&mut visit),
    )?;
    Ok(telemetry)
}

/// Columns to read, the first of them time.
#[derive(Debug, Clone)]
struct Wanted<'a> {
    columns: Vec<&'a Column>,
    /// What they are, for messages.
    expected: &'static str,
}

impl Columns {
    fn of_record(&self) -> Wanted<'_> {
        let [f1, f2, f3] = &self.f;
        Wanted { columns: vec![&self.time, f1, f2, f3], expected: "a record" }
    }
}

/// A block of a record, in SI.
pub(crate) fn stretch(block: &Block) -> RecordSlice<'_> {
    RecordSlice { t: &block[0], f_z: [&block[1], &block[2], &block[3]] }
}

impl Wanted<'_> {
    /// What of them is in a file: a row's number is not.
    fn fields(&self) -> Vec<Field> {
        let time = self.columns[0];
        // A stamp is in seconds, whatever the numbers would be in.
        let stamps = Rule::Ascending { stamps: time.scale == Scale::factor(1.0) };
        let rule = |k| if k == 0 { stamps } else { Rule::Any };
        let fields = self.columns.iter().enumerate().map(|(k, column)| column.field(rule(k)));
        fields.skip(usize::from(self.rows_are_counted())).collect()
    }

    fn rows_are_counted(&self) -> bool {
        self.columns[0].name == ColumnName::Row
    }

    /// Takes a block, whose first row has that number, to SI.
    fn to_si(&self, first_row: u64, block: &mut Block) {
        if self.rows_are_counted() {
            let rows = first_row..first_row + block[0].len() as u64;
            block.insert(0, rows.map(|row| row as f64).collect());
        }
        for (values, column) in block.iter_mut().zip(&self.columns) {
            column.scale.apply(values);
        }
    }

    /// Makes room in a block for what comes next from the file.
    fn give_back(&self, block: &mut Block) {
        if self.rows_are_counted() {
            block.remove(0);
        }
    }

    /// Reads them, batch by batch, in SI.
    fn read(
        &self,
        file: &Path,
        extent: Extent,
        progress: &(dyn Fn(u64) + Sync),
        visit: &mut dyn FnMut(&mut [Block]),
    ) -> Result<Option<Index>, Error> {
        let mut rows = 0;
        let mut to_si = |blocks: &mut [Block]| {
            for block in blocks.iter_mut() {
                let first = rows;
                rows += block[0].len() as u64;
                self.to_si(first, block);
            }
            visit(blocks);
            for block in blocks {
                self.give_back(block);
            }
        };
        let mut visitor = Visitor { visit: &mut to_si, progress };
        Ok(centrical_table::read_batches(file, extent, &self.fields(), self.expected, &mut visitor)?)
    }

    /// Hands the stretches of a record over, one by one.
    fn scan(&self, file: &Path, extent: Extent, visit: &mut dyn FnMut(RecordSlice)) -> Result<(), Error> {
        let mut each = |blocks: &mut [Block]| blocks.iter().for_each(|block| visit(stretch(block)));
        self.read(file, extent, &|_| {}, &mut each).map(|_| ())
    }
}
