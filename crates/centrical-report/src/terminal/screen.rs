//! What a command shows, before the width of a terminal is known: sentences that wrap at words, tables that fold, a verdict.

use centrical_session::harmless_line;

use super::table::{Table, wrapped};

/// Narrowest width that texts are made for, in characters: narrower terminals wrap by themselves.
pub const NARROWEST: usize = 40;

/// Width of the column of keywords beside facts.
const KEYWORD: usize = 8;

/// What is emphasised at the beginning of a line. The word itself carries the meaning, a colour only repeats it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Emphasis {
    /// A verdict in favour.
    Acceptable,
    /// A verdict against.
    NotAcceptable,
    /// A caution.
    Warning,
    /// The head of a section.
    Heading,
}

/// A line of a text: its beginning, perhaps emphasised, and the rest.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Line {
    /// What is emphasised, and how.
    pub mark: Option<(Emphasis, String)>,
    /// What follows it.
    pub rest: String,
}

impl Line {
    fn plain(rest: String) -> Self {
        Self { mark: None, rest }
    }
}

/// What a command shows.
#[derive(Debug, Clone, Default)]
pub struct Screen {
    parts: Vec<Part>,
    closing: Option<(Emphasis, String, String)>,
}

/// A part of what a command shows.
#[derive(Debug, Clone)]
pub(crate) enum Part {
    /// An empty line.
    Gap,
    /// A sentence: its first line begins after `first` blanks, others after `further`.
    Words { mark: Option<(Emphasis, String)>, first: usize, further: usize, words: String },
    /// A table.
    Table(Table),
}

impl Screen {
    /// An empty line.
    pub fn gap(&mut self) {
        self.parts.push(Part::Gap);
    }

    /// A sentence that begins with a word in emphasis.
    pub fn marked(&mut self, emphasis: Emphasis, mark: &str, words: &str) {
        let mark = Some((emphasis, mark.to_owned()));
        let words = if words.is_empty() { String::new() } else { format!("  {}", harmless_line(words)) };
        self.parts.push(Part::Words { mark, first: 0, further: 2, words });
    }

    /// The head of a section.
    pub(super) fn head(&mut self, mark: &str, words: &str) {
        self.marked(Emphasis::Heading, mark, words);
    }

    /// A sentence after `indent` blanks.
    pub fn say(&mut self, indent: usize, words: &str) {
        self.sentence(indent, indent + 2, words);
    }

    /// A sentence whose first line begins after `first` blanks, and others after `further`.
    pub(super) fn sentence(&mut self, first: usize, further: usize, words: &str) {
        self.parts.push(Part::Words { mark: None, first, further, words: harmless_line(words).into_owned() });
    }

    /// A fact beside its keyword; without a keyword it belongs to the one before.
    pub(super) fn fact(&mut self, keyword: &str, words: &str) {
        let words = harmless_line(words);
        if keyword.is_empty() {
            return self.sentence(KEYWORD, KEYWORD, &words);
        }
        let words = format!("{:blanks$}{words}", "", blanks = KEYWORD.saturating_sub(keyword.len()).max(1));
        let mark = Some((Emphasis::Heading, keyword.to_owned()));
        self.parts.push(Part::Words { mark, first: 0, further: KEYWORD, words });
    }

    /// A table.
    pub(super) fn table(&mut self, table: Table) {
        self.parts.push(Part::Table(table));
    }

    /// What another text shows, after this one. A last line of the other is that of both.
    pub fn add(&mut self, other: Self) {
        self.parts.extend(other.parts);
        self.closing = other.closing.or(self.closing.take());
    }

    /// The parts from top to bottom, without the last line.
    pub(crate) fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// A last line, for a text that is longer than a screen.
    pub(super) fn close(&mut self, emphasis: Emphasis, mark: &str, words: &str) {
        self.closing = Some((emphasis, mark.to_owned(), words.to_owned()));
    }

    /// The lines for a terminal of `width` characters in `height` lines. Only a word that is longer than a line is not broken.
    pub fn lines(&self, width: usize, height: usize) -> Vec<Line> {
        let width = width.max(NARROWEST);
        let mut lines: Vec<Line> = self.parts.iter().flat_map(|part| part.lines(width)).collect();
        if let Some((emphasis, mark, words)) = self.closing.as_ref().filter(|_| lines.len() > height) {
            let mark = Some((*emphasis, mark.clone()));
            let closing = Part::Words { mark, first: 0, further: 2, words: format!("  {words}") };
            lines.extend(closing.lines(width));
        }
        lines
    }

    /// The text without emphasis.
    pub fn text(&self, width: usize, height: usize) -> String {
        let line = |Line { mark, rest }: Line| format!("{}{rest}\n", mark.map_or(String::new(), |(_, mark)| mark));
        self.lines(width, height).into_iter().map(line).collect()
    }
}

impl Part {
    fn lines(&self, width: usize) -> Vec<Line> {
        match self {
            Self::Gap => vec![Line::default()],
            Self::Table(table) => table.lines(width).into_iter().map(Line::plain).collect(),
            Self::Words { mark, first, further, words } => {
                let taken = mark.as_ref().map_or(0, |(_, mark)| mark.chars().count());
                let mut lines = wrapped(words, width, first + taken, *further).into_iter();
                let start = lines.next().unwrap_or_default();
                let start = Line { mark: mark.clone(), rest: format!("{:first$}{start}", "") };
                let others = lines.map(|line| Line::plain(format!("{:further$}{line}", "")));
                std::iter::once(start).chain(others).collect()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Emphasis, Screen};

    #[test]
    fn sentences_wrap_at_words_under_their_beginning() {
        let mut screen = Screen::default();
        screen.marked(Emphasis::NotAcceptable, "NOT ACCEPTABLE", "the residuals are larger than the noise explains");
        screen.fact("FIT", "a value of -3.952149 ± 0.000012 stands on one line");
        let lines = [
            "NOT ACCEPTABLE  the residuals are larger",
            "  than the noise explains",
            "FIT     a value of -3.952149 ± 0.000012",
            "        stands on one line",
            "",
        ];
        assert_eq!(screen.text(40, 24), lines.join("\n"));
    }

    #[test]
    fn a_last_line_stands_below_what_is_longer_than_a_screen() {
        let mut screen = Screen::default();
        screen.close(Emphasis::Acceptable, "ACCEPTABLE", "no objection");
        for _ in 0..3 {
            screen.say(0, "a line");
        }
        assert_eq!(screen.lines(80, 3).len(), 3);
        assert!(screen.text(80, 2).ends_with("a line\nACCEPTABLE  no objection\n"));
    }
}
