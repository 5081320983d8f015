//! Rests in attitudes of their own: those of tables as they are, those of records found and averaged.

use std::borrow::Cow;
use std::path::Path;

use centrical::OnProgress;
use centrical::reduction::{Record, RecordSlice, ReductionError, Rests};
use centrical_table::Extent;
use nalgebra::Vector3;

use crate::error::{Error, Place};
use crate::experiment::{KnownAttitudes, LARGEST_SCALE_ERROR, RecordedRests, RestTable, Session};
use crate::record::read_records;
use crate::reduced::{ReducedPlateau, rest_rows};

/// The rests of all records, each with its turning radius: one search for a tumble and for a session. The colour of the noise is pooled over
/// all of them. Messages name `file`.
///
/// # Errors
/// If a record is invalid, or there are fewer than two rests: a single one shows nothing. [`Error::Stopped`].
pub(crate) fn find_rests(
    records: &[(RecordSlice, Option<f64>)],
    file: &Path,
    progress: OnProgress,
) -> Result<Rests, Error> {
    let refused = |source| match source {
        ReductionError::Stopped(stopped) => stopped.into(),
        source => Error::reduction(file, 0, source),
    };
    let rests = Rests::of(records, &|()| progress(0)).map_err(refused)?;
    let count: usize = rests.means.iter().map(Vec::len).sum();
    if count < 2 {
        let stretches = if count == 1 { "stretch" } else { "stretches" };
        if let Some(still) = without_noise(records) {
            let found = format!("the same three readings in {still} of 100 neighbouring samples");
            let expected = "readings with their noise: not stuck, and not simulated without noise";
            return Err(Error::content(file, Place::Whole, found, expected));
        }
        let found = format!("{count} {stretches} in which the unit rests");
        let expected = if records.iter().any(|(_, turning_radius)| turning_radius.is_some()) {
            "a unit that is turned, left alone for a second or more, and turned again; or slow rotation through attitudes that show all coefficients"
        } else {
            "a unit that is turned, left alone for a second or more, and turned again; slow rotation counts with --turning-radius, or turning_radius in [[tumble]]"
        };
        return Err(Error::content(file, Place::Whole, found, expected));
    }
    Ok(rests)
}

/// Hundredths of the samples that repeat all three readings of the one before, if these are more than half: it is noise that
/// shows where a rest ends.
fn without_noise(records: &[(RecordSlice, Option<f64>)]) -> Option<usize> {
    let (mut repeated, mut all) = (0, 0);
    for [x, y, z] in records.iter().map(|(samples, _)| samples.f_z) {
        let is_same = |k: &usize| x[*k] == x[k - 1] && y[*k] == y[k - 1] && z[*k] == z[k - 1];
        repeated += (1..x.len()).filter(is_same).count();
        all += x.len().saturating_sub(1);
    }
    (2 * repeated > all).then(|| 100 * repeated / all)
}

/// Root mean square of the sizes of rests [m/s^2].
pub(crate) fn mean_size(means: &[Vector3<f64>]) -> f64 {
    (means.iter().map(Vector3::norm_squared).sum::<f64>() / means.len() as f64).sqrt()
}

/// Whether rests of this size [m/s^2] are of gravity, or readings in another unit: no scale factor is as far off its unit.
pub(crate) fn is_of_gravity(size: f64, gravity: f64) -> bool {
    let most = 1.0 + LARGEST_SCALE_ERROR;
    (gravity / most..gravity * most).contains(&size)
}

/// The session with all its rests, and these averaged: those that are to be found in records are found. `progress` is called
/// with the number of bytes read.
///
/// # Errors
/// [`Error`] naming the record, what was found and what was expected.
pub(crate) fn with_all_rests<'s>(
    session: &'s Session,
    progress: OnProgress,
) -> Result<(Cow<'s, Session>, Vec<ReducedPlateau>), Error> {
    let mut read = Vec::new();
    for (_, recorded) in session.rest_records() {
        read.push((record(session, recorded, progress)?, recorded.turning_radius));
    }
    let Some(file) = session.rest_records().find_map(|(_, recorded)| recorded.files.first()) else {
        let averaged = session.rests().map(ReducedPlateau::from).collect();
        return Ok((Cow::Borrowed(session), averaged));
    };
    let records: Vec<_> = read.iter().map(|(record, radius)| (record.as_slice(), *radius)).collect();
    let Rests { means, noise_at_most } = find_rests(&records, file, progress)?;
    let mut found = means.into_iter();
    let mut rests = Vec::new();
    let mut tables = session.rest_tables.clone();
    for table in &mut tables {
        let of_table: Vec<ReducedPlateau> = match table.record() {
            Some(_) => {
                table.noise_at_most = noise_at_most;
                let means = found.next().unwrap_or_default();
                table.turned(&means);
                means.into_iter().map(ReducedPlateau::from).collect()
            }
            None => table.means.iter().map(ReducedPlateau::from).collect(),
        };
        fill(table, &of_table, session.experiment.site.gravity)?;
        rests.extend(of_table);
    }
    Ok((Cow::Owned(session.clone().with_rest_tables(tables)), rests))
}

/// A record with its unit turned and left alone, in SI.
fn record(session: &Session, recorded: &RecordedRests, progress: OnProgress) -> Result<Record, Error> {
    let sources = session.folder.open_record(&recorded.files)?;
    read_records(sources, &session.columns, Extent::Whole, progress)
}

/// Fills a table with the rests that were found in its record, each in the nearest of the attitudes that are stated.
fn fill(table: &mut RestTable, rests: &[ReducedPlateau], gravity: f64) -> Result<(), Error> {
    let Some(recorded) = table.record() else { return Ok(()) };
    let means: Vec<Vector3<f64>> = rests.iter().map(|rest| rest.mean).collect();
    let file = recorded.files.first().map_or(Path::new(""), AsRef::as_ref);
    let size = mean_size(&means);
    if !means.is_empty() && !is_of_gravity(size, gravity) {
        let found = format!("rests of {size:.4} m/s^2 on average");
        let expected = format!("rests of gravity, {gravity:.5} m/s^2, by the output_unit or the scale in [unit]");
        return Err(Error::content(file, Place::Whole, found, expected));
    }
    let known = recorded.attitudes.as_ref().map(|stated| {
        let up_b = stated.of_rests(&means, file)?;
        Ok::<_, Error>(KnownAttitudes { file: stated.file.clone(), uncertainty: stated.uncertainty, up_b })
    });
    table.attitudes = known.transpose()?;
    table.means = rest_rows(rests);
    Ok(())
}
