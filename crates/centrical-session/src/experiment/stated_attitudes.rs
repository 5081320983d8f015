//! Attitudes of rests as a laboratory states them: a list, a table or the directions of a cube, and which of them each rest is in.
//!
//! A table of attitudes says where up is, in axes of the case:
//!
//! | column | what |
//! |---|---|
//! | `up_1` .. `up_3` | the direction of the vertical, of any length; zero where it is unknown |

use std::cmp::Reverse;
use std::f64::consts::PI;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use centrical::observability::cube_directions;
use centrical::reduction::Mistake;
use centrical_table::{ColumnName, Extent, Field, Rule, Source, TableLines, TableReader, write_whole};
use nalgebra::Vector3;

use super::folder::Folder;
use super::form::AttitudeList;
use super::toml_path::TomlPath;
use crate::error::{Error, Place};

/// Attitudes in which a laboratory lays a unit down, by a table or the faces of a cube, in any order and as often as it likes.
#[derive(Debug, Clone, PartialEq)]
pub struct StatedAttitudes {
    /// Where up is, axes of the case, of length 1.
    pub up_b: Vec<Vector3<f64>>,
    /// Standard uncertainty of each, about either horizontal axis [rad].
    pub uncertainty: f64,
    /// The file that they were read from.
    pub file: Option<PathBuf>,
}

impl StatedAttitudes {
    /// The attitudes of `name`: the faces, edges and corners of a cube for `cube`, or else the rows of a table with the columns `up_1`,
    /// `up_2`, `up_3`.
    ///
    /// # Errors
    /// If the file can not be read, lacks a column, or has no row or one without a direction.
    pub fn named(name: &Path, uncertainty: f64) -> Result<Self, Error> {
        if name.as_os_str() == CUBE {
            return Ok(Self { up_b: cube_directions(), uncertainty, file: None });
        }
        Ok(Self { up_b: read_directions(&Source::open(name, ATTITUDES)?)?, uncertainty, file: Some(name.to_owned()) })
    }

    /// The attitude of each rest of these mean forces: the nearest one, if it is nearer than any other could be. A rest beside all of
    /// them keeps a free attitude.
    ///
    /// # Errors
    /// If the uncertainty makes no sense, or no rest is in any of the attitudes; messages name `record` where no file states them.
    pub(crate) fn of_rests(&self, means: &[Vector3<f64>], record: &Path) -> Result<Vec<Option<Vector3<f64>>>, Error> {
        let file = self.file.as_deref().unwrap_or(record);
        if !(LEAST_UNCERTAIN..=MOST_UNCERTAIN).contains(&self.uncertainty) {
            let found = format!("attitudes uncertain by {} rad", self.uncertainty);
            return Err(Error::content(file, Place::Whole, found, "a standard uncertainty of 1e-12 rad to 10 deg"));
        }
        let within = NEAR.min(0.5 * self.smallest_angle());
        let attitudes: Vec<_> = means.iter().map(|mean| nearest(&self.up_b, mean, within)).collect();
        if let Some(found) = self.by_other_columns(means, within) {
            let expected =
                "columns in the order and with the signs of the axes of the case, or attitudes in which the unit rests";
            return Err(Error::content(file, Place::Whole, found, expected));
        }
        if attitudes.iter().all(Option::is_none) {
            let found = format!(
                "{} attitudes, none of them within {:.0} deg of any of the {} rests",
                self.up_b.len(),
                within.to_degrees(),
                means.len()
            );
            let expected = "up in axes of the case that point about where the newtonometers do";
            return Err(Error::content(file, Place::Whole, found, expected));
        }
        Ok(attitudes)
    }

    /// How other signs or another order of the columns explain the rests decisively better: `k` more of them are in an attitude, with the odds
    /// `(9 / q)^k` where by chance a share `q` is, and a tenth of all rests beside the attitudes.
    fn by_other_columns(&self, means: &[Vector3<f64>], within: f64) -> Option<String> {
        /// Odds of such a mistake against none.
        const ODDS: f64 = 1e-6;
        /// So many rests show a mistake as well as all.
        const LOOKED_AT: usize = 200;
        let means = &means[..means.len().min(LOOKED_AT)];
        let in_attitude = |up: &[Vector3<f64>]| means.iter().filter(|mean| nearest(up, mean, within).is_some()).count();
        let by_mistake = |mistake: Mistake| {
            let up: Vec<_> = self.up_b.iter().map(|up| mistake.reading(up)).collect();
            (mistake, in_attitude(&up))
        };
        let as_they_are = in_attitude(&self.up_b);
        let (mistake, count) = Mistake::of_columns().map(by_mistake).min_by_key(|(_, count)| Reverse(*count))?;
        let by_chance = self.up_b.len() as f64 * 0.5 * (1.0 - within.cos());
        let odds = (9.0 / by_chance).powf(count as f64 - as_they_are as f64) * ODDS;
        let rests = means.len();
        (odds > 1.0).then(|| {
            format!("{as_they_are} of {rests} rests in one of these attitudes, and {count} of {rests} with {mistake}")
        })
    }

