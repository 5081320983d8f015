//! What a document says, as data. A renderer draws it and adds no word of its own.

use crate::figure::Figure;
use crate::language::Language;

/// A document.
#[derive(Debug, Clone, PartialEq)]
pub struct Document {
    /// Language of its text.
    pub language: Language,
    /// Title of the file.
    pub title: String,
    /// What stands before the first section.
    pub opening: Opening,
    /// Title of the list of sections that a reader opens; empty in a document of one layer.
    pub contents: String,
    /// The sections in their order.
    pub sections: Vec<Section>,
    /// What stands around the text.
    pub margins: Margins,
    /// A file that the document carries, where its form can.
    pub attachment: Option<Attachment>,
}

/// A file inside a document.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attachment {
    /// Its name.
    pub name: &'static str,
    /// Its media type.
    pub media_type: &'static str,
    /// Its bytes.
    pub bytes: Vec<u8>,
}

/// What a document opens with.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Opening {
    /// Kind of the document, over its title; may be empty.
    pub kind: String,
    /// Title.
    pub title: String,
    /// Lines under the title.
    pub lines: Vec<String>,
    /// Date at the end of the last line; may be empty.
    pub date: String,
    /// Picture beside the title, such as a laboratory's mark.
    pub picture: Option<Picture>,
}

/// A picture of opaque pixels.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green and blue of each pixel, sRGB, row by row from above.
    pub pixels: Vec<u8>,
}

/// What stands around the text, on every page where there are pages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Margins {
    /// Over the text, on the left and on the right.
    pub head: [String; 2],
    /// Under the text.
    pub foot: String,
    /// Words before the number of a page and before the count of pages.
    pub page: [&'static str; 2],
}

/// A section.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// What it means for the reader.
    pub tone: Tone,
    /// Where it stands in a document of two layers.
    pub layer: Layer,
    /// Its blocks in their order.
    pub blocks: Vec<Block>,
}

/// Where a section stands in a document of two layers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layer {
    /// What every reader sees.
    First,
    /// What a reader opens, listed in the contents; open on paper.
    Further,
}

/// What a section means for the reader.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tone {
    /// A part of the text.
    Plain,
    /// A statement that favours neither side.
    Neutral,
    /// A favourable verdict.
    Good,
    /// An unfavourable verdict.
    Bad,
}

/// A block of a section.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// Heading of a section, and the lines of text that stay with it on a page.
    Heading(String, u8),
    /// Heading inside a section.
    Subheading(String),
    /// A paragraph.
    Paragraph(String),
    /// A paragraph that explains what stands beside it.
    Note(String),
    /// A list.
    List(Vec<String>),
    /// A list of formulas.
    Formulas(Vec<String>),
    /// Names and what they stand for.
    Facts(Vec<Fact>),
    /// A table.
    Table(Table),
    /// A figure.
    Figure(Figure),
    /// A line for a signature.
    Signature {
        /// Who signs.
        name: String,
        /// As what.
        role: String,
        /// What the line is for.
        word: String,
        /// What the shorter line beside it is for.
        date: String,
        /// What the free place under it is for.
        mark: String,
    },
}

/// A name and what it stands for; a second line of the same fact has no name.
pub type Fact = (String, String);

/// A table.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// What it holds.
    pub kind: TableKind,
    /// Its columns.
    pub columns: Vec<Column>,
    /// Its rows.
    pub rows: Vec<Row>,
}

/// What a table holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableKind {
    /// Numbers.
    Numbers,
    /// Parameters group by group.
    Parameters,
    /// Files and their hashes.
    Files,
}

/// A column of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Title.
    pub title: String,
    /// Share of the width of the text.
    pub share: f32,
    /// Side on which its text stands.
    pub align: Align,
}

/// Side on which text stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Align {
    /// Left.
    Left,
    /// Right.
    Right,
}

/// A row of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Row {
    /// Name of the rows that follow.
    Group(String),
    /// A name, and the cells beside it.
    Cells(Vec<String>),
}

impl Section {
    /// A part of the text that every reader sees.
    pub(super) fn plain(blocks: Vec<Block>) -> Self {
        Self { tone: Tone::Plain, layer: Layer::First, blocks }
    }

    /// A part of the text that a reader opens.
    pub(super) fn further(blocks: Vec<Block>) -> Self {
        Self { layer: Layer::Further, ..Self::plain(blocks) }
    }
}

impl Block {
    /// The facts whose value is not empty.
    pub(super) fn facts<'n>(facts: impl IntoIterator<Item = (&'n str, String)>) -> Self {
        let known = facts.into_iter().filter(|(_, value)| !value.is_empty());
        Self::Facts(known.map(|(name, value)| (name.to_owned(), value)).collect())
    }

    /// A paragraph.
    pub(super) fn paragraph(text: &str) -> Self {
        Self::Paragraph(text.to_owned())
    }

    /// A heading, and the lines of text that stay with it on a page.
    pub(super) fn heading(text: &str, lines: u8) -> Self {
        Self::Heading(text.to_owned(), lines)
    }
}

impl Table {
    /// A table of numbers, its columns given by title, share and side.
    pub(super) fn numbers<const N: usize>(
        columns: [(&str, f32, Align); N],
        rows: impl IntoIterator<Item = Vec<String>>,
    ) -> Self {
        let columns = columns.map(|(title, share, align)| Column { title: title.to_owned(), share, align }).to_vec();
        Self { kind: TableKind::Numbers, columns, rows: rows.into_iter().map(Row::Cells).collect() }
    }
}
