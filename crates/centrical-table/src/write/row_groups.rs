//! Tables as Parquet, written behind.

use std::io;

use super::output::{Output, Sink, SteadyFile};
use super::parquet::{Layout, ParquetTable, RowGroup};
use crate::stamp::{Stamps, TickForm, TickUnit};

/// Row groups that may wait to be written.
const AHEAD: usize = 1;

/// A Parquet file in the making. Its schema waits for the first rows, which may begin with stamps.
pub(super) struct RowGroups {
    stage: Stage,
    /// The next one.
    next: RowGroup,
    /// Rows that were added.
    count: u64,
}

enum Stage {
    /// Nothing is written; the names of the columns.
    Unwritten { file: SteadyFile, names: Vec<String> },
    /// Row groups are written, with stamps that are counted so, if any.
    Writing { output: Output<RowGroup>, stamps: Option<TickForm> },
    /// It could not be begun.
    Failed,
}

impl Sink<RowGroup> for ParquetTable<SteadyFile> {
    fn write(&mut self, group: &mut RowGroup) -> io::Result<()> {
        self.write_group(group)
    }

    fn finish(self) -> io::Result<()> {
        ParquetTable::finish(self)?.finish()
    }
}

impl RowGroups {
    /// Takes the file.
    pub fn new(file: SteadyFile, names: &[&str]) -> Self {
        let names = names.iter().map(|name| (*name).to_owned()).collect();
        Self { stage: Stage::Unwritten { file, names }, next: RowGroup::default(), count: 0 }
    }

    /// Adds rows, piece after piece.
    pub fn write(&mut self, pieces: &[&[&[f64]]]) -> io::Result<()> {
        for columns in pieces.iter().filter(|columns| !columns[0].is_empty()) {
            if self.stamps(None)?.is_some() {
                return Err(self.without_stamp(0));
            }
            self.count += columns[0].len() as u64;
            if self.next.add(columns) {
                self.flush()?;
            }
        }
        Ok(())
    }

    /// Adds rows with these stamps in place of the numbers of the first column, if the first row of all has one that can be counted.
    pub fn write_stamped(&mut self, stamps: &Stamps, columns: &[&[f64]]) -> io::Result<()> {
        let [first, others @ ..] = columns else { return Ok(()) };
        let rows = first.len();
        if rows == 0 {
            return Ok(());
        }
        let Some(form) = self.stamps(stamps.form())? else { return self.write(&[columns]) };
        // Of seconds, which Parquet does not count, milliseconds.
        let factor = if form.unit == TickUnit::Second { 1000 } else { 1 };
        let counted = |row| stamps.ticks(row, form)?.checked_mul(factor);
        let ticks = (0..rows).map(|row| counted(row).ok_or_else(|| self.without_stamp(row)));
        let ticks: Vec<i64> = ticks.collect::<io::Result<_>>()?;
        self.count += rows as u64;
        if self.next.add_stamped(&ticks, others) { self.flush() } else { Ok(()) }
    }

    /// Writes the rest and sees it to the disk.
    pub fn finish(mut self) -> io::Result<()> {
        self.stamps(None)?;
        self.flush()?;
        match self.stage {
            Stage::Writing { output, .. } => output.finish(),
            Stage::Unwritten { .. } | Stage::Failed => Err(not_begun()),
        }
    }

    /// How the stamps of the file are counted, if it has any; it is begun, with those of the first rows, if it was not.
    fn stamps(&mut self, of_first: Option<TickForm>) -> io::Result<Option<TickForm>> {
        self.stage = match std::mem::replace(&mut self.stage, Stage::Failed) {
            Stage::Unwritten { file, names } => {
                let table = ParquetTable::new(file, Layout::PLAIN, &names, of_first)?;
                Stage::Writing { output: Output::new(table, AHEAD)?, stamps: of_first }
            }
            begun => begun,
        };
        match &self.stage {
            Stage::Writing { stamps, .. } => Ok(*stamps),
            Stage::Unwritten { .. } | Stage::Failed => Err(not_begun()),
        }
    }

    /// Ends the row group.
    fn flush(&mut self) -> io::Result<()> {
        let Stage::Writing { output, .. } = &mut self.stage else { return Err(not_begun()) };
        let mut room = output.room();
        room.clear();
        output.send(std::mem::replace(&mut self.next, room))
    }

    /// A row, counted from those that were added, does not fit the column of timestamps.
    fn without_stamp(&self, row: usize) -> io::Error {
        let row = self.count + row as u64 + 1;
        io::Error::new(
            io::ErrorKind::InvalidData,
            format!(
                "row {row} has no date, or an offset from UTC where the first row has none, or none where it has one"
            ),
        )
    }
}

fn not_begun() -> io::Error {
    io::Error::other("its first rows could not be written")
}