    /// Smallest angle between two attitudes that are not the same one [rad].
    fn smallest_angle(&self) -> f64 {
        let pairs = self.up_b.iter().enumerate().flat_map(|(n, a)| self.up_b[..n].iter().map(|b| a.angle(b)));
        pairs.filter(|angle| *angle > SAME).fold(PI, f64::min)
    }
}

/// The attitude of `up` nearest to a mean, if it is within that angle [rad].
fn nearest(up: &[Vector3<f64>], mean: &Vector3<f64>, within: f64) -> Option<Vector3<f64>> {
    let near = up.iter().min_by(|a, b| a.angle(mean).total_cmp(&b.angle(mean)))?;
    (near.angle(mean) < within).then_some(*near)
}

/// No table shows attitudes better than this [rad]; far below it the fit loses its digits.
pub(crate) const LEAST_UNCERTAIN: f64 = 1e-12;

/// Attitudes that are less certain than this say nothing that gravity does not [rad].
pub(crate) const MOST_UNCERTAIN: f64 = 10.0 * PI / 180.0;

/// Farthest a rest may be from its attitude [rad]: the newtonometers' axes against the case, and errors before calibration.
const NEAR: f64 = 10.0 * PI / 180.0;

/// Attitudes closer than this are one, written twice [rad].
const SAME: f64 = 1e-3;

/// Directions of up as the key `attitudes` has them, of length 1, and the file that they stand in. Paths start from `folder`.
///
/// # Errors
/// If a listed direction is invalid; for the file as [`StatedAttitudes::named`].
pub(crate) fn directions(
    at: &TomlPath,
    folder: &Folder,
    entry: &AttitudeList,
) -> Result<(Vec<Vector3<f64>>, Option<PathBuf>), Error> {
    let listed = match entry {
        AttitudeList::Named(name) if name == CUBE => return Ok((cube_directions(), None)),
        AttitudeList::Named(name) => {
            let file = folder.join(name);
            return Ok((read_directions(&folder.open_kept(&file, ATTITUDES)?)?, Some(file)));
        }
        AttitudeList::Listed(listed) => listed,
    };
    if listed.is_empty() {
        return Err(at.unexpected("attitudes", "an empty list", "a direction of up for each rest"));
    }
    let direction = |up_b: &[f64; 3]| {
        let found = || format!("{up_b:?}");
        direction(Vector3::from(*up_b)).ok_or_else(|| at.unexpected("attitudes", found(), "the direction of up"))
    };
    Ok((listed.iter().map(direction).collect::<Result<_, _>>()?, None))
}

/// The rows of a table of attitudes, each with a direction.
fn read_directions(table: &Source) -> Result<Vec<Vector3<f64>>, Error> {
    let file = table.name();
    let no_direction = |row: u64| {
        let place = Place::Row { row, column: UP[0].to_owned() };
        Error::content(file, place, "a row of zeros", "the direction of up")
    };
    let rows = (1..).zip(read_attitudes(table)?).map(|(row, up_b)| up_b.ok_or_else(|| no_direction(row)));
    let up_b: Vec<Vector3<f64>> = rows.collect::<Result<_, _>>()?;
    if up_b.is_empty() {
        return Err(Error::content(file, Place::Whole, "no attitude", "a row for each attitude"));
    }
    Ok(up_b)
}

