//! Which batch a unit is of.

use std::collections::BTreeMap;
use std::path::Path;

use crate::error::{Error, Place, quoted};
use crate::settings::read_settings;

/// Batches by serial number: a text with a serial number and a batch in each line, divided by a comma, a semicolon or a tab; a first line
/// "serial,batch", blank lines and lines that begin with "#" do not count.
///
/// # Errors
/// [`Error`] for a line of other than two words, and a unit in two batches.
pub fn read_batches(file: &Path) -> Result<BTreeMap<String, String>, Error> {
    let text = read_settings(file, "a table of serial numbers and batches")?;
    let mut batches = BTreeMap::new();
    // Spreadsheets write a byte order mark.
    for (n, line) in text
        .trim_start_matches('\u{feff}')
        .lines()
        .enumerate()
        .filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'))
    {
        let words: Vec<&str> = line.split([',', ';', '\t']).map(str::trim).collect();
        let refuse = |expected: &str| {
            let place = Place::Line { line: n as u64 + 1, column: None };
            Err(Error::content(file, place, quoted(line.as_bytes()), expected))
        };
        match words.as_slice() {
            ["serial", "batch"] if batches.is_empty() => {}
            [serial, batch] if !serial.is_empty() && !batch.is_empty() => {
                let before = batches.insert((*serial).to_owned(), (*batch).to_owned());
                if before.is_some_and(|before| before != *batch) {
                    return refuse("each unit in one batch");
                }
            }
            _ => return refuse("a serial number and a batch, divided by a comma"),
        }
    }
    Ok(batches)
}
