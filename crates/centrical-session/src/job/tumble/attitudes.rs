//! Which of the stated attitudes each rest is in.

use std::path::{Path, PathBuf};

use centrical::observability::cube_directions;
use nalgebra::Vector3;

use crate::error::{Error, Place};
use crate::experiment::{MOST_UNCERTAIN, read_attitudes};

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
        if name.as_os_str() == "cube" {
            return Ok(Self { up_b: cube_directions(), uncertainty, file: None });
        }
        Self::read(name, uncertainty)
    }

    fn read(file: &Path, uncertainty: f64) -> Result<Self, Error> {
        let no_direction = |row: u64| {
            let place = Place::Row { row, column: "up_1".to_owned() };
            Error::content(file, place, "a row of zeros", "the direction of up")
        };
        let rows = (1..).zip(read_attitudes(file)?).map(|(row, up_b)| up_b.ok_or_else(|| no_direction(row)));
        let up_b: Vec<Vector3<f64>> = rows.collect::<Result<_, _>>()?;
        if up_b.is_empty() {
            return Err(Error::content(file, Place::Whole, "no attitude", "a row for each attitude"));
        }
        Ok(Self { up_b, uncertainty, file: Some(file.to_owned()) })
    }

    /// The attitude of each rest of these mean forces: the nearest one, if it is nearer than any other could be. A rest beside all of
    /// them keeps a free attitude.
    ///
    /// # Errors
    /// If the uncertainty makes no sense, or no rest is in any of the attitudes; messages name `record` where no file states them.
    pub(super) fn of_rests(&self, means: &[Vector3<f64>], record: &Path) -> Result<Vec<Option<Vector3<f64>>>, Error> {
        let file = self.file.as_deref().unwrap_or(record);
        if !(self.uncertainty > 0.0 && self.uncertainty <= MOST_UNCERTAIN) {
            let found = format!("attitudes uncertain by {} rad", self.uncertainty);
            return Err(Error::content(file, Place::Whole, found, "a standard uncertainty above 0 and up to 10 deg"));
        }
        let within = NEAR.min(0.5 * self.smallest_angle());
        let nearest = |mean: &Vector3<f64>| {
            let near = self.up_b.iter().min_by(|a, b| a.angle(mean).total_cmp(&b.angle(mean)))?;
            (near.angle(mean) < within).then_some(*near)
        };
        let attitudes: Vec<_> = means.iter().map(nearest).collect();
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

    /// Smallest angle between two attitudes that are not the same one [rad].
    fn smallest_angle(&self) -> f64 {
        let pairs = self.up_b.iter().enumerate().flat_map(|(n, a)| self.up_b[..n].iter().map(|b| a.angle(b)));
        pairs.filter(|angle| *angle > SAME).fold(std::f64::consts::PI, f64::min)
    }
}

/// Farthest a rest may be from its attitude [rad]: the newtonometers' axes against the case, and errors before calibration.
const NEAR: f64 = 10.0 * std::f64::consts::PI / 180.0;

/// Attitudes closer than this are one, written twice [rad].
const SAME: f64 = 1e-3;
