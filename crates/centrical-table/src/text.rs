//! Tables as text: CSV and its kin.
//!
//! The first line shows the delimiter (`;`, tab, `,` or blanks); any order of columns, more columns than
//! asked for, quoted fields, CRLF, lines starting with `#` and blank lines are welcome. Where the comma does not
//! divide the fields it is the decimal comma.
//!
//! A text is read in pieces of whole lines, several at a time on all threads.

mod encoding;
mod fields;
mod form;
mod layout;
mod lines;
mod number;
mod piece;
mod prologue;
mod separators;
mod shape;
mod unit_words;

use std::path::{Path, PathBuf};

use memchr::memchr_iter;
use rayon::prelude::*;

pub use self::encoding::TextEncoding;
pub(crate) use self::encoding::{SIGHT, in_utf_8};
use self::fields::Fault;
pub use self::form::{DecimalSign, StampColumn, TextForm};
use self::layout::Layout;
pub(crate) use self::lines::{Lines, Packed, Plain, complete_lines};
use self::piece::Piece;
use self::prologue::{Prologue, Start};
pub use self::unit_words::{unit_beside_name, unit_of_word};
use crate::column::{Before, Field, RowNumber, Rows, TableLines, UnitsFound};
use crate::error::{Error, Place};
use crate::stamp::Stamps;

/// Pieces read at a time.
const PIECES: usize = 8;

/// A text on its way to rows.
pub(crate) struct TextReader {
    file: PathBuf,
    fields: Vec<Field>,
    lines: Lines,
    prologue: Prologue,
    /// What the first lines show, and the pieces read so far.
    table: Option<(Layout, Vec<IndexedPiece>)>,
    /// Lines before the first row.
    skipped: Skipped,
    units: Option<UnitsFound>,
    workplace: Workplace,
    /// Number of the next piece, and of its first line.
    number: u64,
    line: u64,
    before: Before,
}

impl TextReader {
    /// The table of `file` with these lines.
    pub fn new(file: &Path, lines: Lines, fields: Vec<Field>, said: TableLines) -> Self {
        Self {
            file: file.to_owned(),
            lines,
            prologue: Prologue::at(said),
            table: None,
            skipped: Skipped::default(),
            units: None,
            workplace: Workplace::new(fields.len()),
            number: 0,
            line: 1,
            before: Before::new(fields.len()),
            fields,
        }
    }

    /// Reads the next rows: how many sets of them, and the bytes of the file they were in, 0 if it is packed; none at the
    /// end.
    pub fn read(&mut self) -> Result<Option<(usize, u64)>, Error> {
        let Self { file, fields, lines, prologue, table, workplace, number, line, before, .. } = self;
        let Workplace { pieces, rows } = workplace;
        loop {
            // The first piece alone: its first line shows how the others are to be read.
            let is_first = table.is_none();
            let most = if is_first { 1 } else { PIECES };
            let count = match lines {
                Lines::Plain(lines) => lines.pieces_from(*number, most),
                Lines::Packed(lines) => fill(lines, *number == 0, &mut pieces[..most])?,
            };
            if count == 0 {
                return Ok(None);
            }
            let (pieces, rows) = (&mut pieces[..count], &mut rows[..count]);
            // A piece of an ordinary file is read where it is worked on.
            let plain = if let Lines::Plain(lines) = lines { Some(&*lines) } else { None };
            let read = |k: usize, piece: &mut Piece| {
                plain.map_or(Ok(()), |lines| lines.read(*number + k as u64, &mut piece.text))
            };
            let mut skip = 0;
            if is_first {
                read(0, &mut pieces[0])?;
                let start = start(prologue, &pieces[0].text, *line - 1, fields);
                if let Some(start) = start.map_err(|(at, fault)| located(file, *line + at, fault))? {
                    *table = Some((start.layout, Vec::new()));
                    skip = start.skipped;
                    (self.skipped, self.units) = (Skipped { piece: *number, lines: skip }, start.units);
                }
            }
            let Some((layout, index)) = table else {
                // Nothing but comments so far.
                *line += memchr_iter(b'\n', &pieces[0].text).count() as u64;
                *number += 1;
                continue;
            };
            let parse = |(k, (piece, rows)): (usize, (&mut Piece, &mut Rows))| {
                if !is_first {
                    read(k, piece)?;
                }
                piece.read(layout, skip, fields, rows);
                Ok(())
            };
            let parsed = pieces.par_iter_mut().zip(&mut *rows).enumerate().map(parse);
            // Gathered before the first error is taken: which one it is does not depend on the threads.
            parsed.collect::<Vec<_>>().into_iter().collect::<Result<(), Error>>()?;
            let mut bytes = 0;
            for (piece, rows) in pieces.iter_mut().zip(&*rows) {
                if let Some(backwards) = before.next(rows, fields) {
                    let stamp = piece.stamp_kind(piece.first_row, layout);
                    return Err(located(file, *line + piece.first_row, Fault::of(&backwards, fields, stamp)));
                }
                if let Some((at, fault)) = piece.fault.take() {
                    return Err(located(file, *line + at, fault));
                }
                index.extend(IndexedPiece::of(*number, rows, before.count, fields));
                *line += piece.lines;
                *number += 1;
                bytes += plain.map_or(0, |_| piece.text.len() as u64);
            }
            if rows.iter().any(|rows| !rows[0].is_empty()) {
                return Ok(Some((count, bytes)));
            }
        }
    }

