//! A part of a store: rows in one Parquet file, in the order of unit, day and key, never changed.

use std::path::{Path, PathBuf};

use centrical_table::{Cell, TypedReader, TypedWriter};

use super::contradiction::contradiction;
use super::row::{Row, sha256};
use super::schema::{Depth, ENTRIES, ROWS_SCHEMA, Read, SCHEMA_NOTE, VERSION, cells, columns, misshapen};
use crate::error::{Error, Place, quoted};

/// Rows of a row group: a MB of covariances, which is what a reader holds of a part.
const GROUP: usize = 128;

/// A part, open.
pub(super) struct Part {
    file: PathBuf,
    table: TypedReader,
}

impl Part {
    /// Opens a part.
    ///
    /// # Errors
    /// [`Error`] if it is damaged, or of a newer schema.
    pub fn open(file: &Path) -> Result<Self, Error> {
        let table = TypedReader::open(file, "a part of a store")?;
        let schema = table.note(SCHEMA_NOTE).unwrap_or("none");
        let version = schema.strip_prefix("centrical-rows/").and_then(|version| version.parse::<i64>().ok());
        if version.is_none_or(|version| version > VERSION) {
            let expected = format!("schema {ROWS_SCHEMA:?} or an older one; a newer program reads newer ones");
            let found = format!("schema {}", quoted(schema.as_bytes()));
            return Err(Error::content(file, Place::Whole, found, expected));
        }
        Ok(Self { file: file.to_owned(), table })
    }

    /// The file.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// Number of row groups.
    pub fn groups(&self) -> usize {
        self.table.groups()
    }

    /// Number of rows.
    pub fn rows(&self) -> u64 {
        self.table.rows()
    }

    /// All keys.
    pub fn keys(&self) -> Result<Vec<String>, Error> {
        let mut keys = Vec::new();
        for group in 0..self.groups() {
            let cells = self.table.read(group, ENTRIES[0].column)?.unwrap_or_default();
            keys.extend(cells.into_iter().filter_map(|cell| if let Cell::Text(key) = cell { Some(key) } else { None }));
        }
        Ok(keys)
    }

    /// The rows of a row group whose keys `has_key` picks, and `wanted` by their summaries, as deep as asked for. What is deeper is read only
    /// where a row is wanted.
    pub fn read(
        &self,
        group: usize,
        depth: Depth,
        has_key: impl Fn(&str) -> bool,
        mut wanted: impl FnMut(&Row) -> bool,
    ) -> Result<Vec<Row>, Error> {
        let mut rows: Vec<Option<Row>> = Vec::new();
        for (at, entry) in ENTRIES.iter().enumerate() {
            if at > 0 && entry.depth != ENTRIES[at - 1].depth && entry.depth == Depth::Values {
                for row in &mut rows {
                    row.take_if(|row| !wanted(row));
                }
            }
            if entry.depth > depth || (entry.depth > Depth::Summary && rows.iter().all(Option::is_none)) {
                continue;
            }
            let Some(cells) = self.table.read(group, entry.column)? else { continue };
            if at == 0 {
                rows.resize_with(cells.len(), || Some(Row::default()));
            }
            for (at, (row, cell)) in rows.iter_mut().zip(cells).enumerate() {
                if let Some((found, expected)) = misshapen(entry.column.name, &cell) {
                    return Err(self.wrong(group, at, entry.column.name, found, expected));
                }
                if let Some(row) = row {
                    (entry.set)(row, Read(cell));
                }
            }
            if at == 0 && !rows.iter().flatten().any(|row| has_key(&row.key)) {
                return Ok(Vec::new());
            }
        }
        for (at, row) in rows.iter().enumerate() {
            if let Some((column, found, expected)) = row.as_ref().and_then(|row| contradiction(row, depth)) {
                return Err(self.wrong(group, at, column, found, expected));
            }
        }
        Ok(rows.into_iter().flatten().collect())
    }

    /// The error of a row, the `at`th of its group.
    fn wrong(&self, group: usize, at: usize, column: &str, found: String, expected: String) -> Error {
        let row = self.table.rows_before(group) + at as u64 + 1;
        Error::content(&self.file, Place::Row { row, column: column.to_owned() }, found, expected)
    }
}

/// Writes rows that come in order into one part, named by their keys, which are given in the same order. The part that it is.
///
/// # Errors
/// [`Error`] if a row cannot be read or the folder does not take the part.
pub(super) fn write(
    folder: &Path,
    keys: &[String],
    rows: impl Iterator<Item = Result<Row, Error>>,
) -> Result<PathBuf, Error> {
    let mut sorted: Vec<&str> = keys.iter().map(String::as_str).collect();
    sorted.sort_unstable();
    let file = folder.join(format!("{}.parquet", &sha256(sorted.join("\n").as_bytes())[..32]));
    let mut table = TypedWriter::create(&file, &columns(), &[(SCHEMA_NOTE, ROWS_SCHEMA)])?;
    let mut group = Vec::with_capacity(GROUP);
    for row in rows {
        group.push(cells(&row?));
        if group.len() == GROUP {
            table.write_group(&group)?;
            group.clear();
        }
    }
    table.write_group(&group)?;
    table.finish()?;
    Ok(file)
}

/// What rows of a part are ordered by.
pub(super) fn order(row: &Row) -> (String, String, Option<i64>, String) {
    (row.unit_model.clone(), row.unit_serial.clone(), row.day, row.key.clone())
}
