//! Tables of plateaus already averaged: `plateaus.csv`, one row per plateau.
//!
//! | column | what |
//! |---|---|
//! | `mounting` | number of the mounting in the experiment file, from 1 |
//! | `speed` | speed [rad/s], positive in the default sense of rotation, 0 at rest |
//! | `angle` | carousel angle [rad] at rest; empty while spinning |
//! | `mean_1` .. `mean_3` | mean readings [m/s^2] |
//! | `cov_11`, `cov_12`, `cov_13`, `cov_22`, `cov_23`, `cov_33` | covariance of the means [m^2/s^4] |
//! | `samples` | how many samples were averaged |
//! | `speed_uncertainty` | relative standard uncertainty of `speed`, in a session whose plateaus state measured speeds |
//! | `bend_1` .. `bend_3` | second derivative of the vertical in instrument axes [1/s^2], in a table of rests with arcs of slow rotation |

use std::collections::HashMap;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use centrical::{Experiment, Observation, Rotation, STANDARD_GRAVITY, SetPoint};
use centrical_table::{ColumnName, Extent, Field, Rule, Source, TableLines};
use nalgebra::{Matrix3, Vector3};

use super::folder::Folder;
use super::schedule::FASTEST;
use crate::error::{Error, Place};
use crate::record::{CheckedTable, StatedUnits, TableForm};

/// The mean readings of one plateau.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlateauRow {
    /// Index of its mounting, from 0.
    pub mounting: usize,
    /// Speed [rad/s], positive in the default sense of rotation; 0 at rest.
    pub speed: f64,
    /// Relative standard uncertainty of a speed that was measured.
    pub speed_uncertainty: Option<f64>,
    /// Carousel angle at rest [rad]; 0 while spinning, where it has no meaning.
    pub angle: f64,
    /// Mean readings of newtonometers 1, 2, 3 [m/s^2].
    pub mean: Vector3<f64>,
    /// Covariance of the means [m^2/s^4].
    pub covariance: Matrix3<f64>,
    /// How many samples were averaged.
    pub samples: u64,
    /// Mean second derivative of the vertical, instrument axes [1/s^2], of an arc of slow rotation among rests; zero of a rest among them.
    pub bend_z: Option<Vector3<f64>>,
}

/// Plateaus already averaged.
#[derive(Debug, Clone, PartialEq)]
pub struct PlateauTable {
    /// The file; `None` for a table in memory.
    pub file: Option<PathBuf>,
    /// One row for each of the experiment's set points, in the same order.
    pub rows: Vec<PlateauRow>,
}

impl PlateauRow {
    /// The mean as data of a fit, of that set point.
    pub(crate) fn observation(&self, set_point: usize) -> Observation {
        Observation { set_point, mean: self.mean, covariance: self.covariance }
    }

    /// Its row: the numbers of the columns, NaN for an empty field.
    pub(super) fn numbers(&self, further: Further) -> Vec<f64> {
        let angle = if self.speed == 0.0 { self.angle } else { f64::NAN };
        let (c, [m1, m2, m3]) = (&self.covariance, self.mean.into());
        let number = (self.mounting + 1) as f64;
        let row =
            [number, self.speed, angle, m1, m2, m3, c.m11, c.m12, c.m13, c.m22, c.m23, c.m33, self.samples as f64];
        let [b1, b2, b3] = self.bend_z.unwrap_or_default().into();
        let more = match further {
            Further::Nothing => Vec::new(),
            Further::Speeds => vec![self.speed_uncertainty.unwrap_or(f64::NAN)],
            Further::Bends => vec![b1, b2, b3],
        };
        [row.to_vec(), more].concat()
    }
}

impl PlateauTable {
    /// Reads the table of that name and sorts it by mounting, keeping the order within each.
    pub(crate) fn read(folder: &Folder, name: &str, mountings: usize, has_speeds: bool) -> Result<Self, Error> {
        let file = folder.join(name);
        let table = folder.open_kept(&file, PLATEAUS)?;
        let further = if has_speeds { Further::Speeds } else { Further::Nothing };
        let mut rows = plateaus_of(&table, mountings, further)?;
        rows.sort_by_key(|row| row.mounting);
        Ok(Self { file: Some(file), rows })
    }

