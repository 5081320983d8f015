//! Rows into a store: what is missing becomes one part, small parts are merged. And rows as one table, each with its session.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashSet};
use std::fs::File;
use std::path::Path;
use std::{fs, iter};

use centrical::{OnProgress, advance, unwatched};
use centrical_table::{Cell, Kind, Source, TypedColumn, TypedWriter, create_folder, write_whole};

use super::folder::Store;
use super::part::{self, Part};
use super::row::Row;
use super::schema::{Depth, ENTRIES, Entry, ROWS_SCHEMA, SCHEMA_NOTE};
use crate::error::Error;

/// Parts of one class of sizes that are merged into one; a class is as many times larger than the one before.
const MERGED: usize = 32;

/// Rows above which a part is never written again.
const FINAL: u64 = 4096;

/// What became of rows that were to be added.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Added {
    /// Rows that were not there.
    pub new: usize,
    /// Rows that were there.
    pub known: usize,
}

impl Store {
    /// Adds rows that are not there yet, as one part, and waits for other writers before. A caller with many rows adds some
    /// thousand at a time: each has 11 kB.
    ///
    /// # Errors
    /// [`Error`] if a part is damaged or the folder does not take a file; nothing is added then.
    pub fn add(&self, rows: Vec<Row>) -> Result<Added, Error> {
        self.add_with_results(rows.into_iter().map(|row| (row, None)).collect(), &unwatched)
    }

    /// The same with the bytes of `result.json` of each, which are copied first. `progress` is asked between copies; where it stops the work,
    /// copies may be there without their rows, for the next writer.
    ///
    /// # Errors
    /// As [`Store::add`]; [`Error::Stopped`].
    pub fn add_with_results(
        &self,
        rows: Vec<(Row, Option<Vec<u8>>)>,
        progress: OnProgress<usize>,
    ) -> Result<Added, Error> {
        let _lock = self.lock()?;
        for orphan in self.orphans()? {
            // Best effort: the next writer tries again.
            let _ = fs::remove_file(orphan);
        }
        let mut parts = self.parts_with_keys()?;
        let mut known: HashSet<&str> = parts.iter().flat_map(|part| &part.keys).map(String::as_str).collect();
        let count = rows.len();
        let mut new: Vec<Row> = Vec::new();
        for (row, result) in rows {
            if known.contains(row.key.as_str()) || new.iter().rev().take(1).any(|last| last.key == row.key) {
                continue;
            }
            if let Some(bytes) = result {
                self.copy_result(&row.key, &bytes)?;
                advance(progress, 0)?;
            }
            new.push(row);
        }
        known.clear();
        new.sort_by_cached_key(part::order);
        new.dedup_by(|a, b| a.key == b.key);
        let added = Added { new: new.len(), known: count - new.len() };
        if !new.is_empty() {
            let keys: Vec<String> = new.iter().map(|row| row.key.clone()).collect();
            let file = part::write(&self.rows_folder(), &keys, new.into_iter().map(Ok))?;
            parts.push(Keyed { part: Part::open(&file)?, keys });
        }
        self.merge(parts)?;
        Ok(added)
    }

    /// A copy that is there stays, unless it is damaged: it may be what the caller reads.
    fn copy_result(&self, key: &str, bytes: &[u8]) -> Result<(), Error> {
        let file = self.result_file(key);
        let there = Source::open(&file, "a result").and_then(|there| there.bytes(bytes.len() as u64, "a result"));
        if there.is_ok_and(|there| there == bytes) {
            return Ok(());
        }
        create_folder(&self.results_folder())?;
        Ok(write_whole(&file, bytes)?)
    }

    /// The parts with their keys. One all of whose keys stand in the others is what a killed merge left, and is removed.
    fn parts_with_keys(&self) -> Result<Vec<Keyed>, Error> {
        let mut parts = Vec::new();
        for part in self.open_parts()? {
            let keys = part.keys()?;
            parts.push(Keyed { part, keys });
        }
        parts.sort_by_key(|keyed| Reverse(keyed.keys.len()));
        let mut seen: HashSet<String> = HashSet::new();
        parts.retain(|keyed| {
            let before = seen.len();
            seen.extend(keyed.keys.iter().cloned());
            let is_needed = seen.len() > before;
            if !is_needed {
                let _ = fs::remove_file(keyed.part.file());
            }
            is_needed
        });
        Ok(parts)
    }

