//! Rests in free attitudes: what a session or a plan names under `[[tumble]]`.
//!
//! A table of rests has the columns of a table of plateaus, a row for each rest; the attitudes that are known of them are in the
//! same order. A record has rests that are still to be found, in attitudes of any order. A plan has attitudes alone, and a duration.

use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use centrical::reduction::PlateauMean as Found;
use centrical::{Experiment, Mounting, Position, SetPoint, SwitchOn};
use centrical_table::Source;
use nalgebra::Vector3;

use super::folder::Folder;
use super::form::{AttitudeList, RecordEntry, TumbleTable};
use super::plateaus::{Further, PLATEAUS, PlateauRow, plateaus_of};
use super::rest_entry::{known, refuse_duration, stated, switch_on, uncertainty};
use super::schedule;
use super::stated_attitudes::{ATTITUDES, CUBE, StatedAttitudes, as_independent, directions, read_attitudes};
use super::toml_path::TomlPath;
use super::turning::{DISTANCE, MOST_DISTANT, Turning};
use crate::error::{Error, Place};
use crate::quantity::Quantity;
use crate::units::Dimension;

/// The rests of one `[[tumble]]`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RestTable {
    /// Where they come from.
    pub source: RestSource,
    /// Their means, each of a mounting of its own; none of rests that are planned, or still to be found in a record.
    pub means: Vec<PlateauRow>,
    /// What is known of their attitudes; `None` where only gravity shows them.
    pub attitudes: Option<KnownAttitudes>,
    /// When the unit was on.
    pub switch_on: SwitchOn,
    /// Variance of the means at most, over the one stated, 1 or more.
    pub noise_at_most: f64,
    /// Slow rotation among them.
    pub turning: Option<Turning>,
}

/// Where rests come from.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum RestSource {
    /// A table of their means.
    Table(PathBuf),
    /// A record of the unit as it is turned and left alone.
    Record(RecordedRests),
    /// A plan: nothing is measured yet.
    Plan(PlannedRests),
}

impl RestSource {
    /// A plan of rests in these attitudes, of no stated duration.
    fn in_attitudes(up_b: Vec<Vector3<f64>>, file: Option<PathBuf>) -> Self {
        Self::Plan(PlannedRests { durations: vec![None; up_b.len()], up_b, file })
    }
}

/// Rests that are to be found in a record.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RecordedRests {
    /// The record, or three, one for each newtonometer.
    pub files: Vec<PathBuf>,
    /// Attitudes in which the unit was laid down, in any order, where they are known.
    pub attitudes: Option<StatedAttitudes>,
    /// Largest distance of the proof masses from the axes of a slow rotation [m], where its arcs count as rests.
    pub turning_radius: Option<f64>,
}

/// Rests that are planned.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PlannedRests {
    /// Where up is in each, axes of the case, of length 1.
    pub up_b: Vec<Vector3<f64>>,
    /// Duration of each, where it is stated [s].
    pub durations: Vec<Option<f64>>,
    /// The table that the attitudes stand in, if they do.
    pub file: Option<PathBuf>,
}

/// Attitudes of rests that are known beforehand.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct KnownAttitudes {
    /// The table of attitudes, if they stand in one.
    pub file: Option<PathBuf>,
    /// Standard uncertainty of each, about either horizontal axis [rad].
    pub uncertainty: f64,
    /// Where up is in each rest, axes of the case, of length 1; `None` where it is unknown.
    pub up_b: Vec<Option<Vector3<f64>>>,
}

impl From<StatedAttitudes> for KnownAttitudes {
    /// The attitude of each rest, in the order in which they are stated.
    fn from(StatedAttitudes { up_b, uncertainty, file }: StatedAttitudes) -> Self {
        Self { file, uncertainty, up_b: up_b.into_iter().map(Some).collect() }
    }
}

