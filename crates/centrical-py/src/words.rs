//! Words and quantities as arguments.

use centrical_report::Language;
use centrical_session::{ColumnName, Dimension, Method, NotThatQuantity, PlateauName, Quantity, TableFormat};
use pyo3::exceptions::PyValueError;
use pyo3::{FromPyObject, PyErr, PyResult};

/// A number in SI, or a text with a unit.
#[derive(FromPyObject)]
pub enum Amount {
    /// In SI.
    Number(f64),
    /// Such as "200 g".
    Text(String),
}

impl Amount {
    /// As files and commands have it.
    pub fn quantity(self) -> Quantity {
        match self {
            Self::Number(number) => Quantity::Number(number),
            Self::Text(text) => Quantity::Text(text),
        }
    }

    /// Its value in SI.
    ///
    /// # Errors
    /// `ValueError` when it is not a quantity of that dimension.
    pub fn si(self, argument: &str, dimension: Dimension) -> PyResult<f64> {
        self.quantity().si(dimension).map_err(|wrong| refused(argument, wrong))
    }

    /// The value of one that need not be there.
    ///
    /// # Errors
    /// As [`Amount::si`].
    pub fn optional(amount: Option<Self>, argument: &str, dimension: Dimension) -> PyResult<Option<f64>> {
        Self::checked(amount, argument, |quantity| quantity.si(dimension))
    }

    /// The value of one that need not be there, by a check of quantities.
    ///
    /// # Errors
    /// `ValueError` when the check refuses it.
    pub fn checked(
        amount: Option<Self>,
        argument: &str,
        check: impl FnOnce(&Quantity) -> Result<f64, NotThatQuantity>,
    ) -> PyResult<Option<f64>> {
        amount.map(|amount| check(&amount.quantity()).map_err(|wrong| refused(argument, wrong))).transpose()
    }
}

/// The value that a word stands for.
///
/// # Errors
/// `ValueError` with the words there are.
pub fn one_of<T: Copy>(argument: &str, found: &str, words: &[(&str, T)]) -> PyResult<T> {
    let expected = || words.iter().map(|(word, _)| format!("{word:?}")).collect::<Vec<_>>().join(", ");
    let known = words.iter().find(|(word, _)| *word == found);
    known
        .map(|(_, value)| *value)
        .ok_or_else(|| refused(argument, format!("found {found:?}, expected one of {}", expected())))
}

/// How the estimates are computed.
///
/// # Errors
/// As [`one_of`].
pub fn method(word: &str) -> PyResult<Method> {
    let words = [
        ("exact", Method::Exact),
        ("recursive", Method::Recursive),
        ("linear", Method::Linear),
        ("recursive-linear", Method::RecursiveLinear),
    ];
    one_of("method", word, &words)
}

/// The format of tables that are written.
///
/// # Errors
/// As [`one_of`].
pub fn format(word: &str) -> PyResult<TableFormat> {
    one_of("format", word, &[("csv", TableFormat::Csv), ("parquet", TableFormat::Parquet)])
}

/// The language of documents.
///
/// # Errors
/// As [`one_of`].
pub fn language(word: &str) -> PyResult<Language> {
    one_of("language", word, &[("en", Language::English), ("ru", Language::Russian)])
}

/// Plateaus as people name them.
///
/// # Errors
/// `ValueError` for one that is not such a name.
pub fn plateaus(argument: &str, names: &[String]) -> PyResult<Vec<PlateauName>> {
    names.iter().map(|name| plateau(argument, name)).collect()
}

/// A plateau as people name it.
///
/// # Errors
/// As [`plateaus`].
pub fn plateau(argument: &str, name: &str) -> PyResult<PlateauName> {
    name.parse().map_err(|wrong: String| refused(argument, wrong))
}

/// A number above 0 and below 1.
///
/// # Errors
/// `ValueError` for any other.
pub fn probability(argument: &str, value: f64) -> PyResult<f64> {
    if value > 0.0 && value < 1.0 {
        return Ok(value);
    }
    Err(refused(argument, format!("found {value}, expected a number above 0 and below 1")))
}

/// An argument that is wrong, and why.
pub fn refused(argument: &str, why: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(format!("{argument}: {why}"))
}

/// A column by its name, or by its number from 1.
#[derive(FromPyObject)]
pub enum GivenColumn {
    /// Its number.
    Number(usize),
    /// Its name.
    Name(String),
}

/// The name of a column.
pub fn column(argument: &str, name: GivenColumn) -> PyResult<ColumnName> {
    match name {
        GivenColumn::Number(0) => Err(refused(argument, "found 0, expected a number from 1 or a name")),
        GivenColumn::Number(number) => Ok(ColumnName::Number(number)),
        GivenColumn::Name(name) => Ok(ColumnName::Name(name)),
    }
}
