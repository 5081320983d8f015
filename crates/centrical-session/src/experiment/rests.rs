//! Rests in free attitudes: the tables that a session names under `[[tumble]]`.
//!
//! A table of rests has the columns of a table of plateaus, a row for each rest. A table of attitudes says in the same row where up is
//! then, in axes of the case:
//!
//! | column | what |
//! |---|---|
//! | `up_1` .. `up_3` | the direction of the vertical, of any length; zero where it is unknown |

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use centrical::Position;
use centrical_table::{ColumnName, Extent, Field, Rule, TableReader, write_whole};
use nalgebra::Vector3;

use super::form::TumbleTable;
use super::plateaus::{PlateauMean, read_plateaus};
use super::toml_path::TomlPath;
use crate::error::{Error, Place};
use crate::quantity::Dimension;

/// Rests in free attitudes, averaged, in a table of their own.
#[derive(Debug, Clone, PartialEq)]
pub struct RestTable {
    /// The table of their means.
    pub file: PathBuf,
    /// Their means, each of a mounting of its own.
    pub means: Vec<PlateauMean>,
    /// What is known of their attitudes; `None` where only gravity shows them.
    pub attitudes: Option<KnownAttitudes>,
}

/// Attitudes of rests that are known beforehand.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownAttitudes {
    /// The table of attitudes.
    pub file: PathBuf,
    /// Standard uncertainty of each, about either horizontal axis [rad].
    pub uncertainty: f64,
    /// Where up is in each rest, axes of the case, of length 1; `None` where it is unknown.
    pub up_b: Vec<Option<Vector3<f64>>>,
}

impl RestTable {
    /// The tables of `[[tumble]]` in the experiment file `file`, not read yet.
    ///
    /// # Errors
    /// If one names a table of attitudes without their uncertainty, or the reverse.
    pub(crate) fn named(file: &Path, tables: &[TumbleTable]) -> Result<Vec<Self>, Error> {
        let folder = file.parent().unwrap_or(Path::new(""));
        let named = tables.iter().enumerate().map(|(n, table)| {
            let at = TomlPath::entry(file, "tumble", n);
            let attitudes = match (&table.attitudes, &table.attitude_uncertainty) {
                (None, None) => None,
                (Some(_), None) => {
                    let expected = "the standard uncertainty of the attitudes, such as \"0.1 deg\"";
                    return Err(at.unexpected("attitude_uncertainty", "no such key beside attitudes", expected));
                }
                (None, Some(_)) => {
                    let expected = "a table of the attitudes that are this uncertain";
                    return Err(at.unexpected("attitudes", "no such key beside attitude_uncertainty", expected));
                }
                (Some(attitudes), Some(uncertainty)) => {
                    let key = "attitude_uncertainty";
                    let bounds = (f64::MIN_POSITIVE, MOST_UNCERTAIN);
                    let meaning = "a standard uncertainty above 0 and up to 10 deg";
                    let uncertainty = at.bounded(key, uncertainty, Dimension::Angle, bounds, meaning)?;
                    Some(KnownAttitudes { file: folder.join(attitudes), uncertainty, up_b: Vec::new() })
                }
            };
            Ok(Self { file: folder.join(&table.rests), means: Vec::new(), attitudes })
        });
        named.collect()
    }

    /// Reads the means, and the attitudes where they are known.
    ///
    /// # Errors
    /// If a table can not be read, a rest has a speed, the tables differ in length, or the attitude of a row is not that of its rest.
    pub(crate) fn read(&mut self) -> Result<(), Error> {
        self.means = read_rests(&self.file)?;
        let Some(attitudes) = &mut self.attitudes else { return Ok(()) };
        attitudes.up_b = read_attitudes(&attitudes.file)?;
        if attitudes.up_b.len() != self.means.len() {
            let found = format!("{} rows", attitudes.up_b.len());
            let expected = format!("a row for each of the {} rests of {}", self.means.len(), self.file.display());
            return Err(Error::content(&attitudes.file, Place::Whole, found, expected));
        }
        let rows = (1..).zip(self.means.iter().zip(&attitudes.up_b));
        for (row, (rest, up_b)) in rows.filter_map(|(row, (rest, up_b))| Some((row, (rest, up_b.as_ref()?)))) {
            let angle = up_b.angle(&rest.mean);
            if angle > FARTHEST {
                let place = Place::Row { row, column: "up_1".to_owned() };
                let found = format!("an attitude {:.0} deg from that of the mean reading", angle.to_degrees());
                let expected = format!(
                    "the attitude of rest {row} of {}, in axes of the case that point about where the newtonometers do",
                    self.file.display()
                );
                return Err(Error::content(&attitudes.file, place, found, expected));
            }
        }
        Ok(())
    }