impl RestTable {
    /// The rests of `[[tumble]]` in the experiment file `file`; their means are not read yet.
    ///
    /// # Errors
    /// If one has neither a table of rests nor attitudes, an uncertainty without attitudes, or a table and attitudes without
    /// an uncertainty; if stated attitudes are invalid.
    pub(crate) fn named(file: &Path, folder: &Folder, tables: &[TumbleTable]) -> Result<Vec<Self>, Error> {
        let named = tables.iter().enumerate().map(|(n, table)| {
            let at = TomlPath::entry(file, "tumble", n);
            let switch_on = switch_on(file, tables, n)?;
            let rests = match (&table.rests, &table.record, &table.attitudes) {
                (Some(_), Some(_), _) => {
                    Err(at.unexpected("record", "a record beside a table of rests", "one or the other"))
                }
                (Some(rests), None, _) => Self::measured(&at, folder, table, rests),
                (None, Some(record), _) => Self::recorded(&at, folder, table, record),
                (None, None, Some(attitudes)) => {
                    let planned = Self::planned(&at, folder, attitudes, table.attitude_uncertainty.as_ref())?;
                    planned.lasting(&at, table)
                }
                (None, None, None) => {
                    let expected = "a table of rests; or record, their record; or attitudes, of rests that are planned";
                    Err(at.unexpected("rests", "no such key", expected))
                }
            };
            let noise_at_most = match table.noise_at_most {
                None => 1.0,
                Some(ratio) if ratio.is_finite() && ratio >= 1.0 && table.rests.is_some() => ratio,
                Some(ratio) => {
                    let expected = "a ratio of variances, 1 or more, beside a table of rests";
                    return Err(at.unexpected("noise_at_most", ratio.to_string(), expected));
                }
            };
            let turning = table.turning.as_ref().map(|turning| Turning::stated(&at, turning)).transpose()?;
            if turning.is_some() && table.rests.is_none() {
                let expected = "slow rotation beside a table of rests";
                return Err(at.unexpected("turning", "slow rotation without one", expected));
            }
            if table.turning_radius.is_some() && table.record.is_none() {
                let expected = "no such key without a record of slow rotation";
                return Err(at.unexpected("turning_radius", "a distance", expected));
            }
            let mut rests = Self { switch_on, noise_at_most, ..rests? };
            rests.set_turning(turning);
            Ok(rests)
        });
        named.collect()
    }

    /// States slow rotation among the rests.
    fn set_turning(&mut self, turning: Option<Turning>) {
        self.switch_on.from_axes = turning.map_or(0.0, |turning| turning.place_uncertainty());
        self.turning = turning;
    }

    /// Takes slow rotation among the rests that were found in its record.
    pub(crate) fn turned(&mut self, found: &[Found]) {
        self.set_turning(self.record().and_then(|recorded| Turning::of(found, recorded.turning_radius?)));
    }

    /// Rests in the first switch-on, without means.
    fn of(source: RestSource, attitudes: Option<KnownAttitudes>) -> Self {
        let switch_on = SwitchOn { number: 1, bias_change: None, from_axes: 0.0 };
        Self { source, means: Vec::new(), attitudes, switch_on, noise_at_most: 1.0, turning: None }
    }

    fn measured(at: &TomlPath, folder: &Folder, table: &TumbleTable, rests: &str) -> Result<Self, Error> {
        refuse_duration(at, table)?;
        let attitudes = match known(at, table)? {
            None => None,
            // A table may leave the attitude of a rest open: it is read with the means.
            Some((AttitudeList::Named(name), uncertainty)) if name != CUBE => {
                Some(KnownAttitudes { file: Some(folder.join(name)), uncertainty, up_b: Vec::new() })
            }
            Some((entry, uncertainty)) => Some(stated(at, folder, entry, uncertainty)?.into()),
        };
        Ok(Self::of(RestSource::Table(folder.join(rests)), attitudes))
    }

    fn recorded(at: &TomlPath, folder: &Folder, table: &TumbleTable, record: &RecordEntry) -> Result<Self, Error> {
        refuse_duration(at, table)?;
        let attitudes = known(at, table)?.map(|(entry, u)| stated(at, folder, entry, u)).transpose()?;
        let files = record.0.iter().map(|name| folder.join(name)).collect();
        let radius = |q| at.bounded("turning_radius", q, Dimension::Length, (0.0, MOST_DISTANT), DISTANCE);
        let turning_radius = table.turning_radius.as_ref().map(radius).transpose()?;
        Ok(Self::of(RestSource::Record(RecordedRests { files, attitudes, turning_radius }), None))
    }

    /// Rests that are planned in these attitudes, known to `uncertain` if it is stated; paths start from `folder`.
    ///
    /// # Errors
    /// If an attitude has no direction, or the uncertainty makes no sense.
    pub(crate) fn planned(
        at: &TomlPath,
        folder: &Folder,
        entry: &AttitudeList,
        uncertain: Option<&Quantity>,
    ) -> Result<Self, Error> {
        let (up_b, file) = directions(at, folder, entry)?;
        let stated = |uncertainty| StatedAttitudes { up_b: up_b.clone(), uncertainty, file: file.clone() };
        let attitudes = uncertainty(at, uncertain)?.map(|u| stated(u).into());
        Ok(Self::of(RestSource::in_attitudes(up_b, file), attitudes))
    }