    /// The table of columns in memory, in the order of [`PlateauTable::columns`]; the last may be absent. Messages name `file`.
    pub(crate) fn in_memory(file: &Path, columns: &[Vec<f64>], mountings: usize) -> Result<Self, Error> {
        let (count, length) = (columns.len(), columns.first().map_or(0, Vec::len));
        if !(COLUMNS.len()..=COLUMNS.len() + 1).contains(&count) || columns.iter().any(|column| column.len() != length)
        {
            let lengths: Vec<usize> = columns.iter().map(Vec::len).collect();
            let expected = format!("{} columns of equal lengths, and perhaps {}", COLUMNS.len(), SPEED_UNCERTAINTY.0);
            return Err(Error::content(
                file,
                Place::Whole,
                format!("plateaus in columns of {lengths:?} rows"),
                expected,
            ));
        }
        let rows: Vec<Row> = (0..length).map(|row| row_of(columns, row)).collect();
        let mut rows = checked(file, &rows, mountings, Further::Speeds)?;
        rows.sort_by_key(|row| row.mounting);
        Ok(Self { file: None, rows })
    }

    /// Names of the columns.
    pub fn columns() -> impl Iterator<Item = &'static str> {
        COLUMNS.into_iter().chain([SPEED_UNCERTAINTY]).map(|(name, _)| name)
    }

    /// Refuses means that no error of a unit explains: farther from the nominal reading than ten times the largest one of the session. Messages
    /// name `file`.
    pub(crate) fn check_means(&self, file: &Path, experiment: &Experiment) -> Result<(), Error> {
        let nominal: Vec<_> = experiment.set_points.iter().map(|s| experiment.nominal(s)).collect();
        self.refuse_speeds(file, &nominal)?;
        let most = BEYOND * nominal.iter().map(Vector3::amax).fold(STANDARD_GRAVITY, f64::max);
        for (n, (row, nominal)) in self.rows.iter().zip(&nominal).enumerate() {
            let far = (0..3).find(|&axis| (row.mean[axis] - nominal[axis]).abs() > most);
            if let Some(axis) = far {
                let place = self.rows[..n].iter().filter(|other| other.mounting == row.mounting).count() + 1;
                let found = format!(
                    "{} m/s^2 as {} of plateau {}:{place}, where {:.4} is nominal",
                    row.mean[axis],
                    COLUMNS[MEAN + axis].0,
                    row.mounting + 1,
                    nominal[axis]
                );
                let file = self.file.as_deref().unwrap_or(file);
                return Err(Error::content(file, Place::Whole, found, format!("a mean within {most:.0} m/s^2 of it")));
            }
        }
        Ok(())
    }

    /// Refuses speeds in another unit: the largest nominal reading, which goes as their square, is that of another unit's factor.
    fn refuse_speeds(&self, file: &Path, nominal: &[Vector3<f64>]) -> Result<(), Error> {
        let both = self.rows.iter().zip(nominal);
        let Some((row, nominal)) = both.max_by(|(_, a), (_, b)| a.amax().total_cmp(&b.amax())) else { return Ok(()) };
        let share = row.mean.dot(nominal) / nominal.norm_squared();
        let is_near = |factor: f64| (share / (factor * factor) - 1.0).abs() < LARGEST_SCALE_ERROR;
        let Some((unit, _)) = OTHER_SPEEDS.iter().find(|(_, factor)| row.speed != 0.0 && is_near(*factor)) else {
            return Ok(());
        };
        let found = format!(
            "a speed of {} in mounting {}, whose mean of {:.6} m/s^2 fits a speed in {unit}",
            row.speed,
            row.mounting + 1,
            row.mean[nominal.iamax()]
        );
        let file = self.file.as_deref().unwrap_or(file);
        Err(Error::content(file, Place::Whole, found, "speeds in rad/s"))
    }

    pub(crate) fn set_points(&self, rotation: Rotation) -> Vec<SetPoint> {
        let set_point = |p: &PlateauRow| SetPoint {
            mounting: p.mounting,
            omega: rotation.sign() * p.speed + 0.0,
            angle: p.angle,
            speed_uncertainty: p.speed_uncertainty,
            ..SetPoint::default()
        };
        self.rows.iter().map(set_point).collect()
    }
}

/// The columns and what each holds.
const COLUMNS: [(&str, &str); 13] = [
    ("mounting", "the number of a mounting"),
    ("speed", "a speed in rad/s"),
    ("angle", "an angle in rad"),
    ("mean_1", "a mean in m/s^2"),
    ("mean_2", "a mean in m/s^2"),
    ("mean_3", "a mean in m/s^2"),
    ("cov_11", "a covariance in m^2/s^4"),
    ("cov_12", "a covariance in m^2/s^4"),
    ("cov_13", "a covariance in m^2/s^4"),
    ("cov_22", "a covariance in m^2/s^4"),
    ("cov_23", "a covariance in m^2/s^4"),
    ("cov_33", "a covariance in m^2/s^4"),
    ("samples", "how many samples were averaged"),
];

/// The further column of a table whose speeds are measured.
const SPEED_UNCERTAINTY: (&str, &str) = ("speed_uncertainty", "a relative standard uncertainty");

