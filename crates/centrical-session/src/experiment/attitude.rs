//! Positions: `axes` or `matrix` into `P_k`, and the pairs.

use std::path::Path;

use centrical::{PairRelation, Position, is_rotation};
use centrical_table::harmless_line;
use nalgebra::Matrix3;

use super::form::PositionTable;
use super::toml_path::TomlPath;
use crate::error::{Error, quoted};

/// Characters of a name: it stands in the names of parameters.
const LONGEST_NAME: usize = 100;

/// What a text should be, unless it can be part of the name of a parameter, `delta_1[name]`.
fn expected_of_name(text: &str) -> Option<String> {
    if text.is_empty() {
        Some("a name".to_owned())
    } else if text.contains(['[', ']']) {
        Some("a name without brackets".to_owned())
    } else if harmless_line(text) != text {
        Some("a name of characters that are shown".to_owned())
    } else {
        (text.chars().count() > LONGEST_NAME).then(|| format!("a name of at most {LONGEST_NAME} characters"))
    }
}

/// The positions in the order of the file. There has to be one, if `needs_one`.
pub(crate) fn positions(
    file: &Path,
    tables: &[PositionTable],
    relation: PairRelation,
    needs_one: bool,
) -> Result<Vec<Position>, Error> {
    if tables.is_empty() && needs_one {
        let place = TomlPath::entry(file, "position", 0);
        return Err(place.unexpected("id", "no [[position]]", "at least one position"));
    }
    let mut positions: Vec<Position> = Vec::with_capacity(tables.len());
    for (k, table) in tables.iter().enumerate() {
        let at = TomlPath::entry(file, "position", k);
        if let Some(expected) = expected_of_name(&table.id) {
            return Err(at.unexpected("id", quoted(table.id.as_bytes()), expected));
        }
        if positions.iter().any(|p| p.id == table.id) {
            return Err(at.unexpected("id", format!("{:?} a second time", table.id), "an id of its own"));
        }
        let pair = table.pair.clone().unwrap_or_else(|| table.id.clone());
        positions.push(Position::on_arm(&table.id, attitude(&at, table)?, pair));
    }
    check_pairs(file, tables, relation)?;
    Ok(positions)
}

/// `P_k` from whichever of `axes` and `matrix` is given.
fn attitude(at: &TomlPath, table: &PositionTable) -> Result<Matrix3<f64>, Error> {
    match (&table.axes, &table.matrix) {
        (Some(axes), None) => from_axes(at, axes),
        (None, Some(rows)) => from_rows(at, rows),
        (None, None) => Err(at.unexpected("axes", "neither axes nor matrix", "one of them")),
        (Some(_), Some(_)) => Err(at.unexpected("matrix", "both axes and matrix", "one of them")),
    }
}

/// `"+2 -3 -1"`: instrument axes 1, 2, 3 point along `+y2`, `-y3`, `-y1`.
fn from_axes(at: &TomlPath, axes: &str) -> Result<Matrix3<f64>, Error> {
    let wrong = |why: &str| {
        let expected = format!("a signed arm axis for each instrument axis such as \"+2 -3 -1\"{why}");
        at.unexpected("axes", quoted(axes.as_bytes()), expected)
    };
    let words: Vec<&str> = axes.split_whitespace().collect();
    if words.len() != 3 {
        return Err(wrong(""));
    }
    let mut p_zy = Matrix3::zeros();
    for (row, word) in words.into_iter().enumerate() {
        let (sign, axis) = match word.strip_prefix('-') {
            Some(axis) => (-1.0, axis),
            None => (1.0, word.strip_prefix('+').unwrap_or(word)),
        };
        let column = ["1", "2", "3"].iter().position(|name| *name == axis).ok_or_else(|| wrong(""))?;
        p_zy[(row, column)] = sign;
    }
    // Entries are 0 and +-1, so the determinant is exact.
    match p_zy.determinant() {
        1.0 => Ok(p_zy),
        -1.0 => Err(wrong(" that is right-handed (this one is left-handed)")),
        _ => Err(wrong(" with every arm axis once")),
    }
}

/// The text that [`from_axes`] reads: the arm axis from 0 along which each instrument axis points, and its sign.
pub(crate) fn axes_text(along: &[(usize, f64); 3]) -> String {
    along.map(|(axis, sign)| format!("{}{}", if sign > 0.0 { '+' } else { '-' }, axis + 1)).join(" ")
}

/// `P_k` by its rows: the instrument axes in the arm frame.
fn from_rows(at: &TomlPath, rows: &[[f64; 3]; 3]) -> Result<Matrix3<f64>, Error> {
    let p_zy = Matrix3::from_fn(|i, j| rows[i][j]);
    if is_rotation(&p_zy) {
        return Ok(p_zy);
    }
    let found = format!("{rows:?}");
    let handed = if is_rotation(&-p_zy) { " (this one is left-handed)" } else { "" };
    let expected = format!("a right-handed rotation, its rows orthonormal to nine digits{handed}");
    Err(at.unexpected("matrix", found, expected))
}

/// A position without a pair is a pair of its own, whose name no other pair may have; the printed relation
/// `dR` of the second `= -dR` of the first says nothing about a third.
fn check_pairs(file: &Path, tables: &[PositionTable], relation: PairRelation) -> Result<(), Error> {
    for (k, table) in tables.iter().enumerate() {
        let at = TomlPath::entry(file, "position", k);
        let of_pair = |name: &str| tables[..k].iter().filter(|t| t.pair.as_deref() == Some(name)).count();
        match &table.pair {
            Some(pair) if relation == PairRelation::Opposite && of_pair(pair) == 2 => {
                let found = format!("a third position in pair {pair:?}");
                return Err(at.unexpected("pair", found, "two at most with pair_relation = \"opposite\""));
            }
            None if tables.iter().any(|t| t.pair.as_ref() == Some(&table.id)) => {
                let found = format!("no pair, and another pair named {:?} as this position", table.id);
                return Err(at.unexpected("pair", found, "a name for this position's pair"));
            }
            _ => {}
        }
    }
    Ok(())
}
