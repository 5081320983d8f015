//! Values of options that more than one command takes.

use centrical_session::{ColumnName, Dimension, NotThatQuantity, Quantity};

/// A column: a number from 1, or a name.
pub fn column_name(text: &str) -> Result<ColumnName, String> {
    match text.parse::<usize>() {
        Ok(0) => Err("found 0, expected a number from 1 or a name".to_owned()),
        Ok(number) => Ok(ColumnName::Number(number)),
        Err(_) => Ok(ColumnName::Name(text.to_owned())),
    }
}

/// A sampling rate [Hz].
pub fn frequency(text: &str) -> Result<f64, String> {
    let rate = quantity(text, Dimension::Frequency).map_err(|wrong| wrong.to_string())?;
    if rate > 0.0 { Ok(rate) } else { Err(format!("found {text:?}, expected a rate above zero")) }
}

/// A time [s].
pub fn time(text: &str) -> Result<f64, NotThatQuantity> {
    quantity(text, Dimension::Time)
}

/// A quantity in SI.
pub fn quantity(text: &str, dimension: Dimension) -> Result<f64, NotThatQuantity> {
    Quantity::Text(text.to_owned()).si(dimension)
}
