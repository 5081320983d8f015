//! Rows out of a store: one row group after the other, every key once.

use std::collections::{BTreeSet, HashSet, VecDeque};

use centrical::{OnProgress, advance, unwatched};

use super::folder::Store;
use super::part::Part;
use super::row::Row;
use super::schema::Depth;
use crate::error::{Error, ErrorKind};

/// Times that the parts are listed anew when one was merged away meanwhile.
const TRIES: usize = 100;

/// Which rows are read, and how deep. Without a filter all.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Selection {
    /// How much of each row.
    pub depth: Depth,
    /// Of this model of unit alone.
    pub unit_model: Option<String>,
    /// Of this serial number alone.
    pub unit_serial: Option<String>,
    /// Of this station alone.
    pub station: Option<String>,
    /// With these keys alone.
    pub keys: Option<BTreeSet<String>>,
}

/// The rows of a store, in no particular order.
pub struct Rows<'a> {
    selection: Selection,
    parts: VecDeque<Part>,
    group: usize,
    ready: std::vec::IntoIter<Row>,
    /// Keys that were seen.
    seen: HashSet<[u8; 32]>,
    progress: OnProgress<'a>,
}

impl Selection {
    /// Whether it asks for a model, a serial number or a station.
    pub fn names_any(&self) -> bool {
        [&self.unit_model, &self.unit_serial, &self.station].into_iter().any(Option::is_some)
    }

    /// Whether it picks a row.
    pub(crate) fn takes(&self, row: &Row) -> bool {
        let is = |wanted: &Option<String>, found: &str| wanted.as_deref().is_none_or(|wanted| wanted == found);
        is(&self.unit_model, &row.unit_model)
            && is(&self.unit_serial, &row.unit_serial)
            && is(&self.station, &row.station)
            && self.has_key(&row.key)
    }

    fn has_key(&self, key: &str) -> bool {
        self.keys.as_ref().is_none_or(|keys| keys.contains(key))
    }
}

impl Store {
    /// The rows that a selection picks, every key once. They are of the store as it is now, whatever is added or merged meanwhile.
    /// Memory is bounded by a row group of 128 rows, and 32 bytes a key. `progress` is asked at each row group, with none done.
    ///
    /// # Errors
    /// [`Error`] if a part cannot be opened; later ones, and [`Error::Stopped`], come in the place of a row.
    pub fn rows<'a>(&self, selection: Selection, progress: OnProgress<'a>) -> Result<Rows<'a>, Error> {
        let parts = self.open_parts()?.into();
        Ok(Rows { selection, parts, group: 0, ready: Vec::new().into_iter(), seen: HashSet::new(), progress })
    }

    /// The whole row of a key.
    ///
    /// # Errors
    /// As [`Store::rows`].
    pub fn row(&self, key: &str) -> Result<Option<Row>, Error> {
        let keys = Some(BTreeSet::from([key.to_owned()]));
        self.rows(Selection { depth: Depth::Whole, keys, ..Selection::default() }, &unwatched)?.next().transpose()
    }

    /// The parts as they are now: a writer that merges removes a part only after the merged one is there.
    pub(super) fn open_parts(&self) -> Result<Vec<Part>, Error> {
        for _ in 0..TRIES {
            match self.parts()?.iter().map(|file| Part::open(file)).collect::<Result<Vec<_>, _>>() {
                Err(error) if error.kind() == ErrorKind::Missing => {}
                parts => return parts,
            }
        }
        self.parts()?.iter().map(|file| Part::open(file)).collect()
    }
}

impl Iterator for Rows<'_> {
    type Item = Result<Row, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(row) = self.ready.next() {
                return Some(Ok(row));
            }
            let part = self.parts.front()?;
            if self.group == part.groups() {
                self.parts.pop_front();
                self.group = 0;
                continue;
            }
            let (selection, seen) = (&self.selection, &mut self.seen);
            let wanted = |row: &Row| selection.takes(row) && seen.insert(bytes(&row.key));
            let read = advance(self.progress, 0).map_err(Error::from);
            let read = read.and_then(|()| part.read(self.group, selection.depth, |key| selection.has_key(key), wanted));
            self.group += 1;
            match read {
                Ok(rows) => self.ready = rows.into_iter(),
                Err(error) => {
                    // Nothing after it: half of a history would look like a history.
                    self.parts.clear();
                    return Some(Err(error));
                }
            }
        }
    }
}

/// The bytes of a hexadecimal key.
fn bytes(key: &str) -> [u8; 32] {
    let mut bytes = [0; 32];
    for (byte, digits) in bytes.iter_mut().zip(key.as_bytes().chunks(2)) {
        let digits = std::str::from_utf8(digits).unwrap_or_default();
        *byte = u8::from_str_radix(digits, 16).unwrap_or_default();
    }
    bytes
}
