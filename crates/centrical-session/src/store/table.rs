//! Rows of a store as one table, each with the session that it is of.

use std::path::Path;

use centrical_table::{Cell, Kind, TypedColumn, TypedWriter};

use super::folder::Store;
use super::row::Row;
use super::schema::{Depth, ENTRIES, Entry, ROWS_SCHEMA, SCHEMA_NOTE};
use crate::error::Error;

/// Rows of a row group.
const GROUP: usize = 1024;

/// A table in the making: the sessions in a column `session`, then the columns of a part but for covariances and shared influences.
pub struct RowTable {
    table: TypedWriter,
}

impl Store {
    /// Begins a table of rows.
    ///
    /// # Errors
    /// [`Error`] if the folder does not take it.
    pub fn begin_table(&self, file: &Path) -> Result<RowTable, Error> {
        let session = TypedColumn { name: "session", kind: Kind::Text };
        let columns: Vec<_> = std::iter::once(session).chain(entries().map(|entry| entry.column)).collect();
        Ok(RowTable { table: TypedWriter::create(file, &columns, &[(SCHEMA_NOTE, ROWS_SCHEMA)])? })
    }
}

impl RowTable {
    /// Adds rows by the names of their sessions.
    ///
    /// # Errors
    /// [`Error`] if they cannot be written.
    pub fn add(&mut self, rows: &[(&str, &Row)]) -> Result<(), Error> {
        for group in rows.chunks(GROUP) {
            let cells = group.iter().map(|(session, row)| {
                let own = entries().map(|entry| (entry.get)(row));
                std::iter::once(Cell::Text((*session).to_owned())).chain(own).collect()
            });
            self.table.write_group(&cells.collect::<Vec<_>>())?;
        }
        Ok(())
    }

    /// Ends the table; only now the file is there.
    ///
    /// # Errors
    /// [`Error`] if it cannot be written.
    pub fn finish(self) -> Result<(), Error> {
        Ok(self.table.finish()?)
    }
}

fn entries() -> impl Iterator<Item = &'static Entry> {
    ENTRIES.iter().filter(|entry| entry.depth <= Depth::Values)
}
