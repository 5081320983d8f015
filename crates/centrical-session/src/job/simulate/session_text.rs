//! The plan's text as the session's: every mounting names its files; all else stays as it was written.

use centrical_table::TableFormat;
use toml_edit::{Item, TableLike, Value, value};

use super::files::{pulses_path, record_path, telemetry_path};
use crate::error::{Error, Place};
use crate::experiment::{Session, SpeedSource};
use crate::settings::{editable, read_settings};

/// The text of the plan with `record` and `telemetry` of every mounting.
pub(crate) fn with_files(plan: &Session, format: TableFormat) -> Result<String, Error> {
    let file = &plan.file;
    if plan.plateaus.is_some() {
        let expected = "a schedule of plateaus in every [[mounting]]";
        return Err(Error::content(file, Place::Whole, "plateaus already averaged", expected));
    }
    let mut document = editable(file, &read_settings(file, "a plan")?)?;
    let has_pulses = counts_pulses(plan);
    match document.get_mut("mounting") {
        Some(Item::ArrayOfTables(tables)) => {
            (tables.iter_mut().enumerate()).for_each(|(m, t)| name(t, m, format, has_pulses));
        }
        Some(Item::Value(Value::Array(list))) => {
            let tables = list.iter_mut().filter_map(Value::as_inline_table_mut);
            tables.enumerate().for_each(|(m, table)| name(table, m, format, has_pulses));
        }
        _ => {}
    }
    if let Some(columns) = document.get_mut("columns").and_then(Item::as_table_like_mut) {
        // The files that are written begin with their header.
        for key in ["header_line", "first_row", "telemetry_header_line", "telemetry_first_row"] {
            columns.remove(key);
        }
    }
    Ok(document.to_string())
}

/// Whether the speeds are measured by a counter of pulses.
pub(crate) fn counts_pulses(plan: &Session) -> bool {
    plan.speeds.measured.is_some_and(|measured| measured.source == SpeedSource::Pulses)
}

fn name(table: &mut dyn TableLike, mounting: usize, format: TableFormat, has_pulses: bool) {
    table.insert("record", value(record_path(mounting, format)));
    table.insert("telemetry", value(telemetry_path(mounting, format)));
    if has_pulses {
        table.insert("pulses", value(pulses_path(mounting, format)));
    }
}