    /// Planned rests with the durations that their table states.
    fn lasting(mut self, at: &TomlPath, table: &TumbleTable) -> Result<Self, Error> {
        let RestSource::Plan(planned) = &mut self.source else { return Ok(self) };
        if table.durations.is_empty() {
            planned.durations.fill(schedule::duration(at, "duration", table.duration.as_ref())?);
            return Ok(self);
        }
        if table.duration.is_some() {
            return Err(at.unexpected("duration", "a duration", "no such key beside durations"));
        }
        if table.durations.len() != planned.up_b.len() {
            let expected = format!("one for each of the {} attitudes", planned.up_b.len());
            return Err(at.unexpected("durations", format!("{} durations", table.durations.len()), expected));
        }
        for (duration, stated) in planned.durations.iter_mut().zip(&table.durations) {
            *duration = schedule::duration(at, "durations", Some(stated))?;
        }
        Ok(self)
    }

    /// Reads the means, and the attitudes that a table has of them. Nothing is to be read of rests that are planned.
    ///
    /// # Errors
    /// If a table can not be read, a rest has a speed, the tables differ in length, or the attitude of a row is not that of its rest.
    pub(crate) fn read(&mut self, folder: &Folder) -> Result<(), Error> {
        let RestSource::Table(file) = &self.source else { return Ok(()) };
        let further = if self.turning.is_some() { Further::Bends } else { Further::Nothing };
        self.means = read_rests(&folder.open_kept(file, PLATEAUS)?, further)?;
        let Some(attitudes) = &mut self.attitudes else { return Ok(()) };
        if let Some(file) = attitudes.file.as_ref() {
            attitudes.up_b = read_attitudes(&folder.open_kept(file, ATTITUDES)?)?;
        }
        let named = attitudes.file.as_ref().unwrap_or(file);
        if attitudes.up_b.len() != self.means.len() {
            let found = format!("{} rows", attitudes.up_b.len());
            let expected = format!("a row for each of the {} rests of {}", self.means.len(), file.display());
            return Err(Error::content(named, Place::Whole, found, expected));
        }
        let rows = (1..).zip(self.means.iter().zip(&attitudes.up_b));
        for (row, (rest, up_b)) in rows.filter_map(|(row, (rest, up_b))| Some((row, (rest, up_b.as_ref()?)))) {
            let angle = up_b.angle(&rest.mean);
            if angle > FARTHEST {
                let place = Place::Row { row, column: "up_1".to_owned() };
                let found = format!("an attitude {:.0} deg from that of the mean reading", angle.to_degrees());
                let expected = format!(
                    "the attitude of rest {row} of {}, in axes of the case that point about where the newtonometers do",
                    file.display()
                );
                return Err(Error::content(named, place, found, expected));
            }
        }
        Ok(())
    }

    /// Number of rests.
    pub fn count(&self) -> usize {
        self.directions().count()
    }

    /// Nominal direction of the specific force in each rest, of any length: as it was measured, or as it is planned.
    fn directions(&self) -> impl Iterator<Item = &Vector3<f64>> {
        let planned = match &self.source {
            RestSource::Plan(planned) => planned.up_b.as_slice(),
            RestSource::Table(_) | RestSource::Record(_) => &[],
        };
        self.means.iter().map(|rest| &rest.mean).chain(planned)
    }

    /// The positions of the rests, numbered on from `first`. Where the vertical is, the attitude says, or else the mean.
    fn positions(&self, first: usize) -> impl Iterator<Item = Position> {
        let uncertainties = self.attitudes.as_ref().map_or_else(Vec::new, |known| {
            let means: Vec<Vector3<f64>> = self.means.iter().map(|rest| rest.mean).collect();
            let factors = as_independent(&known.up_b, &means, known.uncertainty);
            factors.into_iter().map(|factor| factor * known.uncertainty).collect()
        });
        (first..).zip(self.directions()).enumerate().map(move |(n, (number, up))| {
            let id = format!("r{number}");
            let known =
                self.attitudes.as_ref().and_then(|known| Some((known.up_b.get(n).copied()??, uncertainties[n])));
            let position = match known {
                Some((up_b, uncertainty)) => Position::known(id, &up_b, uncertainty),
                None => Position::free(id, up),
            };
            let bend_z = self.means.get(n).and_then(|rest| rest.bend_z).unwrap_or_default();
            position.on_arc(bend_z).in_switch_on(self.switch_on)
        })
    }

