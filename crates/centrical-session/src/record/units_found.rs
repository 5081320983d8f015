//! Units that a file names beside or below the names of its columns, held against those that the session states.

use std::path::Path;

use centrical_table::UnitsFound;

use crate::error::{Error, Place};
use crate::quantity::Dimension;

/// Sees that the units of a file are those of the columns, each a name and a unit. What the file does not say, or says in words that
/// are not understood, is no contradiction.
pub(crate) fn check_units<'a>(
    file: &Path,
    found: Option<&UnitsFound>,
    columns: impl Iterator<Item = (String, &'a str)>,
) -> Result<(), Error> {
    let Some(UnitsFound { line, units }) = found else { return Ok(()) };
    for (found, (name, stated)) in units.iter().zip(columns) {
        let Some(found) = found.filter(|found| !stated.is_empty() && !is_same(found, stated)) else { continue };
        let place = Place::Line { line: *line, column: Some(name) };
        let expected = match stated {
            _ if Dimension::Time.factor(stated).is_some() || stated == "samples" => {
                format!("{stated}, as the session says ([columns]: time = {{ column = ..., unit = \"{found}\" }})")
            }
            _ if Dimension::Speed.factor(stated).is_some() => {
                format!("{stated}, as the session says (speed_unit in [columns])")
            }
            _ => format!("{stated}, as the session says (output_unit in [unit], or a unit in [columns])"),
        };
        return Err(Error::content(file, place, format!("the unit {found}"), expected));
    }
    Ok(())
}

/// Whether two names are of one unit.
fn is_same(one: &str, other: &str) -> bool {
    const DIMENSIONS: [Dimension; 4] = [Dimension::Acceleration, Dimension::Time, Dimension::Speed, Dimension::Angle];
    let is_same =
        |dimension: Dimension| dimension.factor(one).is_some_and(|factor| dimension.factor(other) == Some(factor));
    one == other || DIMENSIONS.into_iter().any(is_same)
}
