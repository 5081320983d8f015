//! Records as most programs write them: a time that never decreases, and three readings.

#![allow(dead_code, reason = "each kind of test uses some of it")]

use std::path::Path;

use centrical_table::{ColumnName, Error, Extent, Field, Rule, Source, TableLines, TableReader};

/// Time and readings, a column each.
pub type Record = [Vec<f64>; 4];

/// Columns `t`, `f1`, `f2`, `f3`.
pub fn named() -> [ColumnName; 4] {
    ["t", "f1", "f2", "f3"].map(|name| ColumnName::Name(name.to_owned()))
}

/// Columns 1 to 4.
pub fn numbered() -> [ColumnName; 4] {
    [1, 2, 3, 4].map(ColumnName::Number)
}

/// The record of a file.
pub fn read_record(file: &Path, columns: &[ColumnName; 4]) -> Result<Record, Error> {
    read(file, Extent::Whole, columns)
}

/// The rows of a record that somebody is writing.
pub fn read_growing_record(file: &Path) -> Result<Record, Error> {
    read(file, Extent::Growing, &named())
}

/// From the file; its bytes in memory have to give the same, or the same message.
fn read(file: &Path, extent: Extent, columns: &[ColumnName; 4]) -> Result<Record, Error> {
    let from_file = Source::open(file, "a record").and_then(|source| read_source(source, extent, columns));
    if let Ok(bytes) = std::fs::read(file) {
        let from_memory = read_source(Source::in_memory(file, bytes.into()), extent, columns);
        let outcome = |read: &Result<Record, Error>| match read {
            Ok(record) => Ok(record.each_ref().map(|column| column.iter().map(|v| v.to_bits()).collect::<Vec<_>>())),
            Err(error) => Err(error.to_string()),
        };
        assert_eq!(outcome(&from_memory), outcome(&from_file), "{}", file.display());
    }
    from_file
}

fn read_source(source: Source, extent: Extent, columns: &[ColumnName; 4]) -> Result<Record, Error> {
    let field = |(k, name): (usize, &ColumnName)| Field {
        name: name.clone(),
        expected: format!("a number in {}", if k == 0 { "s" } else { "m/s^2" }),
        rule: if k == 0 { Rule::Ascending { stamps: true } } else { Rule::Any },
    };
    let fields: Vec<Field> = columns.iter().enumerate().map(field).collect();
    let mut record = Record::default();
    let mut table = TableReader::new(source, extent, &fields, "a record", TableLines::default())?;
    while let Some(batch) = table.next_batch()? {
        for rows in batch {
            record.iter_mut().zip(rows).for_each(|(column, values)| column.extend_from_slice(values));
        }
    }
    Ok(record)
}