    /// The rows that were read last.
    pub fn rows(&mut self, count: usize) -> &mut [Rows] {
        &mut self.workplace.rows[..count]
    }

    /// Keeps stamps in the first field as they are written.
    pub fn keep_stamps(&mut self) {
        self.workplace.pieces.iter_mut().for_each(|piece| piece.keeps_stamps = true);
    }

    /// The stamps of the rows that were read last.
    pub fn take_stamps(&mut self, count: usize) -> Vec<Stamps> {
        self.workplace.pieces[..count].iter_mut().map(|piece| std::mem::take(&mut piece.stamps)).collect()
    }

    /// After the end: where the rows are, of a text that is not packed.
    pub fn into_index(self, row_number: RowNumber) -> Option<Index> {
        let (layout, pieces) = self.table?;
        let Lines::Plain(lines) = self.lines else { return None };
        let (file, fields, skipped) = (self.file, self.fields, self.skipped);
        Some(Index { file, fields, row_number, lines, layout, skipped, pieces })
    }

    /// Units that stand beside or below the names of the columns, once rows were read.
    pub fn units(&self) -> Option<&UnitsFound> {
        self.units.as_ref()
    }
}

/// What stands before the first row of a text, `first` lines of the file being before it; nothing if there are only comments.
fn start(prologue: &mut Prologue, text: &[u8], first: u64, fields: &[Field]) -> Result<Option<Start>, (u64, Fault)> {
    match lines::ends_of_lines(text).or_else(|| lines::endless_line(text)) {
        Some((at, found)) => Err((at, Fault::no_table(found))),
        None => prologue.read(text, first, fields),
    }
}

/// Fills pieces with the next lines of a packed text; how many there are.
fn fill(lines: &mut Packed, is_first: bool, pieces: &mut [Piece]) -> Result<usize, Error> {
    for (k, piece) in pieces.iter_mut().enumerate() {
        if !lines.read(is_first && k == 0, &mut piece.text)? {
            return Ok(k);
        }
    }
    Ok(pieces.len())
}

/// Pieces that are worked on together, and their rows. Used again and again: memory that is asked for anew is faulted in anew,
/// page by page.
struct Workplace {
    pieces: Vec<Piece>,
    rows: Vec<Rows>,
}

impl Workplace {
    fn new(fields: usize) -> Self {
        let pieces = (0..PIECES).map(|_| Piece::default()).collect();
        Self { pieces, rows: vec![vec![Vec::new(); fields]; PIECES] }
    }
}

/// Where the rows of a text stand in it, for a second look.
pub struct Index {
    file: PathBuf,
    fields: Vec<Field>,
    row_number: RowNumber,
    lines: Plain,
    layout: Layout,
    /// Lines before the first row.
    skipped: Skipped,
    pieces: Vec<IndexedPiece>,
}

