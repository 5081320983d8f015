//! The first sheet of a workbook (.xlsx), as the text that its cells make: what people type is read as what they save as text.
//!
//! A line is a row of the sheet. A formula counts as the value that was saved with it; a merged cell has its value in its first cell. A
//! date is a stamp.

use std::io::{self, Read};

use calamine::{DataRef, Reader, Xlsx};

use crate::source::Source;
use crate::unpacking::Unpacked;

/// What a workbook that people type may hold: cells, columns, and bytes of its text and of what is packed in it.
const MOST_CELLS: usize = 1_000_000;
const MOST_COLUMNS: u32 = 1000;
const MOST_BYTES: usize = 32 << 20;

/// A cell: row and column, from 0, and its text.
type Cell = (u32, u32, String);

/// The text of the first sheet.
pub(crate) fn text(source: &Source) -> io::Result<Vec<u8>> {
    check_size(source)?;
    let mut workbook = Xlsx::new(io::BufReader::new(source.reader_at(0))).map_err(|e| wrong(&e))?;
    let name = workbook.sheet_names().first().cloned().ok_or_else(|| wrong(&"no sheet"))?;
    let mut reader = workbook.worksheet_cells_reader(&name).map_err(|e| wrong(&e))?;
    let (mut cells, mut bytes): (Vec<Cell>, usize) = (Vec::new(), 0);
    while let Some(cell) = reader.next_cell().map_err(|e| wrong(&e))? {
        let (row, column) = cell.get_position();
        let text = cell_text(cell.get_value());
        if text.is_empty() {
            continue;
        }
        bytes += text.len();
        if cells.len() == MOST_CELLS || column >= MOST_COLUMNS || bytes > MOST_BYTES {
            return Err(wrong(&format!("more than {MOST_CELLS} cells, {MOST_COLUMNS} columns or {MOST_BYTES} bytes")));
        }
        cells.push((row, column, text));
    }
    cells.sort_by_key(|(row, column, _)| (*row, *column));
    lines(&cells)
}

/// Refuses archives that unpack to more than a workbook that people type.
fn check_size(source: &Source) -> io::Result<()> {
    let mut archive = zip::ZipArchive::new(source.reader_at(0)).map_err(|e| wrong(&e))?;
    let mut left = MOST_BYTES as u64;
    for member in 0..archive.len() {
        let member = archive.by_index(member).map_err(|e| wrong(&e))?;
        let packed = member.compressed_size();
        let mut unpacked = Unpacked::new(member, packed, None).take(left + 1);
        let unpacked = io::copy(&mut unpacked, &mut io::sink())?;
        left =
            left.checked_sub(unpacked).ok_or_else(|| wrong(&format!("it unpacks to more than {MOST_BYTES} bytes")))?;
    }
    Ok(())
}

/// Lines of equally many fields; rows without cells are blank lines.
fn lines(cells: &[Cell]) -> io::Result<Vec<u8>> {
    let columns = cells.iter().map(|(_, column, _)| column + 1).max().unwrap_or(0);
    let (mut text, mut next_row) = (Vec::new(), 0);
    for row in cells.chunk_by(|one, other| one.0 == other.0) {
        text.resize(text.len() + (row[0].0 - next_row) as usize, b'\n');
        let mut at = 0;
        for (_, column, cell) in row {
            text.resize(text.len() + (column.saturating_sub(at)) as usize, b';');
            text.extend_from_slice(cell.as_bytes());
            at = *column;
        }
        text.resize(text.len() + (columns - 1 - at) as usize, b';');
        text.push(b'\n');
        next_row = row[0].0 + 1;
        if text.len() > MOST_BYTES {
            return Err(wrong(&format!("more than {MOST_BYTES} bytes of text")));
        }
    }
    Ok(text)
}

/// The text of a cell.
fn cell_text(value: &DataRef) -> String {
    match value {
        DataRef::Empty => String::new(),
        DataRef::Int(number) => number.to_string(),
        DataRef::Float(number) => number_text(*number),
        DataRef::Bool(truth) => truth.to_string(),
        DataRef::Error(error) => error.to_string(),
        DataRef::String(text) | DataRef::DateTimeIso(text) | DataRef::DurationIso(text) => field(text),
        DataRef::SharedString(text) => field(text),
        DataRef::DateTime(time) if time.is_duration() => number_text(86400.0 * time.as_f64()),
        DataRef::DateTime(time) => {
            let (year, month, day, hour, minute, second, milli) = time.to_ymd_hms_milli();
            let clock = format!("{hour:02}:{minute:02}:{second:02}.{milli:03}");
            // Below one day there is no date.
            if time.as_f64() < 1.0 { clock } else { format!("{year:04}-{month:02}-{day:02}T{clock}") }
        }
    }
}

fn number_text(number: f64) -> String {
    if number.is_finite() { zmij::Buffer::new().format(number).to_owned() } else { number.to_string() }
}

/// A text as a field, on one line.
fn field(text: &str) -> String {
    let text = text.replace(['\n', '\r', '\t'], " ");
    if text.contains([';', ',', '"']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text }
}

fn wrong(error: &impl ToString) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, error.to_string())
}
