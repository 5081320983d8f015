//! Tables as text: CSV and its kin.
//!
//! The delimiter (`;`, tab, `,` or blanks) is told by the first line; any order of columns, more columns than
//! asked for, quoted fields, CRLF, lines starting with `#` and blank lines are welcome. Where the comma does not
//! divide the fields it is the decimal comma.
//!
//! A text is read in pieces of whole lines, several at a time on all threads.

mod batch;
mod layout;
mod number;
mod piece;
mod separators;

use std::path::Path;

use memchr::{memchr, memchr_iter};
use rayon::prelude::*;

use self::batch::{Batch, ROWS};
use self::layout::{Fault, Layout, Prologue};
use self::piece::Text;
pub(crate) use self::piece::{Lines, Packed, Plain};
use self::separators::Separators;
use crate::column::Field;
use crate::error::{Error, Place};
use crate::rows::{ASCENDING, Backwards, Block, Rows, runs_backwards};

/// Pieces read at a time.
const PIECES: usize = 8;

/// Where the rows of a text stand in it, for a second look.
#[derive(Debug, Clone)]
pub struct Index {
    layout: Layout,
    pieces: Vec<IndexedPiece>,
}

/// A piece that has rows.
#[derive(Debug, Clone, Copy)]
struct IndexedPiece {
    number: u64,
    /// Number of its first row, from 0.
    first_row: u64,
    /// The first field in its first and last row, or the numbers of these rows where it is no time.
    range: [f64; 2],
}

/// A piece on its way from the file to the rows.
#[derive(Default)]
pub(crate) struct Piece {
    text: Text,
    /// Lines read without a fault.
    lines: u64,
    /// The line of the first row, counted within the piece from 0.
    first_row: u64,
    /// What stands wrong, and in which line of the piece.
    fault: Option<(u64, Fault)>,
    separators: Separators,
    batch: Batch,
}

/// Reads the table of `file` from its `lines`.
pub(crate) fn read(file: &Path, lines: &mut dyn Lines, rows: &mut Rows) -> Result<Option<Index>, Error> {
    let fields = rows.fields;
    let mut prologue = Prologue::default();
    let mut index: Option<Index> = None;
    let Workplace { mut pieces, mut blocks } = Workplace::new(fields);
    let (mut number, mut line) = (0, 1);
    loop {
        // The first piece alone: it tells how the others are to be read.
        let count = if index.is_some() { PIECES } else { 1 };
        let filled = lines.fill(number, &mut pieces[..count])?;
        if filled == 0 {
            return Ok(index);
        }
        let (pieces, blocks) = (&mut pieces[..filled], &mut blocks[..filled]);
        let any_piece = lines.any_piece();
        let fill =
            |(number, piece): (u64, &mut Piece)| any_piece.map_or(Ok(()), |lines| lines.read(number, &mut piece.text));
        let mut skipped = 0;
        let is_first = index.is_none();
        if is_first {
            fill((number, &mut pieces[0]))?;
            let start = match piece::endless_line(&pieces[0].text) {
                Some((at, found)) => Err((at, Fault::no_table(found))),
                None => prologue.read(&pieces[0].text, fields),
            };
            let (layout, skip) = start.map_err(|(at, fault)| located(file, line + at, fault))?;
            index = layout.map(|layout| Index { layout, pieces: Vec::new() });
            skipped = skip;
        }
        let Some(index) = &mut index else {
            // Nothing but comments so far.
            line += memchr_iter(b'\n', &pieces[0].text).count() as u64;
            number += 1;
            continue;
        };
        let layout = &index.layout;
        let read = |((k, piece), block): ((usize, &mut Piece), &mut Block)| {
            if !is_first {
                fill((number + k as u64, &mut *piece))?;
            }
            piece.read(layout, skipped, fields, block);
            Ok(())
        };
        let read = pieces.par_iter_mut().enumerate().zip(blocks.par_iter_mut()).map(read);
        // Gathered before the first error is taken: which one it is does not depend on the threads.
        read.collect::<Vec<_>>().into_iter().collect::<Result<(), Error>>()?;
        for (piece, block) in pieces.iter_mut().zip(blocks.iter()) {
            let backwards = rows.next(block);
            if let Some(fault) = backwards.map(|backwards| backwards.fault(fields)) {
                return Err(located(file, line + piece.first_row, fault));
            }
            if let Some((at, fault)) = piece.fault.take() {
                return Err(located(file, line + at, fault));
            }
            if let (Some(first), Some(last)) = (block[0].first(), block[0].last()) {
                let first_row = rows.count - block[0].len() as u64;
                let of_rows = [first_row as f64, (rows.count - 1) as f64];
                let range = if fields[0].rule.ascends() { [*first, *last] } else { of_rows };
                index.pieces.push(IndexedPiece { number, first_row, range });
            }
            line += piece.lines;
            number += 1;
        }
        rows.deliver(blocks);
        (rows.progress)(pieces.iter().map(|piece| piece.text.len() as u64).sum());
        if rows.is_too_long() {
            return Ok(None);
        }
    }
}

