//! Words in lines; and tables in lines: columns as wide as their cells, folded where a line ends.

use std::fmt::{self, Display, Formatter};

use crate::number::with_uncertainty;

/// Blanks before a row, and between two columns.
const MARGIN: usize = 2;

/// Narrowest column of words that wrap.
const WORDS: usize = 24;

/// How the cells of a column stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Align {
    /// Names and units.
    Left,
    /// Numbers.
    Right,
    /// Words that wrap within what is free of the line; the last column.
    Words,
}

/// One entry: what stands before the place at which a column is aligned, and what stands after it.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Cell(String, String);

impl<T: Into<String>> From<T> for Cell {
    fn from(text: T) -> Self {
        Self(text.into(), String::new())
    }
}

impl Cell {
    /// `value ± uncertainty` times `factor`, to two digits of the uncertainty.
    pub fn estimate(factor: f64, value: f64, uncertainty: f64) -> Self {
        Self::shown(with_uncertainty(factor * value, factor.abs() * uncertainty))
    }

    /// `value ± uncertainty`, aligned at the sign.
    pub fn shown((value, uncertainty): (String, String)) -> Self {
        Self(value, format!(" ± {uncertainty}"))
    }

    fn is_empty(&self) -> bool {
        self.0.is_empty() && self.1.is_empty()
    }
}

impl Display for Cell {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        write!(f, "{}{}", self.0, self.1)
    }
}

/// Named columns; the first ones name the row.
#[derive(Debug, Clone)]
pub(crate) struct Table {
    names: usize,
    columns: Vec<(String, Align)>,
    rows: Vec<Vec<Cell>>,
}

impl Table {
    /// A table without rows, whose first `names` columns name the row; titles of columns that stand alike are together.
    pub fn new(names: usize, columns: &[(Align, &[&str])]) -> Self {
        let titled =
            |(align, titles): &(Align, &[&str])| titles.iter().map(|title| ((*title).to_owned(), *align)).collect();
        Self::of(names, columns.iter().flat_map::<Vec<_>, _>(titled).collect())
    }

    /// The same of titles that are made for it.
    pub fn of(names: usize, columns: Vec<(String, Align)>) -> Self {
        Self { names, columns, rows: Vec::new() }
    }

    /// Adds a row; cells that are missing are empty.
    pub fn row(&mut self, cells: impl IntoIterator<Item = Cell>) {
        let mut cells: Vec<Cell> = cells.into_iter().collect();
        cells.resize(self.columns.len(), Cell::default());
        self.rows.push(cells);
    }

    /// The columns with entries: place, title, and how their cells stand.
    pub fn columns(&self) -> impl Iterator<Item = (usize, &str, Align)> {
        let has_entries = |j: &usize| self.rows.iter().any(|row| !row[*j].is_empty());
        (0..self.columns.len()).filter(has_entries).map(|j| (j, self.columns[j].0.as_str(), self.columns[j].1))
    }

    /// The rows: a cell for each column, those without entries too.
    pub fn rows(&self) -> &[Vec<Cell>] {
        &self.rows
    }

    /// The rows in lines of `width` characters. Columns that do not fit follow below, beside the names of their rows.
    pub fn lines(&self, width: usize) -> Vec<String> {
        let widths: Vec<[usize; 2]> = (0..self.columns.len()).map(|j| self.width(j)).collect();
        let mut lines = Vec::new();
        for (n, fold) in self.folds(&widths, width).iter().enumerate() {
            let is_in_fold = |row: &&Vec<Cell>| n == 0 || fold[self.names..].iter().any(|&j| !row[j].is_empty());
            let rows: Vec<&Vec<Cell>> = self.rows.iter().filter(is_in_fold).collect();
            if n > 0 && rows.is_empty() {
                continue;
            }
            if n > 0 {
                lines.push(String::new());
            }
            let titles: Vec<Cell> = self.columns.iter().map(|(title, _)| title.as_str().into()).collect();
            if fold.iter().any(|&j| !titles[j].is_empty()) {
                self.line(&mut lines, fold, &widths, &titles, true, width);
            }
            for row in rows {
                self.line(&mut lines, fold, &widths, row, false, width);
            }
        }
        lines
    }

    /// Characters before and after the place of alignment; a column without entries has none.
    fn width(&self, j: usize) -> [usize; 2] {
        let length = |text: &str| text.chars().count();
        let widest = |part: fn(&Cell) -> &str| self.rows.iter().map(|row| length(part(&row[j]))).max().unwrap_or(0);
        let [before, after] = [widest(|cell| &cell.0), widest(|cell| &cell.1)];
        if before + after == 0 {
            return [0, 0];
        }
        [before.max(length(&self.columns[j].0).saturating_sub(after)), after]
    }

