//! A session reduced to its plateau means: an experiment file that names a table of plateaus instead of records.

use std::path::{Path, PathBuf};

use centrical::OnProgress;
use centrical_table::{TableFormat, claim_folder, write_whole};
use toml_edit::{DocumentMut, InlineTable, Item, TableLike, value};

use super::calibrate::calibrate_reduced;
use crate::document::{CalibrationResult, Method, RecordFindings};
use crate::error::{Error, ErrorKind, Place};
use crate::experiment::{
    EXPERIMENT_FILE, PlateauRow, RestTable, Session, SpeedSource, refuse_another_session, refuse_other_inputs,
    write_attitudes, write_plateaus, write_plateaus_parquet,
};
use crate::reduced::Reduced;
use crate::settings::{editable, tables_of};

/// Keys of a mounting that say what the table of plateaus says now.
const REPLACED: [&str; 4] = ["record", "telemetry", "pulses", "plateaus"];

/// Names of the tables of rests in free attitudes and of their attitudes, of the first `[[tumble]]`.
const RESTS: [&str; 2] = ["rests.csv", "attitudes.csv"];

/// Writes the reduced session into `folder`: the table of plateaus first, and `experiment.toml`, which names it, last.
/// Calibrating it gives the numbers that calibrating the records gives. `result` is that of the exact method, where it is at hand: without it the
/// session is calibrated for what the records show beside their means, and `progress` is called with 0 after every step.
///
/// # Errors
/// [`Error::Stopped`]; [`Error`] if the folder is that of a session with records or of another unit, the session's own at that, or does not take the files.
pub fn write_reduced(
    session: &Session,
    reduced: &Reduced,
    result: Option<&CalibrationResult>,
    format: TableFormat,
    folder: &Path,
    progress: OnProgress,
) -> Result<(), Error> {
    let _claim = claim_folder(folder)?;
    let experiment_file = folder.join(EXPERIMENT_FILE);
    if is_same(&session.file, &experiment_file) {
        let expected = "another folder than the session's own";
        return Err(Error::content(&experiment_file, Place::Whole, "the session itself", expected));
    }
    refuse_another_session(folder, session)?;
    let (name, write): (_, fn(&Path, &[PlateauRow]) -> _) = match format {
        TableFormat::Csv => ("plateaus.csv", write_plateaus),
        TableFormat::Parquet => ("plateaus.parquet", write_plateaus_parquet),
    };
    let rests: Vec<[PathBuf; 2]> =
        (0..session.rest_tables.len()).map(|n| rest_files(n).map(|name| folder.join(name))).collect();
    let outputs: Vec<PathBuf> =
        rests.iter().flatten().cloned().chain([experiment_file.clone(), folder.join(name)]).collect();
    refuse_other_inputs(folder, &outputs, &session.files())?;
    let rows = reduced.table(session);
    // Speeds that single plateaus of the schedule state as measured: the table has a column for them.
    let of_plateaus = session.speeds.measured.is_none() && rows.iter().any(|row| row.speed_uncertainty.is_some());
    // Rests alone have tables of their own.
    let name = (!session.mountings.is_empty()).then_some(name);
    let mut document = editable(&session.file, &session.experiment_text()?)?;
    rewrite(&mut document, session, name, of_plateaus.then_some(session.speeds.set_uncertainty));
    if session.plateaus.is_none()
        && let Some(findings) = findings(session, reduced, result, progress)?
    {
        document.insert("record_findings", value(findings.to_json()?));
    }
    if let Some(noise) = reduced.reading_noise().filter(|_| session.type_b.resolution > 0.0)
        && let Some(uncertainty) = document.get_mut("uncertainty").and_then(Item::as_table_like_mut)
    {
        uncertainty.insert("reading_noise", value(noise));
    }
    if let Some(name) = name {
        write(&folder.join(name), &rows)?;
    }
    for (table, [means, attitudes]) in session.rest_tables.iter().zip(&rests) {
        write_plateaus(means, &table.means)?;
        if let Some(known) = &table.attitudes {
            write_attitudes(attitudes, &known.up_b)?;
        }
    }
    Ok(write_whole(&experiment_file, document.to_string().as_bytes())?)
}

/// What calibrating finds in the records beside the means: drifts over plateaus, and speeds that contradict the schedule. None of a session that
/// cannot be calibrated.
fn findings(
    session: &Session,
    reduced: &Reduced,
    result: Option<&CalibrationResult>,
    progress: OnProgress,
) -> Result<Option<RecordFindings>, Error> {
    if let Some(result) = result {
        return Ok(RecordFindings::of(result));
    }
    match calibrate_reduced(session, reduced, Method::Exact, progress) {
        Ok(result) => Ok(RecordFindings::of(&result)),
        Err(error) if error.kind() == ErrorKind::Input => Ok(None),
        Err(error) => Err(error),
    }
}

/// The experiment file with the table, if there is one, instead of records, and all else, comments too, as it was. With `uncertainty` it says
/// that plateaus state measured speeds, the others as uncertain as this.
fn rewrite(document: &mut DocumentMut, session: &Session, table: Option<&str>, uncertainty: Option<f64>) {
    for mounting in tables_of(document, "mounting") {
        for key in REPLACED {
            mounting.remove(key);
        }
    }
    if let (Some(uncertainty), Some(centrifuge)) = (uncertainty, document.get_mut("centrifuge"))
        && let Some(centrifuge) = centrifuge.as_table_like_mut()
    {
        let mut measured = InlineTable::new();
        measured.insert("from", SpeedSource::Plateaus.name().into());
        measured.insert("uncertainty", uncertainty.into());
        centrifuge.insert("measured", value(measured));
    }
    if let Some(measured) = document.get_mut("centrifuge").and_then(|table| table.get_mut("measured"))
        && let Some(measured) = measured.as_table_like_mut()
    {
        measured.insert("from", value(SpeedSource::Plateaus.name()));
    }
    if let Some(table) = table {
        document.insert("plateaus", value(table));
    }
    for (tumble, (n, rests)) in tables_of(document, "tumble").into_iter().zip(session.rest_tables.iter().enumerate()) {
        rename_rests(n, tumble, rests);
    }
}

/// Names of the tables of `[[tumble]]` number `n` from 0.
fn rest_files(n: usize) -> [String; 2] {
    RESTS.map(|name| if n == 0 { name.to_owned() } else { name.replace('.', &format!("-{}.", n + 1)) })
}

/// Names the tables of `[[tumble]]` number `n` from 0, and what was found with the rests.
fn rename_rests(n: usize, tumble: &mut dyn TableLike, table: &RestTable) {
    let [rests, attitudes] = rest_files(n);
    tumble.remove("record");
    tumble.remove("turning_radius");
    tumble.insert("rests", value(rests));
    if table.noise_at_most > 1.0 {
        tumble.insert("noise_at_most", value(table.noise_at_most));
    }
    if let Some(turning) = table.turning {
        tumble.insert("turning", value(turning.inline_table()));
    }
    if tumble.contains_key("attitudes") {
        tumble.insert("attitudes", value(attitudes));
    }
}

fn is_same(a: &Path, b: &Path) -> bool {
    a.canonicalize().ok().zip(b.canonicalize().ok()).is_some_and(|(a, b)| a == b)
}