/// Pieces that are worked on together, and their rows. Used again and again: memory that is asked for anew is faulted in anew,
/// page by page.
struct Workplace {
    pieces: Vec<Piece>,
    blocks: Vec<Block>,
}

impl Workplace {
    fn new(fields: &[Field]) -> Self {
        let pieces = (0..PIECES).map(|_| Piece::default()).collect();
        Self { pieces, blocks: vec![vec![Vec::new(); fields.len()]; PIECES] }
    }
}

/// A text that is read a second time, in parts.
pub struct Reread<'a> {
    index: &'a Index,
    file: &'a Path,
    fields: &'a [Field],
    plain: Plain,
    place: Workplace,
}

impl Reread<'_> {
    /// Reads again, on all threads, the pieces in which the time, or the number of the row where no field is the time, is between
    /// two values.
    ///
    /// `visit` is given the number of the first row of a piece with its columns.
    pub fn read(&mut self, between: [f64; 2], visit: &mut dyn FnMut(u64, &mut Block)) -> Result<(), Error> {
        let Self { index, file, fields, plain, place: Workplace { pieces, blocks } } = self;
        for wanted in index.wanted(between).collect::<Vec<_>>().chunks(PIECES) {
            let read = |((piece, block), wanted): ((&mut Piece, &mut Block), &&IndexedPiece)| {
                plain.read(wanted.number, &mut piece.text)?;
                let start = (wanted.first_row == 0).then(|| Prologue::default().read(&piece.text, fields));
                let skipped = start.and_then(Result::ok).map_or(0, |(_, skipped)| skipped);
                piece.read(&index.layout, skipped, fields, block);
                let found = "another text than a moment ago";
                let changed = |_| Error::content(file, Place::Whole, found, "a file that nobody writes to");
                piece.fault.take().map(changed).map_or(Ok(()), Err)
            };
            let read = pieces.par_iter_mut().zip(&mut *blocks).zip(wanted).map(read);
            read.collect::<Vec<_>>().into_iter().collect::<Result<(), Error>>()?;
            for (wanted, block) in wanted.iter().zip(&mut *blocks) {
                visit(wanted.first_row, block);
            }
        }
        Ok(())
    }
}

impl Index {
    /// The table of a file, to be read again.
    pub fn reread<'a>(&'a self, file: &'a Path, fields: &'a [Field]) -> Result<Reread<'a>, Error> {
        let plain = Plain::open(file).map_err(|e| Error::reading(file, e, piece::TABLE))?;
        Ok(Reread { index: self, file, fields, plain, place: Workplace::new(fields) })
    }

    /// The pieces that have rows between two values.
    fn wanted(&self, [from, to]: [f64; 2]) -> impl Iterator<Item = &IndexedPiece> {
        self.pieces.iter().filter(move |piece| piece.range[0] <= to && from <= piece.range[1])
    }

    /// Bytes that [`Reread::read`] reads for two values.
    pub fn bytes(&self, between: [f64; 2]) -> u64 {
        self.wanted(between).count() as u64 * piece::SIZE
    }
}

impl Piece {
    /// Reads the rows of the text after its first `skipped` lines, up to the first fault.
    fn read(&mut self, layout: &Layout, skipped: u64, fields: &[Field], block: &mut Block) {
        block.iter_mut().for_each(Vec::clear);
        let whole = std::mem::take(&mut self.text);
        let mut text = &*whole;
        for _ in 0..skipped {
            text = split_line(text).1;
        }
        (self.lines, self.first_row, self.fault) = (skipped, skipped, None);
        let is_ascii = layout.delimiter().is_some_and(|delimiter| self.separators.find(text, delimiter));
        if !is_ascii && let Err((at, column, found)) = piece::check_utf8(text) {
            self.fault = Some((skipped + at, Fault { column, found, expected: "text in UTF-8".to_owned() }));
            text = &text[..piece::before_line(text, at)];
        }
        if let Some((at, found)) = piece::endless_line(text) {
            self.fault = Some((skipped + at, Fault::no_table(found)));
            text = &text[..piece::before_line(text, at)];
        }
        self.fault = self.read_batches(text, layout, fields, block).err().or(self.fault.take());
        self.text = whole;
        self.check_times(skipped, fields, block);
    }

