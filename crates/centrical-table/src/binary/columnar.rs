//! Tables stored column by column: a block of every column at a time, side by side.

use std::path::Path;

use rayon::prelude::*;

use crate::column::{LARGEST, Rule};
use crate::error::{Error, Place};
use crate::rows::{ASCENDING, Rows, runs_backwards};

/// Appends the next values of a column, [`crate::rows::BLOCK`] at most, and none at its end.
pub(super) type Column<'a> = Box<dyn FnMut(&mut Vec<f64>) -> Result<(), Error> + Send + 'a>;

/// What stands for a missing value while a block is read: a NaN unlike the usual one, for the message alone.
pub(super) const MISSING: f64 = f64::from_bits(0x7ff8_0000_0000_0eaf);

/// Reads columns, in the order of the fields, to their common end; `first_row` counts the rows.
pub(super) fn read(file: &Path, columns: &mut [Column], first_row: &mut u64, rows: &mut Rows) -> Result<(), Error> {
    while !rows.is_too_long() {
        let read = columns.par_iter_mut().zip(&mut rows.block).map(|(column, values)| column(values));
        // Gathered before the first error is taken: which one it is does not depend on the threads.
        read.collect::<Vec<_>>().into_iter().collect::<Result<(), Error>>()?;
        let length = rows.block[0].len();
        if let Some(k) = rows.block.iter().position(|values| values.len() != length) {
            let found = format!("{} rows where {} has {length}", rows.block[k].len(), rows.fields[0].name);
            let place = Place::Column(rows.fields[k].name.to_string());
            return Err(Error::content(file, place, found, "columns of equal length"));
        }
        if length == 0 {
            break;
        }
        check(file, *first_row, rows)?;
        *first_row += length as u64;
        rows.flush();
    }
    Ok(())
}

/// The values of a block are numbers, and time does not run backwards.
fn check(file: &Path, first_row: u64, rows: &mut Rows) -> Result<(), Error> {
    for (k, field) in rows.fields.iter().enumerate() {
        let wrong = |i: usize, found: String, expected: &str| {
            let place = Place::Row { row: first_row + i as u64 + 1, column: field.name.to_string() };
            Err(Error::content(file, place, found, expected))
        };
        if is_plain(&rows.block[k], rows.last[k], field.rule) {
            rows.last[k] = rows.block[k].last().copied().unwrap_or(rows.last[k]);
            continue;
        }
        let missing_is_fine = field.rule == Rule::OrMissing;
        for (i, value) in rows.block[k].iter().enumerate() {
            if value.is_nan() && !missing_is_fine || value.abs() > LARGEST {
                let missing = value.to_bits() == MISSING.to_bits();
                return wrong(i, if missing { "no value".to_owned() } else { value.to_string() }, &field.expected);
            }
            let last = &mut rows.last[k];
            if value < last && field.rule.ascends() {
                return wrong(i, format!("{value} after {last}"), ASCENDING);
            }
            *last = *value;
        }
    }
    Ok(())
}

/// Whether there is nothing to say of any of the values, the last one before them being that.
fn is_plain(values: &[f64], last: f64, rule: Rule) -> bool {
    let wrong = values.iter().map(|value| usize::from(value.is_nan() || value.abs() > LARGEST)).sum::<usize>();
    let ascends = || values.first().is_none_or(|first| *first >= last) && !runs_backwards(values);
    wrong == 0 && (!rule.ascends() || ascends())
}
