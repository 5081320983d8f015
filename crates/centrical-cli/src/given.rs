//! Values of options, as commands take them.

use std::time::Duration;

use centrical_report::Language;
use centrical_session::{
    ColumnName, Dimension, NotThatQuantity, PlanRequest, Quantity, TableFormat, TumbleRequest, WatchRequest,
    available_time,
};
use clap::ValueEnum;

/// A column: a number from 1, or a name.
pub fn column_name(text: &str) -> Result<ColumnName, String> {
    match text.parse::<usize>() {
        Ok(0) => Err("found 0, expected a number from 1 or a name".to_owned()),
        Ok(number) => Ok(ColumnName::Number(number)),
        Err(_) => Ok(ColumnName::Name(text.to_owned())),
    }
}

/// A language by its code.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum LanguageName {
    /// English
    En,
    /// Russian
    Ru,
}

impl From<LanguageName> for Language {
    fn from(name: LanguageName) -> Self {
        match name {
            LanguageName::En => Self::English,
            LanguageName::Ru => Self::Russian,
        }
    }
}

/// Three columns.
#[derive(Debug, Clone)]
pub struct ThreeColumns(pub [ColumnName; 3]);

impl ThreeColumns {
    /// Columns with commas between them.
    pub fn parse(text: &str) -> Result<Self, String> {
        let columns = text.split(',').map(column_name).collect::<Result<Vec<_>, _>>()?;
        let columns = <[ColumnName; 3]>::try_from(columns);
        columns.map(Self).map_err(|found| format!("found {} columns, expected three", found.len()))
    }
}

/// A sampling rate [Hz].
pub fn sampling_rate(text: &str) -> Result<f64, NotThatQuantity> {
    written(text).sampling_rate()
}

/// Gravity at a place on Earth [m/s^2].
pub fn gravity(text: &str) -> Result<f64, NotThatQuantity> {
    written(text).gravity()
}

/// A largest distance from an axis of rotation [m].
pub fn turning_radius(text: &str) -> Result<f64, NotThatQuantity> {
    TumbleRequest::turning_radius(&written(text))
}

/// A largest error [m/s^2].
pub fn largest_error(text: &str) -> Result<f64, String> {
    with_unit(text, "300 ug")?.largest_error().map_err(|wrong| wrong.to_string())
}

/// The largest specific force of a range [m/s^2].
pub fn force_range(text: &str) -> Result<f64, String> {
    with_unit(text, "200 g")?.si(Dimension::Acceleration).map_err(|wrong| wrong.to_string())
}

/// A quantity that is an acceleration and states its unit: of a plain number nobody sees whether it is in g or in m/s^2.
fn with_unit(text: &str, example: &str) -> Result<Quantity, String> {
    if text.trim().parse::<f64>().is_ok() {
        return Err(format!("found {text:?}, expected an acceleration with its unit, such as '{example}'"));
    }
    Ok(written(text))
}

/// A number above zero that stands for a quantity: no more than a million of its unit.
pub fn above_zero(text: &str) -> Result<f64, String> {
    let value = text.parse().ok().filter(|value| *value > 0.0 && *value <= 1e6);
    value.ok_or_else(|| format!("found {text:?}, expected a number above 0 and up to 1e6"))
}

/// A time [s].
pub fn time(text: &str) -> Result<f64, NotThatQuantity> {
    written(text).si(Dimension::Time)
}

/// "200 g", or a plain number in m/s^2.
pub fn acceleration(text: &str) -> Result<f64, NotThatQuantity> {
    written(text).si(Dimension::Acceleration)
}

/// An angle [rad].
pub fn angle(text: &str) -> Result<f64, NotThatQuantity> {
    written(text).si(Dimension::Angle)
}

/// The time that a plan has [s].
pub fn available(text: &str) -> Result<f64, NotThatQuantity> {
    available_time(&written(text))
}

fn written(text: &str) -> Quantity {
    Quantity::Text(text.to_owned())
}

/// A probability above 0 and below 1.
pub fn probability(text: &str) -> Result<f64, String> {
    let value = text.parse().ok().filter(|value| *value > 0.0 && *value < 1.0);
    value.ok_or_else(|| format!("found {text:?}, expected a number above 0 and below 1"))
}

/// A duration in seconds, up to a day.
pub fn seconds(text: &str) -> Result<Duration, String> {
    WatchRequest::time(number(text)?)
}

/// A level of [K5.5].
pub fn level(text: &str) -> Result<f64, String> {
    PlanRequest::level(number(text)?)
}

fn number(text: &str) -> Result<f64, String> {
    text.trim().parse().map_err(|_| format!("found {text:?}, expected a number"))
}

/// A group of parameters and its target standard uncertainty in the unit of the table.
pub fn target(text: &str) -> Result<(String, f64), String> {
    let wrong = || format!("found {text:?}, expected GROUP=VALUE such as bias=0.01");
    let (group, value) = text.split_once('=').ok_or_else(wrong)?;
    let value: f64 = value.trim().parse().map_err(|_| wrong())?;
    if value > 0.0 { Ok((group.trim().to_owned(), value)) } else { Err(wrong()) }
}

/// The format of tables that are written.
#[derive(Debug, Clone, Copy, Default, clap::ValueEnum)]
pub enum Format {
    #[default]
    Csv,
    Parquet,
}

impl From<Format> for TableFormat {
    fn from(format: Format) -> Self {
        match format {
            Format::Csv => Self::Csv,
            Format::Parquet => Self::Parquet,
        }
    }
}