    /// Merges each class of sizes that has enough parts, from the smallest.
    fn merge(&self, mut parts: Vec<Keyed>) -> Result<(), Error> {
        let mut class = (1, MERGED as u64);
        while class.0 < FINAL {
            let is_of_class = |part: &Part| (class.0..class.1.min(FINAL)).contains(&part.rows());
            if parts.iter().filter(|keyed| is_of_class(&keyed.part)).count() >= MERGED {
                let (merged, others): (Vec<Keyed>, Vec<Keyed>) =
                    parts.into_iter().partition(|keyed| is_of_class(&keyed.part));
                parts = others;
                parts.push(self.merge_into_one(&merged)?);
            }
            class = (class.1, class.1 * MERGED as u64);
        }
        Ok(())
    }

    /// One part in place of several: it is there before they go.
    fn merge_into_one(&self, parts: &[Keyed]) -> Result<Keyed, Error> {
        let keys: HashSet<String> = parts.iter().flat_map(|keyed| keyed.keys.iter().cloned()).collect();
        let keys: Vec<String> = keys.into_iter().collect();
        let file = part::write(&self.rows_folder(), &keys, in_order(parts))?;
        if let Ok(folder) = File::open(self.rows_folder()) {
            // The name of the merged part is on the disk before the others lose theirs, where the system can say so.
            let _ = folder.sync_all();
        }
        for old in parts.iter().map(|keyed| keyed.part.file()).filter(|old| *old != file) {
            let _ = fs::remove_file(old);
        }
        Ok(Keyed { part: Part::open(&file)?, keys })
    }
}

/// A part and its keys.
struct Keyed {
    part: Part,
    keys: Vec<String>,
}

/// The rows of parts in their common order, every key once. Of each part one row group is held.
fn in_order(parts: &[Keyed]) -> impl Iterator<Item = Result<Row, Error>> + '_ {
    let mut streams: Vec<_> = parts.iter().map(|keyed| stream(&keyed.part)).collect();
    let mut heads: BinaryHeap<Reverse<_>> = BinaryHeap::new();
    let mut waiting: Vec<Option<Row>> = Vec::new();
    let mut failed = None;
    for (n, stream) in streams.iter_mut().enumerate() {
        waiting.push(None);
        pull(stream, n, &mut heads, &mut waiting, &mut failed);
    }
    let mut last = String::new();
    iter::from_fn(move || {
        loop {
            if let Some(error) = failed.take() {
                heads.clear();
                return Some(Err(error));
            }
            let Reverse((_, n)) = heads.pop()?;
            let row = waiting[n].take();
            pull(&mut streams[n], n, &mut heads, &mut waiting, &mut failed);
            if let Some(row) = row.filter(|row| row.key != last) {
                last.clone_from(&row.key);
                return Some(Ok(row));
            }
        }
    })
}

/// What rows are ordered by, and the stream that one waits in.
type Head = Reverse<((String, String, Option<i64>, String), usize)>;

fn pull(
    stream: &mut impl Iterator<Item = Result<Row, Error>>,
    n: usize,
    heads: &mut BinaryHeap<Head>,
    waiting: &mut [Option<Row>],
    failed: &mut Option<Error>,
) {
    match stream.next() {
        Some(Ok(row)) => {
            heads.push(Reverse((part::order(&row), n)));
            waiting[n] = Some(row);
        }
        Some(Err(error)) => *failed = Some(error),
        None => {}
    }
}

/// The whole rows of a part.
fn stream(part: &Part) -> impl Iterator<Item = Result<Row, Error>> + '_ {
    (0..part.groups()).flat_map(|group| match part.read(group, Depth::Whole, |_| true, |_| true) {
        Ok(rows) => rows.into_iter().map(Ok).collect::<Vec<_>>(),
        Err(error) => vec![Err(error)],
    })
}

/// Rows of a row group.
const GROUP: usize = 1024;

/// A table in the making: the sessions in a column `session`, then the columns of a part but for covariances and shared influences.
pub(crate) struct RowTable {
    table: TypedWriter,
}

impl RowTable {
    /// Begins a table of rows.
    ///
    /// # Errors
    /// [`Error`] if the folder does not take it.
    pub fn create(file: &Path) -> Result<Self, Error> {
        let session = TypedColumn { name: "session", kind: Kind::Text };
        let columns: Vec<_> = std::iter::once(session).chain(entries().map(|entry| entry.column)).collect();
        Ok(Self { table: TypedWriter::create(file, &columns, &[(SCHEMA_NOTE, ROWS_SCHEMA)])? })
    }

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
