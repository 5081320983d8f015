//! CRC-32 of the cells of each column in each row group, which the footer of a table with several kinds of columns keeps: pages are written
//! without checksums, and a bit that flips in a number leaves a number.

use std::fmt::Write;

use crc32fast::Hasher;

use super::cells::{Cell, Kind};

/// The key in the footer. Its text has eight hexadecimal digits for the names of the columns, and for each column of each row group.
pub const CHECKSUMS: &str = "centrical_crc32";

/// The checksums of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Checksums {
    names: u32,
    /// Of columns, row group after row group.
    chunks: Vec<u32>,
}

impl Checksums {
    /// Those of a table with columns of these names, before its first row group.
    pub fn of_names<'n>(names: impl Iterator<Item = &'n str>) -> Self {
        let mut hasher = Hasher::new();
        names.for_each(|name| put_text(&mut hasher, name));
        Self { names: hasher.finalize(), chunks: Vec::new() }
    }

    /// Those that a footer keeps; `None` where the columns have other names, or another number over all row groups.
    pub fn kept<'n>(text: &str, names: impl Iterator<Item = &'n str>, chunks: usize) -> Option<Self> {
        let digits = text.as_bytes().chunks(8).map(|digits| std::str::from_utf8(digits).ok());
        let sums = digits.map(|digits| u32::from_str_radix(digits?, 16).ok()).collect::<Option<Vec<u32>>>()?;
        let (first, rest) = sums.split_first()?;
        let found = Self { names: *first, chunks: rest.to_vec() };
        (found.names == Self::of_names(names).names && found.chunks.len() == chunks).then_some(found)
    }

    /// Adds the next column of the last row group.
    pub fn push<'c>(&mut self, kind: Kind, cells: impl Iterator<Item = &'c Cell>) {
        self.chunks.push(of_cells(kind, cells));
    }

    /// Whether cells are those that were written as this column, counted over all row groups.
    pub fn hold<'c>(&self, chunk: usize, kind: Kind, cells: impl Iterator<Item = &'c Cell>) -> bool {
        self.chunks.get(chunk) == Some(&of_cells(kind, cells))
    }

    /// The text for the footer.
    pub fn text(&self) -> String {
        let mut text = String::new();
        for sum in std::iter::once(&self.names).chain(&self.chunks) {
            let _ = write!(text, "{sum:08x}");
        }
        text
    }
}

/// Cells as they are read again: one of another kind is nothing or an empty list, and NaN is nothing.
fn of_cells<'c>(kind: Kind, cells: impl Iterator<Item = &'c Cell>) -> u32 {
    let mut hasher = Hasher::new();
    for cell in cells {
        match (kind, cell) {
            (Kind::Text, Cell::Text(text)) => put_text(&mut hasher, text),
            (Kind::Number, Cell::Number(value)) if !value.is_nan() => put_number(&mut hasher, *value),
            (Kind::Integer, Cell::Integer(value)) => hasher.update(&value.to_le_bytes()),
            (Kind::Truth, Cell::Truth(value)) => hasher.update(&[u8::from(*value)]),
            (Kind::Texts, Cell::Texts(list)) => {
                put_length(&mut hasher, list.len());
                for text in list {
                    put_text(&mut hasher, text);
                }
            }
            (Kind::Numbers, Cell::Numbers(list)) => {
                put_length(&mut hasher, list.len());
                for value in list {
                    put_number(&mut hasher, *value);
                }
            }
            (Kind::Integers, Cell::Integers(list)) => {
                put_length(&mut hasher, list.len());
                for value in list {
                    hasher.update(&value.to_le_bytes());
                }
            }
            (Kind::Texts | Kind::Numbers | Kind::Integers, _) => put_length(&mut hasher, 0),
            (Kind::Text | Kind::Number | Kind::Integer | Kind::Truth, _) => hasher.update(NOTHING),
        }
    }
    hasher.finalize()
}

/// What stands for no value.
const NOTHING: &[u8] = b"no value";

fn put_length(hasher: &mut Hasher, length: usize) {
    hasher.update(&(length as u64).to_le_bytes());
}

fn put_text(hasher: &mut Hasher, text: &str) {
    put_length(hasher, text.len());
    hasher.update(text.as_bytes());
}

fn put_number(hasher: &mut Hasher, value: f64) {
    let value = if value.is_nan() { f64::NAN } else { value };
    hasher.update(&value.to_bits().to_le_bytes());
}
