//! Units that a file names beside or below the names of its columns, held against those that the session states.

use std::path::Path;

use centrical_table::{TableReader, UnitsFound};

use super::columns::Column;
use crate::error::{Error, Place};
use crate::quantity::Dimension;

/// Names and units of columns as the session states them, until those of the file are known.
pub(crate) struct StatedUnits(Option<Vec<(String, String)>>);

impl StatedUnits {
    /// Names and units in the order of the values.
    pub fn new(columns: Vec<(String, String)>) -> Self {
        Self(Some(columns))
    }

    /// Those of columns.
    pub fn of<'a>(columns: impl IntoIterator<Item = &'a Column>) -> Self {
        Self::new(columns.into_iter().map(|column| (column.name.to_string(), column.unit.clone())).collect())
    }

    /// Sees, once, that the units of the file are the stated ones. A file contradicts nothing where it names no unit, or names one in
    /// words that are not understood.
    ///
    /// # Errors
    /// If the file names another unit.
    pub fn check(&mut self, file: &Path, table: &TableReader) -> Result<(), Error> {
        let (Some(stated), Some(UnitsFound { line, units })) = (self.0.take(), table.units()) else { return Ok(()) };
        for (found, (name, stated)) in units.iter().zip(stated) {
            let Some(found) = found.filter(|found| !stated.is_empty() && !is_same(found, &stated)) else { continue };
            let place = Place::Line { line, column: Some(name) };
            return Err(Error::content(file, place, format!("the unit {found}"), expected(&stated, found)));
        }
        Ok(())
    }
}

/// The stated unit, and where it is stated.
fn expected(stated: &str, found: &str) -> String {
    match stated {
        _ if Dimension::Time.factor(stated).is_some() || stated == "samples" => {
            format!("{stated}, as the session says ([columns]: time = {{ column = ..., unit = \"{found}\" }})")
        }
        _ if Dimension::Speed.factor(stated).is_some() => {
            format!("{stated}, as the session says (speed_unit in [columns])")
        }
        _ => format!("{stated}, as the session says (output_unit in [unit], or a unit in [columns])"),
    }
}

/// Whether two names are of one unit.
fn is_same(one: &str, other: &str) -> bool {
    const DIMENSIONS: [Dimension; 4] = [Dimension::Acceleration, Dimension::Time, Dimension::Speed, Dimension::Angle];
    let is_same =
        |dimension: Dimension| dimension.factor(one).is_some_and(|factor| dimension.factor(other) == Some(factor));
    one == other || DIMENSIONS.into_iter().any(is_same)
}
