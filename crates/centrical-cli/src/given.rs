//! Values of options, as commands take them.

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
    let is_rate = (1e-3..=1e9).contains(&rate);
    is_rate.then_some(rate).ok_or_else(|| format!("found {text:?}, expected a rate from 1e-3 Hz to 1 GHz"))
}

/// A largest error [m/s^2].
pub fn largest_error(text: &str) -> Result<f64, String> {
    if text.trim().parse::<f64>().is_ok() {
        return Err(format!("found {text:?}, expected an acceleration with its unit, such as '300 ug'"));
    }
    let error = quantity(text, Dimension::Acceleration).map_err(|wrong| wrong.to_string())?;
    if error > 0.0 { Ok(error) } else { Err(format!("found {text:?}, expected an acceleration above zero")) }
}

/// A number above zero that stands for a quantity: no more than a million of its unit.
pub fn above_zero(text: &str) -> Result<f64, String> {
    let value = text.parse().ok().filter(|value| *value > 0.0 && *value <= 1e6);
    value.ok_or_else(|| format!("found {text:?}, expected a number above 0 and up to 1e6"))
}

/// A time [s].
pub fn time(text: &str) -> Result<f64, NotThatQuantity> {
    quantity(text, Dimension::Time)
}

/// A quantity in SI.
pub fn quantity(text: &str, dimension: Dimension) -> Result<f64, NotThatQuantity> {
    Quantity::Text(text.to_owned()).si(dimension)
}

/// A chance above 0 and below 1.
pub fn chance(text: &str) -> Result<f64, String> {
    let value = text.parse().ok().filter(|value| (0.0..1.0).contains(value) && *value > 0.0);
    value.ok_or_else(|| format!("found {text:?}, expected a chance above 0 and below 1"))
}

/// A duration in seconds, up to a day.
pub fn seconds(text: &str) -> Result<f64, String> {
    // A day at most.
    let value = text.parse().ok().filter(|value| (0.0..=86400.0).contains(value));
    value.ok_or_else(|| format!("found {text:?}, expected seconds from 0 to 86400"))
}

/// A group of parameters and its target standard uncertainty in the unit of the table.
pub fn target(text: &str) -> Result<(String, f64), String> {
    let wrong = || format!("found {text:?}, expected GROUP=VALUE such as bias=0.01");
    let (group, value) = text.split_once('=').ok_or_else(wrong)?;
    let value: f64 = value.trim().parse().map_err(|_| wrong())?;
    if value > 0.0 { Ok((group.trim().to_owned(), value)) } else { Err(wrong()) }
}