    /// Duration of each rest, where it is planned and stated [s].
    pub fn durations(&self) -> Vec<Option<f64>> {
        match &self.source {
            RestSource::Plan(planned) => planned.durations.clone(),
            RestSource::Table(_) | RestSource::Record(_) => vec![None; self.means.len()],
        }
    }

    /// Whether the rests are planned, and nothing is measured of them.
    pub fn is_planned(&self) -> bool {
        matches!(self.source, RestSource::Plan(_))
    }

    /// Whether its rests are measured, and not read or found yet.
    pub fn is_awaited(&self) -> bool {
        !self.is_planned() && self.means.is_empty()
    }

    /// What is said of a record in which the rests are to be found.
    pub fn record(&self) -> Option<&RecordedRests> {
        match &self.source {
            RestSource::Record(recorded) => Some(recorded),
            RestSource::Table(_) | RestSource::Plan(_) => None,
        }
    }

    /// The rests as a plan of a record has them: in the attitudes that are stated, or else in those that `draw` gives.
    pub(crate) fn as_planned(&self, draw: impl FnOnce() -> Vec<Vector3<f64>>) -> Self {
        let Some(RecordedRests { attitudes, .. }) = self.record() else { return self.clone() };
        let up_b = attitudes.as_ref().map_or_else(draw, |stated| stated.up_b.clone());
        let file = attitudes.as_ref().and_then(|stated| stated.file.clone());
        let known = attitudes.clone().map(KnownAttitudes::from);
        Self { switch_on: self.switch_on, ..Self::of(RestSource::in_attitudes(up_b, file), known) }
    }

    /// The files of the table.
    pub fn files(&self) -> impl Iterator<Item = &PathBuf> {
        let (rests, attitudes) = match &self.source {
            RestSource::Table(file) => {
                (std::slice::from_ref(file), self.attitudes.as_ref().and_then(|known| known.file.as_ref()))
            }
            RestSource::Record(recorded) => {
                (recorded.files.as_slice(), recorded.attitudes.as_ref().and_then(|stated| stated.file.as_ref()))
            }
            RestSource::Plan(planned) => (&[][..], planned.file.as_ref()),
        };
        rests.iter().chain(attitudes)
    }
}

/// Adds a position, a mounting and a set point for each of the rests.
pub(crate) fn add_rests(experiment: &mut Experiment, tables: &[RestTable]) {
    let mut first = 1;
    for table in tables {
        for free in table.positions(first) {
            let (position, mounting) = (experiment.positions.len(), experiment.mountings.len());
            experiment.positions.push(free);
            experiment.mountings.push(Mounting { position, arm_y: Vector3::zeros() });
            experiment.set_points.push(SetPoint::at_rest(mounting, 0.0));
        }
        first += table.count();
    }
}

/// Adds two rests in one attitude for each table that is not read or found yet, known if those will be.
pub(super) fn add_awaited(experiment: &mut Experiment, tables: &[RestTable]) {
    for table in tables.iter().filter(|table| table.is_awaited()) {
        let is_known = table.attitudes.is_some() || table.record().is_some_and(|record| record.attitudes.is_some());
        let up = Vector3::z();
        let rest = if is_known { Position::known("r", &up, 1.0) } else { Position::free("r", &up) };
        experiment.positions.extend([rest.clone(), rest].map(|rest| rest.in_switch_on(table.switch_on)));
    }
}

/// Refuses rests that are still to be found in a record: a plan is read without one.
pub(crate) fn refuse_records(file: &Path, tables: &[RestTable]) -> Result<(), Error> {
    let Some(recorded) = tables.iter().position(|table| table.record().is_some()) else { return Ok(()) };
    let expected = "rests, a table of them as `centrical tumble` writes it, or attitudes to be planned";
    Err(TomlPath::entry(file, "tumble", recorded).unexpected("record", "a record in a plan", expected))
}

/// Farthest angle between a known attitude and the one of its mean [rad]: beyond it rows are out of order.
const FARTHEST: f64 = PI / 6.0;

/// The rests of a table: each row is one, and none has a speed.
fn read_rests(table: &Source, further: Further) -> Result<Vec<PlateauRow>, Error> {
    let rests = plateaus_of(table, usize::MAX, further)?;
    match (1..).zip(&rests).find(|(_, rest)| rest.speed != 0.0) {
        Some((row, rest)) => {
            let place = Place::Row { row, column: "speed".to_owned() };
            Err(Error::content(table.name(), place, rest.speed.to_string(), "0 in a table of rests"))
        }
        None => Ok(rests),
    }
}
