//! The table of a series: a row for each session, in the order of their paths, whatever the order in which they were done.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::Path;

use centrical::unwatched;
use centrical_table::{csv_field, harmless, write_whole};

use super::ledger::Ledger;
use super::one::SeriesRequest;
use crate::document::{FailedSession, SeriesSummary};
use crate::error::Error;
use crate::store::{Depth, Row, RowTable, Selection, Status, Store};

/// Sessions whose rows are held at a time.
const CHUNK: usize = 4096;

/// Writes `series.parquet` and `series.csv`, and counts.
pub(super) fn write_tables(
    request: &SeriesRequest,
    store: &Store,
    ledger: &Ledger,
    sessions: &BTreeSet<&Path>,
) -> Result<SeriesSummary, Error> {
    let keyed: Vec<(String, &str)> =
        sessions.iter().filter_map(|s| Some((s.display().to_string(), ledger.key(s)?))).collect();
    let mut summary = SeriesSummary::of(keyed.len());
    let mut text = HEADER.to_owned();
    let mut table = RowTable::create(&request.table())?;
    for chunk in keyed.chunks(CHUNK) {
        let keys = Some(chunk.iter().map(|(_, key)| (*key).to_owned()).collect());
        let selection = Selection { depth: Depth::Values, keys, ..Selection::default() };
        let rows = store.rows(selection, &unwatched)?.map(|row| row.map(|row| (row.key.clone(), row)));
        let rows = rows.collect::<Result<BTreeMap<String, Row>, Error>>()?;
        let ordered: Vec<(&str, &Row)> =
            chunk.iter().filter_map(|(session, key)| Some((session.as_str(), rows.get(*key)?))).collect();
        for (session, row) in &ordered {
            count(&mut summary, session, row);
            line(&mut text, session, row);
        }
        table.add(&ordered)?;
    }
    table.finish()?;
    write_whole(&request.text(), text.as_bytes())?;
    Ok(summary)
}

/// Failures that the summary names.
const MOST_NAMED: usize = 100;

fn count(summary: &mut SeriesSummary, session: &str, row: &Row) {
    match (row.status, row.acceptable) {
        (Status::Failed, _) => {
            summary.failed += 1;
            if summary.failures.len() < MOST_NAMED {
                let message = row.failure.message.clone();
                summary.failures.push(FailedSession { session: session.to_owned(), message });
            }
        }
        (Status::Done, true) => summary.acceptable += 1,
        (Status::Done, false) => summary.not_acceptable += 1,
    }
}

const HEADER: &str = "session,status,date,unit_model,unit_serial,station,acceptable,objections,chi_squared,degrees_of_freedom,key,message\n";

fn line(text: &mut String, session: &str, row: &Row) {
    let is_done = row.status == Status::Done;
    let chi_squared = if is_done { format!("{:?}", row.chi_squared) } else { String::new() };
    let fields = [session, row.status.word(), &row.date, &row.unit_model, &row.unit_serial, &row.station].map(shown);
    let acceptable = if is_done { row.acceptable.to_string() } else { String::new() };
    let freedom = if is_done { row.degrees_of_freedom.to_string() } else { String::new() };
    let objections = shown(&row.objections.join(" "));
    let message = shown(&row.failure.message);
    let _ =
        writeln!(text, "{},{acceptable},{objections},{chi_squared},{freedom},{},{message}", fields.join(","), row.key);
}

/// A field without characters that are not shown.
fn shown(text: &str) -> String {
    csv_field(&harmless(text))
}
