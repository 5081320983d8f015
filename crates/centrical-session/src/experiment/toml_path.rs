//! Places in the experiment file, for messages.

use std::path::Path;

use centrical::Parameter;

use crate::error::{Error, Place};
use crate::quantity::{Quantity, in_parameter_unit};
use crate::units::Dimension;

/// A table of the experiment file.
#[derive(Debug, Clone)]
pub(crate) struct TomlPath<'a> {
    file: &'a Path,
    table: String,
}

impl<'a> TomlPath<'a> {
    /// The table `[name]`.
    pub fn table(file: &'a Path, name: &str) -> Self {
        Self { file, table: format!("[{name}]") }
    }

    /// The table number `index`, from 0, of the list `[[name]]`.
    pub fn entry(file: &'a Path, name: &str, index: usize) -> Self {
        Self { file, table: format!("[[{name}]] {}", index + 1) }
    }

    /// The value of `key` in this table is not what it should be.
    pub fn unexpected(&self, key: &str, found: impl Into<String>, expected: impl Into<String>) -> Error {
        Error::content(self.file, self.key(key), found, expected)
    }

    /// The place of `key` in this table.
    pub fn key(&self, key: &str) -> Place {
        Place::Key { table: self.table.clone(), key: key.to_owned() }
    }

    /// The value of `key` in SI, within `[low, high]`; `meaning` says what the bounds stand for.
    pub fn bounded(
        &self,
        key: &str,
        quantity: &Quantity,
        dimension: Dimension,
        (low, high): (f64, f64),
        meaning: &str,
    ) -> Result<f64, Error> {
        let value = self.finite(key, quantity, dimension)?;
        if (low..=high).contains(&value) { Ok(value) } else { Err(self.unexpected(key, quantity.to_string(), meaning)) }
    }

    /// The value of `key` in SI.
    pub fn finite(&self, key: &str, quantity: &Quantity, dimension: Dimension) -> Result<f64, Error> {
        quantity.si(dimension).map_err(|not| self.unexpected(key, not.found, not.expected))
    }

    /// The value of `key` in the SI unit of a parameter.
    pub fn of_parameter(&self, key: &str, quantity: &Quantity, parameter: &Parameter) -> Result<f64, Error> {
        in_parameter_unit(quantity, &parameter.unit, parameter.group)
            .map_err(|not| self.unexpected(key, not.found, not.expected))
    }

    /// A point of three coordinates [m], each of `most` or less: beyond it a unit was mistaken.
    pub fn point(&self, key: &str, point: &[Quantity; 3], most: f64) -> Result<[f64; 3], Error> {
        let meaning = format!("coordinates within {most} m (a number without a unit is in m)");
        let mut coordinates = [0.0; 3];
        for (coordinate, quantity) in coordinates.iter_mut().zip(point) {
            *coordinate = self.bounded(key, quantity, Dimension::Length, (-most, most), &meaning)?;
        }
        Ok(coordinates)
    }
}
