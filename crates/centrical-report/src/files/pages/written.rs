//! Pages as files.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use centrical_session::{Calibrated, Error, OnProgress, advance, by_unit, write_stream};
use rayon::prelude::*;

use super::unit::{DOCTYPE, UnitPages};
use crate::render::PageKind;

/// Calibrations that are read together with their covariances, 10 kB each; twice as many are held.
const MOST_WHOLE: usize = 8192;

/// Writes a page. It can be made anew: nobody waits for the disk.
///
/// # Errors
/// [`Error`] if the folder does not take it.
pub fn write_page(file: &Path, page: &str) -> Result<(), Error> {
    Ok(write_stream(file, |output| output.write_all(page.as_bytes()))?)
}

/// Writes the pages of units into `out`, but for those that are there and of the same origin.
///
/// # Errors
/// [`Error`] when the store cannot be read or `out` does not take a page.
pub fn write_units(units: &UnitPages, out: &Path, progress: OnProgress) -> Result<(), Error> {
    let all: Vec<(&str, &BTreeSet<String>)> = units.units().collect();
    let is_due = |(file, keys): &(&str, &BTreeSet<String>)| !begins_with(&out.join(file), &opening(units, keys));
    let due: Vec<_> = all.into_par_iter().filter(is_due).collect();
    let mut batches = batches(&due).into_iter();
    let mut next = batches.next().map(|keys| units.read(keys, progress));
    while let Some(read) = next {
        let unit_by_unit = by_unit(read?);
        // The next ones are read meanwhile.
        let (written, ahead) = rayon::join(
            || {
                unit_by_unit.par_iter().try_for_each(|unit| {
                    advance(progress, 0)?;
                    write_unit(units, unit, out)
                })
            },
            || batches.next().map(|keys| units.read(keys, progress)),
        );
        written?;
        next = ahead;
    }
    Ok(())
}

/// The keys of whole units that are read together.
fn batches(due: &[(&str, &BTreeSet<String>)]) -> Vec<BTreeSet<String>> {
    let mut batches: Vec<BTreeSet<String>> = Vec::new();
    for (_, keys) in due {
        match batches.last_mut() {
            Some(batch) if batch.len() + keys.len() <= MOST_WHOLE => batch.extend(keys.iter().cloned()),
            _ => batches.push((*keys).clone()),
        }
    }
    batches
}

fn write_unit(units: &UnitPages, unit: &[Calibrated], out: &Path) -> Result<(), Error> {
    let keys: BTreeSet<String> = unit.iter().map(|calibrated| calibrated.source.clone()).collect();
    let page = units.made(unit).replacen(DOCTYPE, &opening(units, &keys), 1);
    write_page(&out.join(PageKind::Unit.file(&[&unit[0].unit_model, &unit[0].unit_serial])), &page)
}

/// How a page begins: its origin stands in a comment.
fn opening(units: &UnitPages, keys: &BTreeSet<String>) -> String {
    format!("{DOCTYPE}<!-- {} -->\n", units.origin(keys))
}

fn begins_with(file: &Path, opening: &str) -> bool {
    let mut begin = vec![0; opening.len()];
    let read = File::open(file).and_then(|mut file| file.read_exact(&mut begin));
    read.is_ok() && begin == opening.as_bytes()
}

/// The first kilobyte of a page, where its comments stand.
pub fn beginning(file: &Path) -> Option<String> {
    let mut begin = Vec::new();
    File::open(file).ok()?.take(1024).read_to_end(&mut begin).ok()?;
    Some(String::from_utf8_lossy(&begin).into_owned())
}