/// Lines before the first row, in the piece in which the table begins.
#[derive(Debug, Clone, Copy, Default)]
struct Skipped {
    piece: u64,
    lines: u64,
}

/// A piece that has rows.
#[derive(Debug, Clone, Copy)]
struct IndexedPiece {
    number: u64,
    /// Number of its first row, from 0.
    first_row: u64,
    /// The first field in its first and last row, or the numbers of these rows where it is not the time.
    range: [f64; 2],
}

impl IndexedPiece {
    /// The piece of that number, unless it has no rows; `count` is that of all rows up to its last.
    fn of(number: u64, rows: &Rows, count: u64, fields: &[Field]) -> Option<Self> {
        let (first, last) = (rows[0].first()?, rows[0].last()?);
        let first_row = count - rows[0].len() as u64;
        let range = if fields[0].rule.ascends() { [*first, *last] } else { [first_row as f64, (count - 1) as f64] };
        Some(Self { number, first_row, range })
    }
}

impl Index {
    /// The table, to be read again in parts.
    pub fn reread(&self) -> Reread<'_> {
        Reread {
            index: self,
            wanted: &[],
            between: [f64::INFINITY; 2],
            workplace: Workplace::new(self.fields.len()),
            count: 0,
        }
    }

    /// Bytes of the pieces that have rows between two values.
    pub fn bytes(&self, between: [f64; 2]) -> u64 {
        self.pieces.iter().filter(|piece| piece.touches(between)).count() as u64 * lines::SIZE
    }
}

impl IndexedPiece {
    fn touches(&self, [from, to]: [f64; 2]) -> bool {
        self.range[0] <= to && from <= self.range[1]
    }
}

/// A text that is read a second time, in parts.
pub struct Reread<'a> {
    index: &'a Index,
    /// Pieces that are left, and what is wanted of them.
    wanted: &'a [IndexedPiece],
    between: [f64; 2],
    workplace: Workplace,
    /// Rows that were handed out last.
    count: usize,
}

impl Reread<'_> {
    /// Begins with the rows in which the time, or the number of the row where no field is the time, is between two values.
    pub fn seek(&mut self, between: [f64; 2]) {
        (self.wanted, self.between) = (&self.index.pieces, between);
    }

    /// The next rows, of pieces that have such rows, read on all threads; none at the end.
    ///
    /// # Errors
    /// If the file cannot be read, or has changed.
    pub fn next_batch(&mut self) -> Result<Option<&mut [Rows]>, Error> {
        let Index { file, fields, row_number, lines, layout, skipped, .. } = self.index;
        let Workplace { pieces, rows } = &mut self.workplace;
        row_number.remove(&mut rows[..std::mem::take(&mut self.count)]);
        let mut batch = Vec::with_capacity(PIECES);
        while batch.len() < PIECES
            && let Some((piece, rest)) = self.wanted.split_first()
        {
            batch.extend(piece.touches(self.between).then_some(piece));
            self.wanted = rest;
        }
        if batch.is_empty() {
            return Ok(None);
        }
        let read = |((piece, rows), wanted): ((&mut Piece, &mut Rows), &&IndexedPiece)| {
            lines.read(wanted.number, &mut piece.text)?;
            let skip = if wanted.number == skipped.piece { skipped.lines } else { 0 };
            piece.read(layout, skip, fields, rows);
            row_number.put(wanted.first_row, rows);
            let found = "another text than a moment ago";
            let changed = |_| Error::content(file, Place::Whole, found, "a file that nobody writes to");
            piece.fault.take().map(changed).map_or(Ok(()), Err)
        };
        let read = pieces.par_iter_mut().zip(&mut *rows).zip(&batch).map(read);
        read.collect::<Vec<_>>().into_iter().collect::<Result<(), Error>>()?;
        self.count = batch.len();
        Ok(Some(&mut rows[..self.count]))
    }
}

/// A fault on a line of a file.
fn located(file: &Path, line: u64, fault: Fault) -> Error {
    Error::content(file, Place::Line { line, column: fault.column }, fault.found, fault.expected)
}
