//! The plan's text as the session's: every mounting names its files; all else stays as it was written.

use centrical_table::TableFormat;
use toml_edit::{InlineTable, Item, Table, Value, value};

use super::files::{record_path, telemetry_path};
use crate::error::{Error, Place};
use crate::experiment::Session;
use crate::settings::{editable, read_settings};

/// The text of the plan with `record` and `telemetry` of every mounting.
pub(crate) fn with_files(plan: &Session, format: TableFormat) -> Result<String, Error> {
    let file = &plan.file;
    if plan.plateaus.is_some() {
        let expected = "a schedule of plateaus in every [[mounting]]";
        return Err(Error::content(file, Place::Whole, "plateaus already averaged", expected));
    }
    let mut document = editable(file, &read_settings(file, "a plan")?)?;
    match document.get_mut("mounting") {
        Some(Item::ArrayOfTables(tables)) => (tables.iter_mut().enumerate()).for_each(|(m, t)| name(t, m, format)),
        Some(Item::Value(Value::Array(list))) => {
            let tables = list.iter_mut().filter_map(Value::as_inline_table_mut);
            tables.enumerate().for_each(|(m, table)| name_inline(table, m, format));
        }
        _ => {}
    }
    Ok(document.to_string())
}

fn name(table: &mut Table, mounting: usize, format: TableFormat) {
    table["record"] = value(record_path(mounting, format));
    table["telemetry"] = value(telemetry_path(mounting, format));
}

fn name_inline(table: &mut InlineTable, mounting: usize, format: TableFormat) {
    table.insert("record", record_path(mounting, format).into());
    table.insert("telemetry", telemetry_path(mounting, format).into());
}