/// The further columns of a table of rests with arcs of slow rotation.
const BEND: [(&str, &str); 3] = [
    ("bend_1", "a second derivative of the vertical"),
    ("bend_2", "a second derivative of the vertical"),
    ("bend_3", "a second derivative of the vertical"),
];

/// What a table has beside the columns of all.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Further {
    Nothing,
    /// The uncertainty of each speed.
    Speeds,
    /// The bend of the way in each arc of slow rotation.
    Bends,
}

impl Further {
    /// What these plateaus have.
    pub fn of(plateaus: &[PlateauRow]) -> Self {
        let has = |what: fn(&PlateauRow) -> bool| plateaus.iter().any(what);
        if has(|p| p.speed_uncertainty.is_some()) {
            Self::Speeds
        } else if has(|p| p.bend_z.is_some()) {
            Self::Bends
        } else {
            Self::Nothing
        }
    }

    /// Names of all columns.
    pub fn names(self) -> Vec<&'static str> {
        COLUMNS.iter().chain(self.columns()).map(|(name, _)| *name).collect()
    }

    fn columns(self) -> &'static [(&'static str, &'static str)] {
        match self {
            Self::Nothing => &[],
            Self::Speeds => &[SPEED_UNCERTAINTY],
            Self::Bends => &BEND,
        }
    }
}

/// Whether the numbers of a column are far below 1.
pub(super) fn is_small(column: usize) -> bool {
    (COVARIANCE..SAMPLES).contains(&column) || column > SAMPLES
}

/// A mean reading is wrong if it is off by this factor of the largest nominal one.
const BEYOND: f64 = 10.0;

/// Units in which a speed may stand in place of rad/s, each in rad/s.
const OTHER_SPEEDS: [(&str, f64); 3] = [("rpm", TAU / 60.0), ("rev/s", TAU), ("deg/s", TAU / 360.0)];

/// Largest error of a scale that a unit may have: a nominal scale is known better.
pub(crate) const LARGEST_SCALE_ERROR: f64 = 0.3;

/// Place of `mean_1` among the columns.
const MEAN: usize = 3;

/// Place of `angle` among the columns.
const ANGLE: usize = 2;

/// Place of `cov_11` among the columns.
const COVARIANCE: usize = 6;

/// Place of `samples` among the columns, the last that every table has.
const SAMPLES: usize = COLUMNS.len() - 1;

/// What a table of plateaus is expected to be.
pub(super) const PLATEAUS: &str = "a table of plateaus";

/// Reads a table with these further columns for a session of that many mountings.
///
/// # Errors
/// If the file can not be read or lacks a column; if a row names no mounting, rests without an angle, or has a
/// covariance that is not positive definite.
pub(super) fn plateaus_of(source: &Source, mountings: usize, further: Further) -> Result<Vec<PlateauRow>, Error> {
    let columns: Vec<_> = COLUMNS.iter().chain(further.columns()).collect();
    let field = |(k, (name, expected)): (usize, &&(&str, &str))| Field {
        name: ColumnName::Name((*name).to_owned()),
        expected: (*expected).to_owned(),
        rule: if k == ANGLE || k == COLUMNS.len() && further == Further::Speeds { Rule::OrMissing } else { Rule::Any },
    };
    let fields: Vec<Field> = columns.iter().enumerate().map(field).collect();
    let mut rows: Vec<Row> = Vec::new();
    let named = columns.iter().map(|(name, expected)| ((*name).to_owned(), unit_of(expected).to_owned()));
    let units = StatedUnits::new(named.collect());
    let form = TableForm { lines: TableLines::default(), missing: None, expected: PLATEAUS };
    let mut table = CheckedTable::open(source.clone(), Extent::Whole, &fields, units, form)?;
    while let Some(batch) = table.next_batch()? {
        for columns in batch {
            rows.extend((0..columns[0].len()).map(|row| row_of(columns, row)));
        }
    }
    checked(source.name(), &rows, mountings, further)
}

/// The numbers of a row, and those in its further columns, NaN for a column that the table lacks.
type Row = ([f64; COLUMNS.len()], [f64; 3]);

fn row_of(columns: &[Vec<f64>], row: usize) -> Row {
    let at = |k: usize| columns.get(k).map_or(f64::NAN, |column| column[row]);
    (std::array::from_fn(at), std::array::from_fn(|k| at(COLUMNS.len() + k)))
}

