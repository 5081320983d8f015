//! Readings of two mountings at once: of a record that was copied or named twice the noise would count for half.

use std::collections::HashMap;
use std::path::Path;

use crate::error::{Error, Place};
use crate::experiment::Session;
use crate::reduced::Reduced;

/// The readings from which a mean was taken.
struct Readings<'a> {
    /// Hash of the bytes of the file.
    sha256: &'a str,
    file: &'a Path,
    /// From, to [s], the record's clock; without bounds of a table of rests.
    window: [f64; 2],
    /// Which mounting, or which `[[tumble]]` behind them, from 0.
    owner: usize,
}

/// Refuses readings that two mountings, or two `[[tumble]]`, have in common.
pub(super) fn refuse_shared_readings(session: &Session, reduced: &Reduced) -> Result<(), Error> {
    let mut all = readings(session, reduced);
    all.sort_by(|a, b| a.sha256.cmp(b.sha256).then(a.window[0].total_cmp(&b.window[0])));
    for pair in all.windows(2) {
        let (one, other) = (&pair[0], &pair[1]);
        if one.sha256 == other.sha256 && one.owner != other.owner && other.window[0] < one.window[1] {
            let (first, second) = if one.owner < other.owner { (one, other) } else { (other, one) };
            let found = format!("the readings of {}, {}", named(session, first), first.file.display());
            let expected = format!("readings of its own for {}", named(session, second));
            return Err(Error::content(second.file, Place::Whole, found, expected));
        }
    }
    Ok(())
}

fn readings<'a>(session: &'a Session, reduced: &'a Reduced) -> Vec<Readings<'a>> {
    let hashes: HashMap<&Path, &str> =
        session.files().into_iter().zip(&reduced.inputs).map(|(file, input)| (file, input.sha256.as_str())).collect();
    let arm = session.mountings.len();
    let of_rests = session
        .rest_tables
        .iter()
        .enumerate()
        .flat_map(|(n, table)| vec![(arm + n, table.files().next()); table.count()]);
    let of_mountings = session.mountings.iter().enumerate().map(|(n, files)| (n, files.record.as_ref()));
    let owners: Vec<_> = of_mountings.chain(of_rests).collect();
    let set_points = session.experiment.set_points.iter().zip(&reduced.plateaus);
    let of_mean = set_points.filter_map(|(set_point, plateau)| {
        let (owner, file) = owners[set_point.mounting];
        let window = plateau.window.or_else(|| (owner >= arm).then_some([f64::NEG_INFINITY, f64::INFINITY]))?;
        let file = file?.as_path();
        Some(Readings { sha256: hashes.get(file)?, file, window, owner })
    });
    of_mean.collect()
}

fn named(session: &Session, readings: &Readings) -> String {
    match (readings.owner + 1).checked_sub(session.mountings.len()).filter(|number| *number > 0) {
        Some(number) => format!("[[tumble]] {number}"),
        None => format!("mounting {}", readings.owner + 1),
    }
}