    /// Columns side by side in each fold, the names of rows first.
    fn folds(&self, widths: &[[usize; 2]], width: usize) -> Vec<Vec<usize>> {
        let taken = |j: usize| match widths[j].iter().sum() {
            0 => 0,
            full if self.columns[j].1 == Align::Words => MARGIN + WORDS.min(full),
            full => MARGIN + full,
        };
        let names: Vec<usize> = (0..self.names).collect();
        let start: usize = names.iter().map(|&j| taken(j)).sum();
        let mut folds = vec![names.clone()];
        let mut used = start;
        for j in (self.names..self.columns.len()).filter(|&j| taken(j) > 0) {
            if used + taken(j) > width && used > start {
                folds.push(names.clone());
                used = start;
            }
            used += taken(j);
            if let Some(fold) = folds.last_mut() {
                fold.push(j);
            }
        }
        folds
    }

    fn line(
        &self,
        lines: &mut Vec<String>,
        fold: &[usize],
        widths: &[[usize; 2]],
        cells: &[Cell],
        is_title: bool,
        width: usize,
    ) {
        let mut line = String::new();
        let mut below: Vec<String> = Vec::new();
        for &j in fold.iter().filter(|&&j| widths[j] != [0, 0]) {
            let ([before, after], Cell(first, second)) = (widths[j], &cells[j]);
            let full = before + after;
            line.push_str(&" ".repeat(MARGIN));
            let piece = match self.columns[j].1 {
                Align::Left => format!("{first:<full$}"),
                Align::Right if is_title => format!("{first:>full$}"),
                Align::Right => format!("{first:>before$}{second:<after$}"),
                Align::Words => {
                    let start = line.chars().count();
                    let mut wrapped = wrapped(first, width, start, start).into_iter();
                    let first = wrapped.next().unwrap_or_default();
                    below.extend(wrapped.map(|words| format!("{:start$}{words}", "")));
                    first
                }
            };
            line.push_str(&piece);
        }
        line.truncate(line.trim_end().len());
        lines.push(line);
        lines.extend(below);
    }
}

/// The words in lines of `width` characters: the first begins after `first` characters, others after `further`. Blanks at
/// the beginning stay. A word that is longer than a line has a line of its own.
pub(super) fn wrapped(words: &str, width: usize, first: usize, further: usize) -> Vec<String> {
    let leading = words.chars().take_while(|c| *c == ' ').count();
    let mut lines = vec![" ".repeat(leading)];
    let (mut used, mut is_empty) = (first + leading, true);
    for word in unbroken(words.trim()) {
        let length = word.chars().count();
        if !is_empty && used + 1 + length > width {
            lines.push(String::new());
            (used, is_empty) = (further, true);
        }
        if let Some(line) = lines.last_mut() {
            if !is_empty {
                line.push(' ');
            }
            line.push_str(&word);
        }
        used += length + usize::from(!is_empty);
        is_empty = false;
    }
    lines
}

/// The words; a value stays with its uncertainty, and a name with what is set.
fn unbroken(words: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let mut is_open = false;
    for word in words.split_whitespace() {
        match found.last_mut() {
            Some(last) if is_open || matches!(word, "±" | "=") => {
                last.push(' ');
                last.push_str(word);
            }
            _ => found.push(word.to_owned()),
        }
        is_open = matches!(word, "±" | "=");
    }
    found
}

#[cfg(test)]
mod tests {
    use super::{Align, Cell, Table};

    fn table() -> Table {
        let columns: [(Align, &[&str]); 3] =
            [(Align::Left, &[""]), (Align::Right, &["value", "chi^2"]), (Align::Words, &["note"])];
        let mut table = Table::new(1, &columns);
        let estimate = |value: &str, u: &str| Cell::shown((value.to_owned(), u.to_owned()));
        table.row(["first".into(), estimate("-3.95", "0.10"), "12.0".into()]);
        table.row([
            "second".into(),
            estimate("744", "12"),
            "8.1".into(),
            "words that take more than a line have".into(),
        ]);
        table
    }

    #[test]
    fn columns_are_aligned_and_words_wrap_in_theirs() {
        let lines = [
            "                 value  chi^2  note",
            "  first   -3.95 ± 0.10   12.0",
            "  second    744 ± 12      8.1  words that take more than",
            "                               a line have",
        ];
        assert_eq!(table().lines(56), lines);
    }

    #[test]
    fn columns_that_do_not_fit_follow_beside_the_names() {
        let lines = [
            "                 value  chi^2",
            "  first   -3.95 ± 0.10   12.0",
            "  second    744 ± 12      8.1",
            "",
            "          note",
            "  second  words that take more than",
            "          a line have",
        ];
        assert_eq!(table().lines(36), lines);
    }
}
