//! Columns of the records and the telemetry, and their units.

use std::path::Path;

use centrical_table::{ColumnName, TableLines};

use super::form::{ColumnEntry, ColumnLabel, ColumnTable, ColumnsTable, UnitTable};
use super::toml_path::TomlPath;
use super::unit;
use crate::error::{Error, quoted};
use crate::quantity::Quantity;
use crate::record::{Column, Columns, Scale};
use crate::units::Dimension;

/// The columns, those not given at their usual names.
pub(crate) fn columns(file: &Path, table: &ColumnsTable, unit: &UnitTable) -> Result<Columns, Error> {
    let at = TomlPath::table(file, "columns");
    let record_lines = lines(&at, "header_line", table.header_line, "first_row", table.first_row)?;
    let (header, first_row) = (table.telemetry_header_line, table.telemetry_first_row);
    let telemetry_lines = lines(&at, "telemetry_header_line", header, "telemetry_first_row", first_row)?;
    let missing_readings = table.missing_readings;
    let mut columns = Columns { record_lines, telemetry_lines, missing_readings, ..Columns::default() };
    for (column, scale) in columns.f.iter_mut().zip(unit::output(file, unit)?) {
        column.scale = scale;
        column.unit.clone_from(&unit.output_unit);
    }
    if let Some(unit) = &table.speed_unit {
        set_unit(&at, "speed_unit", &mut columns.speed, unit, Dimension::Speed)?;
    }
    if let Some(ColumnEntry(entry)) = &table.time {
        set_time(&at, "time", &mut columns.time, entry)?;
    }
    columns.telemetry_time = telemetry_time(&at, &columns.time, table)?;
    columns.pulse.clone_from(&columns.telemetry_time);
    if let Some(ColumnEntry(entry)) = &table.pulse {
        columns.pulse = Columns::default().time;
        match dated(&at, "pulse", entry)? {
            Some(name) => columns.pulse.name = name,
            None => set(&at, "pulse", &mut columns.pulse, entry, Dimension::Time)?,
        }
    }
    if let Some(ColumnEntry(entry)) = &table.speed {
        if let (Some(_), Some(_)) = (&table.speed_unit, &entry.unit) {
            return Err(at.unexpected("speed_unit", "a unit in speed as well", "one of them"));
        }
        set(&at, "speed", &mut columns.speed, entry, Dimension::Speed)?;
    }
    if let Some(entries) = &table.f {
        for (column, ColumnEntry(entry)) in columns.f.iter_mut().zip(entries) {
            set(&at, "f", column, entry, Dimension::Acceleration)?;
        }
    }
    Ok(columns)
}

/// Where a table begins in its file.
fn lines(
    at: &TomlPath,
    header_key: &str,
    header: Option<u64>,
    row_key: &str,
    first_row: Option<u64>,
) -> Result<TableLines, Error> {
    for (key, line) in [(header_key, header), (row_key, first_row)] {
        if line == Some(0) {
            return Err(at.unexpected(key, "0", "a line of the file, counted from 1"));
        }
    }
    match (header, first_row) {
        (Some(header), Some(row)) if row <= header => {
            Err(at.unexpected(row_key, row.to_string(), format!("a line below {header_key} = {header}")))
        }
        _ => Ok(TableLines { header, first_row }),
    }
}

/// The time of the telemetry: as it is given; else that of the records, but for a sampling rate, which is the records' own.
fn telemetry_time(at: &TomlPath, of_records: &Column, table: &ColumnsTable) -> Result<Column, Error> {
    let usual = Columns::default().time;
    if let Some(ColumnEntry(entry)) = &table.telemetry_time {
        let mut column = usual;
        set_time(at, "telemetry_time", &mut column, entry)?;
        return Ok(column);
    }
    let has_rate = table.time.as_ref().is_some_and(|ColumnEntry(entry)| entry.rate.is_some());
    Ok(match (&of_records.name, has_rate) {
        (_, false) => of_records.clone(),
        (ColumnName::Row, true) => usual,
        (name, true) => Column { name: name.clone(), ..usual },
    })
}

/// A column of readings or speeds.
fn set(at: &TomlPath, key: &str, column: &mut Column, entry: &ColumnTable, dimension: Dimension) -> Result<(), Error> {
    if entry.rate.is_some() {
        return Err(at.unexpected(key, "a rate", "no rate (it belongs to a column of time that counts samples)"));
    }
    if entry.date.is_some() {
        return Err(at.unexpected(key, "a date", "no date (it belongs to a column of time)"));
    }
    let label = entry.column.as_ref();
    column.name =
        label.ok_or_else(|| at.unexpected(key, "no column", "column = its name, or number from 1"))?.0.clone();
    match &entry.unit {
        Some(unit) => set_unit(at, key, column, unit, dimension),
        None => Ok(()),
    }
}

/// The column of time: in a unit of time, times of the day beside dates, a count of samples at a rate, or no column at all but a rate.
fn set_time(at: &TomlPath, key: &str, column: &mut Column, entry: &ColumnTable) -> Result<(), Error> {
    if let Some(name) = dated(at, key, entry)? {
        column.name = name;
        return Ok(());
    }
    match (&entry.rate, &entry.unit) {
        (None, _) => return set(at, key, column, entry, Dimension::Time),
        (Some(_), Some(_)) => return Err(at.unexpected(key, "a rate and a unit", "one of them")),
        (Some(rate), None) => column.scale = Scale::factor(1.0 / sampling_rate(at, key, rate)?),
    }
    "samples".clone_into(&mut column.unit);
    column.name = entry.column.as_ref().map_or(ColumnName::Row, |label| label.0.clone());
    Ok(())
}

/// The columns of dates and of times of the day, if they are two.
fn dated(at: &TomlPath, key: &str, entry: &ColumnTable) -> Result<Option<ColumnName>, Error> {
    let Some(ColumnLabel(date)) = &entry.date else { return Ok(None) };
    if entry.rate.is_some() || entry.unit.is_some() {
        return Err(at.unexpected(key, "a date beside a rate or a unit", "one of them"));
    }
    let expected = "column = that of the times of the day";
    let ColumnLabel(time) = entry.column.as_ref().ok_or_else(|| at.unexpected(key, "a date alone", expected))?;
    Ok(Some(ColumnName::DateAndTime(Box::new([date.clone(), time.clone()]))))
}

/// Samples per second.
fn sampling_rate(at: &TomlPath, key: &str, rate: &Quantity) -> Result<f64, Error> {
    let meaning = "a sampling rate such as \"1 kHz\", from 1e-3 Hz to 1 GHz";
    at.bounded(key, rate, Dimension::Frequency, (1e-3, 1e9), meaning)
}

fn set_unit(at: &TomlPath, key: &str, column: &mut Column, unit: &str, dimension: Dimension) -> Result<(), Error> {
    let factor = dimension
        .factor(unit)
        .ok_or_else(|| at.unexpected(key, quoted(unit.as_bytes()), format!("one of {}", dimension.unit_list())))?;
    column.scale = Scale::factor(factor);
    unit.clone_into(&mut column.unit);
    Ok(())
}
