//! Where a table begins in a text, without a word about its columns: rows are many and alike, what stands above them is not.

use std::borrow::Cow;

use super::fields::{Delimiter, number};
use super::unit_words::unit_in_any;
use crate::stamp;

/// Lines at the end of a sample that show what a row is.
const TAIL: usize = 20;

/// Ends each part of the preamble that LabVIEW writes into a measurement file (.lvm).
const END_OF_PREAMBLE: &[u8] = b"***End_of_Header***";

/// Where a table begins, as indices of lines that are neither blank nor comments.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Shape {
    pub delimiter: Delimiter,
    /// Fields in a row.
    pub columns: usize,
    pub header: Option<usize>,
    pub units: Option<usize>,
    pub first_row: usize,
}

impl Shape {
    /// The shape that the first lines of a text show; `None` where they are not a table of numbers.
    pub fn of(lines: &[&[u8]]) -> Option<Self> {
        let above = after_preamble(lines);
        let tail = &lines[above..][(lines.len() - above).saturating_sub(TAIL)..];
        let (delimiter, columns) = usual(tail)?;
        let rows = tail.iter().filter_map(|line| numbers(delimiter, line, columns));
        let rows: Vec<Vec<bool>> = rows.filter(|row| row.contains(&true)).collect();
        let is_usual = |column: &usize| 2 * rows.iter().filter(|row| row[*column]).count() > rows.len();
        let usual: Vec<usize> = (0..columns).filter(is_usual).collect();
        let is_row = |line: &[u8]| {
            let of_line = numbers(delimiter, line, columns);
            of_line.is_some_and(|row| 2 * usual.iter().filter(|column| row[**column]).count() > usual.len())
        };
        let first_row = above + lines[above..].iter().position(|line| is_row(line))?;
        let names = |index: usize| delimiter.texts(lines[index]).ok().filter(|names| names.len() + 1 >= columns);
        let before = |index: usize| index.checked_sub(1).filter(|index| *index >= above && names(*index).is_some());
        let header = before(first_row);
        let units = header.filter(|units| before(*units).is_some() && names(*units).is_some_and(|n| are_units(&n)));
        Some(Self { delimiter, columns, header: units.map_or(header, before), units, first_row })
    }
}

/// The first line after a preamble of LabVIEW; 0 without one.
pub(super) fn after_preamble(lines: &[&[u8]]) -> usize {
    if !lines.first().is_some_and(|line| line.starts_with(b"LabVIEW Measurement")) {
        return 0;
    }
    lines.iter().rposition(|line| line.starts_with(END_OF_PREAMBLE)).map_or(0, |end| end + 1)
}

/// Whether the texts are units, some of them empty.
pub(super) fn are_units(texts: &[Cow<[u8]>]) -> bool {
    let is_empty = |text: &[u8]| matches!(text, b"" | b"-" | b"--" | b"[]" | b"()" | b"[-]" | b"(-)");
    let is_bracketed = |text: &[u8]| matches!(text, [b'[', .., b']'] | [b'(', .., b')']) && !is_empty(text);
    let is_one = |text: &Cow<[u8]>| is_bracketed(text) || unit_in_any(text).is_some();
    texts.iter().any(is_one) && texts.iter().all(|text| is_one(text) || is_empty(text))
}

/// The delimiter and the number of fields that most of the lines have.
fn usual(lines: &[&[u8]]) -> Option<(Delimiter, usize)> {
    let mut kinds: Vec<((Delimiter, usize), usize)> = Vec::new();
    for line in lines {
        let delimiter = Delimiter::of(line);
        let Ok(texts) = delimiter.texts(line) else { continue };
        if !texts.iter().any(|text| is_number(text)) {
            continue;
        }
        let kind = (delimiter, texts.len());
        match kinds.iter_mut().find(|(own, _)| *own == kind) {
            Some((_, count)) => *count += 1,
            None => kinds.push((kind, 1)),
        }
    }
    kinds.into_iter().rev().max_by_key(|(_, count)| *count).map(|(kind, _)| kind)
}

/// Which fields of a line are numbers or stamps; nothing where there are not as many fields.
fn numbers(delimiter: Delimiter, line: &[u8], columns: usize) -> Option<Vec<bool>> {
    let texts = delimiter.texts(line).ok()?;
    (texts.len() == columns).then(|| texts.iter().map(|text| is_number(text)).collect())
}

/// Whether a field can stand in a row.
pub(super) fn is_number(text: &[u8]) -> bool {
    number(text).is_some() || stamp::seconds(text).is_some()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape(text: &str) -> Option<(Option<usize>, Option<usize>, usize)> {
        let lines: Vec<&[u8]> = text.lines().map(str::as_bytes).filter(|line| !line.is_empty()).collect();
        Shape::of(&lines).map(|shape| (shape.header, shape.units, shape.first_row))
    }

    #[test]
    fn the_table_is_found_below_what_is_above_it() {
        let cases = [
            ("t;f1\n0;1\n1;2\n", Some((Some(0), None, 1))),
            ("0;1\n1;2\n", Some((None, None, 0))),
            ("Date;05.10.2026\nChannels;3\nt;f1;f2\ns;g;g\n0;1;2\n1;2;3\n", Some((Some(2), Some(3), 4))),
            ("Recorder 7\n\nt,f1\n[s],[V]\n0,1\n1,2\n", Some((Some(1), Some(2), 3))),
            ("s;g\n0;1\n", Some((Some(0), None, 1))),
            ("one\ntwo\n", None),
            ("", None),
            ("note;t;f1\na;0;1\nb;1;2\n", Some((Some(0), None, 1))),
        ];
        for (text, expected) in cases {
            assert_eq!(shape(text), expected, "{text}");
        }
        let lvm = "LabVIEW Measurement\t\nSeparator\tTab\n***End_of_Header***\t\nChannels\t2\nX0\t0,0\t0,0\n\
                   ***End_of_Header***\t\t\nX_Value\tU\tU 1\tComment\n0,0\t1,5\t2,5\n0,1\t1,5\t2,5\n";
        assert_eq!(shape(lvm), Some((Some(6), None, 7)));
    }
}