/// Directions in the columns `up_1`, `up_2`, `up_3` of a table, of length 1; `None` for a row of zeros.
///
/// # Errors
/// If it can not be read, or lacks a column or a number.
pub(crate) fn read_attitudes(table: &Source) -> Result<Vec<Option<Vector3<f64>>>, Error> {
    let fields = UP.map(|name| Field {
        name: ColumnName::Name(name.to_owned()),
        expected: "a component of the direction of up".to_owned(),
        rule: Rule::Any,
    });
    let mut table = TableReader::new(table.clone(), Extent::Whole, &fields, ATTITUDES, TableLines::default())?;
    let mut rows = Vec::new();
    while table.next_batch()?.is_some() {
        for columns in table.batch() {
            rows.extend((0..columns[0].len()).map(|row| Vector3::from_fn(|axis, _| columns[axis][row])));
        }
    }
    Ok(rows.into_iter().map(direction).collect())
}

/// A direction with length 1; `None` of zeros, or of numbers that are not finite.
fn direction(up_b: Vector3<f64>) -> Option<Vector3<f64>> {
    // The squares of the components neither overflow nor vanish.
    let length = up_b.amax();
    // A direction that was written with length 1 is read again to its last digit.
    let is_unit = (up_b.norm() - 1.0).abs() < 1e-15;
    let is_direction = length > 0.0 && up_b.iter().all(|component| component.is_finite());
    is_direction.then(|| if is_unit { up_b } else { (up_b / length).normalize() })
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

/// The name of the faces, edges and corners of a cube.
pub(crate) const CUBE: &str = "cube";

/// What a table of attitudes is expected to be.
pub(super) const ATTITUDES: &str = "a table of attitudes";

/// Columns of a table of attitudes.
const UP: [&str; 3] = ["up_1", "up_2", "up_3"];

/// Standard uncertainty of the attitude of each rest as an independent one, over that which is stated: of rests in the attitudes `up_b`, `None`
/// where they are unknown, with these mean forces.
///
/// What a face of a cube or a mark of a table is off by, all rests on it share. What a hand lays down differently, each has for itself, and their
/// readings show it: they turn by as much across the force. Of a stated variance `u^2` the part `1 - s^2 / u^2` is common where the directions of
/// rests in one attitude scatter by `s` about either horizontal axis. The mean of `m` such rests has the variance `u^2 (1 + (m - 1) c) / m`
/// with that part `c`. As independent ones with `u^2 (1 + (m - 1) c)` each, they leave the same.
pub(super) fn as_independent(up_b: &[Option<Vector3<f64>>], means: &[Vector3<f64>], uncertainty: f64) -> Vec<f64> {
    let mut groups: Vec<(Vector3<f64>, Vec<usize>)> = Vec::new();
    for (rest, up_b) in up_b.iter().enumerate().take(means.len()) {
        let Some(up_b) = up_b else { continue };
        match groups.iter_mut().find(|(known, _)| known == up_b) {
            Some((_, rests)) => rests.push(rest),
            None => groups.push((*up_b, vec![rest])),
        }
    }
    let (mut squares, mut freedom) = (0.0, 0);
    for (_, rests) in &groups {
        let directions: Vec<Vector3<f64>> = rests.iter().map(|rest| means[*rest].normalize()).collect();
        let middle = directions.iter().sum::<Vector3<f64>>() / directions.len() as f64;
        squares += directions.iter().map(|direction| (direction - middle).norm_squared()).sum::<f64>();
        freedom += 2 * (rests.len() - 1);
    }
    let mut factors = vec![1.0; up_b.len()];
    if freedom > 0 {
        let common = (1.0 - squares / freedom as f64 / (uncertainty * uncertainty)).clamp(0.0, 1.0);
        for (_, rests) in groups {
            let factor = (1.0 + (rests.len() - 1) as f64 * common).sqrt();
            for rest in rests {
                factors[rest] = factor;
            }
        }
    }
    factors
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rests that lie alike share all that is stated of their attitude; those that scatter by it share nothing.
    #[test]
    fn rests_that_lie_alike_share_their_error() {
        let up = [Some(Vector3::z()), Some(Vector3::x()), Some(Vector3::z()), None];
        let alike = [Vector3::z() * 9.8, Vector3::x() * 9.8, Vector3::z() * 9.81, Vector3::y()];
        assert_eq!(as_independent(&up, &alike, 1e-3), [2_f64.sqrt(), 1.0, 2_f64.sqrt(), 1.0]);
        let apart = [Vector3::new(2e-2, 0.0, 9.8), alike[1], Vector3::new(-2e-2, 1e-2, 9.8), alike[3]];
        assert_eq!(as_independent(&up, &apart, 1e-3), [1.0; 4]);
        assert_eq!(as_independent(&up, &[], 1e-3), [1.0; 4]);
    }
}