fn checked(file: &Path, rows: &[Row], mountings: usize, further: Further) -> Result<Vec<PlateauRow>, Error> {
    let checked = |(number, (row, numbers)): (u64, &Row)| {
        let plateau = plateau(file, number, row, mountings)?;
        Ok(match further {
            Further::Nothing => plateau,
            Further::Speeds => {
                PlateauRow { speed_uncertainty: speed_uncertainty(file, number, numbers[0])?, ..plateau }
            }
            Further::Bends => PlateauRow { bend_z: Some(bend(file, number, numbers)?), ..plateau },
        })
    };
    let plateaus = (1..).zip(rows).map(checked).collect::<Result<Vec<_>, Error>>()?;
    refuse_copies(file, rows)?;
    Ok(plateaus)
}

/// Refuses a row that stands twice: its noise would count for half.
fn refuse_copies(file: &Path, rows: &[Row]) -> Result<(), Error> {
    let mut first_of = HashMap::with_capacity(rows.len());
    for (number, (row, further)) in (1..).zip(rows) {
        let numbers: Vec<u64> = row.iter().chain(further).map(|number| number.to_bits()).collect();
        if let Some(first) = first_of.insert(numbers, number) {
            let place = Place::Row { row: number, column: COLUMNS[MEAN].0.to_owned() };
            let found = format!("every number of row {first} again");
            return Err(Error::content(file, place, found, "readings of its own for each plateau"));
        }
    }
    Ok(())
}

/// The unit at the end of what is expected of a column.
fn unit_of(expected: &str) -> &str {
    expected.rsplit_once(" in ").map_or("", |(_, unit)| unit)
}

/// The uncertainty of a speed; none where the field is empty.
fn speed_uncertainty(file: &Path, number: u64, uncertainty: f64) -> Result<Option<f64>, Error> {
    if uncertainty.is_nan() || (0.0..1.0).contains(&uncertainty) {
        return Ok(Some(uncertainty).filter(|u| !u.is_nan()));
    }
    let place = Place::Row { row: number, column: SPEED_UNCERTAINTY.0.to_owned() };
    let expected = "a relative standard uncertainty, zero or more and below 1";
    Err(Error::content(file, place, uncertainty.to_string(), expected))
}

/// The bend of the way in an arc of slow rotation.
fn bend(file: &Path, number: u64, bend_z: &[f64; 3]) -> Result<Vector3<f64>, Error> {
    /// Rotation that is not slow has this square of its rate [1/s^2].
    const MOST: f64 = 1.0;
    match bend_z.iter().position(|value| value.is_nan() || value.abs() > MOST) {
        None => Ok(Vector3::from(*bend_z)),
        Some(axis) => {
            let place = Place::Row { row: number, column: BEND[axis].0.to_owned() };
            let expected = "a second derivative of the vertical in 1/s^2, -1 to 1";
            Err(Error::content(file, place, bend_z[axis].to_string(), expected))
        }
    }
}

/// One row, checked.
fn plateau(file: &Path, number: u64, row: &[f64; COLUMNS.len()], mountings: usize) -> Result<PlateauRow, Error> {
    let wrong = |k: usize, expected: String| {
        let found = if row[k].is_nan() { "an empty field".to_owned() } else { row[k].to_string() };
        Error::content(file, Place::Row { row: number, column: COLUMNS[k].0.to_owned() }, found, expected)
    };
    let [mounting, speed, angle, m1, m2, m3, c11, c12, c13, c22, c23, c33, samples] = *row;
    if mounting.fract() != 0.0 || !(1.0..=mountings as f64).contains(&mounting) {
        return Err(wrong(0, format!("the number of a mounting, 1 to {mountings}")));
    }
    if !(-FASTEST..=FASTEST).contains(&speed) {
        return Err(wrong(1, "a speed in rad/s from -1e6 to 1e6 rpm".to_owned()));
    }
    if (speed == 0.0) == angle.is_nan() {
        let expected = if speed == 0.0 { "the carousel angle of a plateau at rest" } else { "no angle while spinning" };
        return Err(wrong(ANGLE, expected.to_owned()));
    }
    let covariance = Matrix3::new(c11, c12, c13, c12, c22, c23, c13, c23, c33);
    if covariance.cholesky().is_none() {
        return Err(wrong(COVARIANCE, "a positive definite covariance".to_owned()));
    }
    // 2^53: up to here every count is a number of its own.
    if samples.fract() != 0.0 || !(1.0..=9_007_199_254_740_992.0).contains(&samples) {
        return Err(wrong(SAMPLES, "how many samples were averaged".to_owned()));
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "whole numbers in range, by the checks above"
    )]
    let (mounting, samples) = (mounting as usize - 1, samples as u64);
    let angle = if speed == 0.0 { angle } else { 0.0 };
    Ok(PlateauRow {
        mounting,
        speed,
        speed_uncertainty: None,
        angle,
        mean: Vector3::new(m1, m2, m3),
        covariance,
        samples,
        bend_z: None,
    })
}
