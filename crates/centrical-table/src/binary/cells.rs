//! Columns of several kinds, as a store of results has them: text, numbers, counts, truths, and lists of them.

/// What the cells of a column are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A text, or nothing.
    Text,
    /// A number, or nothing.
    Number,
    /// An integer, or nothing.
    Integer,
    /// True, false, or nothing.
    Truth,
    /// A list of texts.
    Texts,
    /// A list of numbers.
    Numbers,
    /// A list of integers.
    Integers,
}

/// A column: its name and what its cells are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TypedColumn {
    /// Name.
    pub name: &'static str,
    /// What its cells are.
    pub kind: Kind,
}

/// One cell.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// Nothing.
    Null,
    /// A text.
    Text(String),
    /// A number.
    Number(f64),
    /// An integer.
    Integer(i64),
    /// True or false.
    Truth(bool),
    /// A list of texts.
    Texts(Vec<String>),
    /// A list of numbers; NaN is nothing in the file.
    Numbers(Vec<f64>),
    /// A list of integers.
    Integers(Vec<i64>),
}

impl Kind {
    /// Whether its cells are lists.
    pub fn is_list(self) -> bool {
        matches!(self, Self::Texts | Self::Numbers | Self::Integers)
    }
}