    /// The positions of the rests, numbered on from `first`. Where the vertical is, the attitude says, or else the mean.
    pub(crate) fn positions(&self, first: usize) -> impl Iterator<Item = Position> {
        (first..).zip(&self.means).enumerate().map(|(n, (number, rest))| {
            let id = format!("r{number}");
            let known =
                self.attitudes.as_ref().and_then(|known| Some((known.up_b.get(n).copied()??, known.uncertainty)));
            match known {
                Some((up_b, uncertainty)) => Position::known(id, &up_b, uncertainty),
                None => Position::free(id, &rest.mean),
            }
        })
    }

    /// The files of the table.
    pub fn files(&self) -> impl Iterator<Item = &PathBuf> {
        std::iter::once(&self.file).chain(self.attitudes.iter().map(|known| &known.file))
    }
}

/// Attitudes that are less certain than this say nothing that gravity does not [rad].
pub(crate) const MOST_UNCERTAIN: f64 = 10.0 * PI / 180.0;

/// Farthest angle between a known attitude and the one of its mean [rad]: beyond it rows are out of order.
const FARTHEST: f64 = PI / 6.0;

/// The rests of a table: each row is one, and none has a speed.
fn read_rests(table: &Path) -> Result<Vec<PlateauMean>, Error> {
    let rests = read_plateaus(table, usize::MAX)?;
    match (1..).zip(&rests).find(|(_, rest)| rest.speed != 0.0) {
        Some((row, rest)) => {
            let place = Place::Row { row, column: "speed".to_owned() };
            Err(Error::content(table, place, rest.speed.to_string(), "0 in a table of rests"))
        }
        None => Ok(rests),
    }
}

/// Directions in the columns `up_1`, `up_2`, `up_3` of a table, of length 1; `None` for a row of zeros.
///
/// # Errors
/// If the file can not be read, or lacks a column or a number.
pub(crate) fn read_attitudes(file: &Path) -> Result<Vec<Option<Vector3<f64>>>, Error> {
    let fields = UP.map(|name| Field {
        name: ColumnName::Name(name.to_owned()),
        expected: "a component of the direction of up".to_owned(),
        rule: Rule::Any,
    });
    let mut table = TableReader::open(file, Extent::Whole, &fields, "a table of attitudes")?;
    let mut rows = Vec::new();
    while table.next_batch()?.is_some() {
        for columns in table.batch() {
            rows.extend((0..columns[0].len()).map(|row| Vector3::from_fn(|axis, _| columns[axis][row])));
        }
    }
    let direction = |up_b: Vector3<f64>| {
        // The squares of the components neither overflow nor vanish.
        let length = up_b.amax();
        // A direction that was written with length 1 is read again to its last digit.
        let is_unit = (up_b.norm() - 1.0).abs() < 1e-15;
        (length > 0.0).then(|| if is_unit { up_b } else { (up_b / length).normalize() })
    };
    Ok(rows.into_iter().map(direction).collect())
}

/// Writes a table of attitudes, every number to its last digit; the file appears whole or not at all.
///
/// # Errors
/// If the file can not be written.
pub(crate) fn write_attitudes(file: &Path, up_b: &[Option<Vector3<f64>>]) -> Result<(), Error> {
    let mut text = format!("{}\n", UP.join(","));
    for up_b in up_b {
        // Writing to a String does not fail.
        let _ = match up_b {
            Some(up_b) => writeln!(text, "{},{},{}", up_b.x, up_b.y, up_b.z),
            None => writeln!(text, "0,0,0"),
        };
    }
    Ok(write_whole(file, text.as_bytes())?)
}

/// Columns of a table of attitudes.
const UP: [&str; 3] = ["up_1", "up_2", "up_3"];