    /// Reads rows of bare numbers, many at a time, and others one by one, up to the first fault.
    fn read_batches(
        &mut self,
        text: &[u8],
        layout: &Layout,
        fields: &[Field],
        block: &mut Block,
    ) -> Result<(), (u64, Fault)> {
        if layout.delimiter().is_none() {
            return self.read_rows(text, layout, fields, block);
        }
        let of_text = std::mem::take(&mut self.separators);
        let [mut separators, mut ends] = of_text.places();
        let mut from = 0;
        let read = loop {
            // A number is taken with what is before it: the first ones of all are left to be read one by one.
            let most = if from < batch::REACH { 1 } else { ROWS };
            let rows = most.min(separators.len() / layout.fields()).min(ends.len());
            let (of_batch, ends_of_batch) = (&separators[..rows * layout.fields()], &ends[..rows]);
            // Of a text that is read up to a fault, some are beyond it.
            if of_batch.last().is_none_or(|last| *last as usize >= text.len()) {
                break self.read_rows(&text[from..], layout, fields, block);
            }
            if layout.batch(text, from, of_batch, ends_of_batch, &mut self.batch, block).is_some() {
                self.lines += rows as u64;
                from = of_batch[of_batch.len() - 1] as usize + 1;
                (separators, ends) = (&separators[of_batch.len()..], &ends[rows..]);
                continue;
            }
            // As many lines: one may have more separators than it should, or fewer.
            let rest = text.len().min(ends_of_batch[rows - 1] as usize + 1);
            if let Err(fault) = self.read_rows(&text[from..rest], layout, fields, block) {
                break Err(fault);
            }
            let left = |places: &[u32]| places.partition_point(|place| (*place as usize) < rest);
            (separators, ends) = (&separators[left(separators)..], &ends[left(ends)..]);
            from = rest;
        };
        self.separators = of_text;
        read
    }

    /// Reads the rows of a text one by one, up to the first fault.
    fn read_rows(
        &mut self,
        mut text: &[u8],
        layout: &Layout,
        fields: &[Field],
        block: &mut Block,
    ) -> Result<(), (u64, Fault)> {
        let mut row = vec![0.0; fields.len()];
        while !text.is_empty() {
            let (line, rest) = split_line(text);
            if let Some(length) = layout.plain_row(text, &mut row) {
                text = &text[length..];
            } else if is_data(line) {
                layout.row(line, &mut row, fields).map_err(|fault| (self.lines, fault))?;
                text = rest;
            } else {
                self.first_row += u64::from(block[0].is_empty());
                self.lines += 1;
                text = rest;
                continue;
            }
            self.lines += 1;
            block.iter_mut().zip(&row).for_each(|(column, value)| column.push(*value));
        }
        Ok(())
    }

    /// Sees that what should ascend does, row after row.
    fn check_times(&mut self, skipped: u64, fields: &[Field], block: &Block) {
        for (field, column) in fields.iter().zip(block).filter(|(field, _)| field.rule.ascends()) {
            if runs_backwards(column)
                && let Some(row) = column.windows(2).position(|pair| pair[1] < pair[0])
            {
                let found = format!("{} after {}", column[row + 1], column[row]);
                let fault = Fault { column: Some(field.name.to_string()), found, expected: ASCENDING.to_owned() };
                self.fault = Some((self.line_of(row + 1, skipped), fault));
            }
        }
    }

    /// The line of a row, both counted from 0.
    #[cold]
    fn line_of(&self, row: usize, skipped: u64) -> u64 {
        let (mut text, mut line) = (&*self.text, 0);
        let mut left = row;
        while !text.is_empty() {
            let (this, rest) = split_line(text);
            if line >= skipped && is_data(this) {
                if left == 0 {
                    break;
                }
                left -= 1;
            }
            (text, line) = (rest, line + 1);
        }
        line
    }
}

impl Backwards {
    fn fault(self, fields: &[Field]) -> Fault {
        let column = Some(fields[self.field].name.to_string());
        Fault { column, found: self.found, expected: ASCENDING.to_owned() }
    }
}

impl Fault {
    fn no_table(found: String) -> Self {
        Self { column: None, found, expected: piece::TABLE.to_owned() }
    }
}

impl Prologue {
    /// Reads the lines before the first row: the layout of the rows and how many lines to skip; no layout if there are
    /// only comments.
    fn read(&mut self, text: &[u8], fields: &[Field]) -> Result<(Option<Layout>, u64), (u64, Fault)> {
        let mut rest = text;
        let mut number = 0;
        while !rest.is_empty() {
            let line;
            (line, rest) = split_line(rest);
            if is_data(line) {
                if let Err((_, column, found)) = piece::check_utf8(line) {
                    return Err((number, Fault { column, found, expected: "text in UTF-8".to_owned() }));
                }
                let first = self.first_line(line, fields).map_err(|fault| (number, fault))?;
                return Ok((Some(first.layout), number + u64::from(first.is_header)));
            }
            self.comment(line);
            number += 1;
        }
        Ok((None, number))
    }
}

/// A fault on a line of a file.
fn located(file: &Path, line: u64, fault: Fault) -> Error {
    Error::content(file, Place::Line { line, column: fault.column }, fault.found, fault.expected)
}

/// The first line without its end, and the rest.
#[inline]
fn split_line(text: &[u8]) -> (&[u8], &[u8]) {
    let (line, rest) = match memchr(b'\n', text) {
        Some(end) => (&text[..end], &text[end + 1..]),
        None => (text, &text[text.len()..]),
    };
    (line.strip_suffix(b"\r").unwrap_or(line), rest)
}

/// Whether a line is neither blank nor a comment.
#[inline]
fn is_data(line: &[u8]) -> bool {
    match line.first() {
        None | Some(b'#') => false,
        Some(b' ' | b'\t') => !matches!(line.trim_ascii_start().first(), None | Some(b'#')),
        Some(_) => true,
    }
}
