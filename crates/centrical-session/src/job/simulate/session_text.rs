//! Where the tables of a session are, and the plan's text as the session's: every mounting and every tumble names its files; all else stays as
//! it was written.

use centrical_table::TableFormat;
use toml_edit::{Item, TableLike, value};

use crate::error::{Error, Place};
use crate::experiment::{RestTable, Session};
use crate::settings::{editable, read_settings, tables_of};

/// The text of the plan with `record` and `telemetry` of every mounting, and `record` of every tumble.
pub(crate) fn with_files(plan: &Session, format: TableFormat) -> Result<String, Error> {
    let file = &plan.file;
    if plan.plateaus.is_some() {
        let expected = "a schedule of plateaus in every [[mounting]]";
        return Err(Error::content(file, Place::Whole, "plateaus already averaged", expected));
    }
    let mut document = editable(file, &read_settings(file, "a plan")?)?;
    let has_pulses = plan.speeds.counts_pulses();
    for (m, table) in tables_of(&mut document, "mounting").into_iter().enumerate() {
        name(table, m, format, has_pulses);
    }
    for (n, (table, rests)) in tables_of(&mut document, "tumble").into_iter().zip(&plan.rest_tables).enumerate() {
        name_tumble(table, n, format, rests);
    }
    if let Some(columns) = document.get_mut("columns").and_then(Item::as_table_like_mut) {
        // The files that are written begin with their header.
        for key in ["header_line", "first_row", "telemetry_header_line", "telemetry_first_row"] {
            columns.remove(key);
        }
    }
    Ok(document.to_string())
}

fn name(table: &mut dyn TableLike, mounting: usize, format: TableFormat, has_pulses: bool) {
    table.insert("record", value(record_path(mounting, format)));
    table.insert("telemetry", value(telemetry_path(mounting, format)));
    if has_pulses {
        table.insert("pulses", value(pulses_path(mounting, format)));
    }
}

/// The rests that were planned are now in a record, in the attitudes that are known of them.
fn name_tumble(table: &mut dyn TableLike, tumble: usize, format: TableFormat, rests: &RestTable) {
    for key in ["rests", "duration", "durations"] {
        table.remove(key);
    }
    table.insert("record", value(tumble_path(tumble, format)));
    match &rests.attitudes {
        None => drop(table.remove("attitudes")),
        Some(known) if known.file.is_some() => drop(table.insert("attitudes", value(attitudes_path(tumble)))),
        Some(_) => {}
    }
}

/// Path of the record of a mounting within the session's folder.
pub(crate) fn record_path(mounting: usize, format: TableFormat) -> String {
    format!("records/m{:02}.{}", mounting + 1, format.extension())
}

/// Path of the pulses of a mounting within the session's folder.
pub(crate) fn pulses_path(mounting: usize, format: TableFormat) -> String {
    format!("pulses/m{:02}.{}", mounting + 1, format.extension())
}

/// Path of the telemetry of a mounting within the session's folder.
pub(crate) fn telemetry_path(mounting: usize, format: TableFormat) -> String {
    format!("telemetry/m{:02}.{}", mounting + 1, format.extension())
}

/// Path of the record of the rests of `[[tumble]]` number `tumble`, from 0, within the session's folder.
pub(crate) fn tumble_path(tumble: usize, format: TableFormat) -> String {
    format!("records/tumble-{}.{}", tumble + 1, format.extension())
}

/// Name of the table of their attitudes.
pub(crate) fn attitudes_path(tumble: usize) -> String {
    format!("attitudes-{}.csv", tumble + 1)
}
