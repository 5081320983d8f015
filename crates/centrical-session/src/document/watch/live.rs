//! `watch-live.json`: what a watch sees at this moment, for whoever looks at it from elsewhere.

use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use centrical::observability::Cause;
use centrical::uncertainty::Level;
use centrical::{Group, SetPoint};
use serde::{Deserialize, Serialize};

use super::history::InnovationSummary;
use crate::document::json;
use crate::document::result::RivalSummary;
use crate::error::{Error, Place};
use crate::experiment::{PlateauName, Session};
use crate::settings::{from_json, read_result};

/// Name of the form's present version.
pub(crate) const LIVE_SCHEMA: &str = "centrical-live/1";

/// What a watch sees at this moment. Times are seconds since 1970, UTC.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct LiveReport {
    /// `centrical-live/1`.
    pub schema: String,
    /// Title of the session.
    pub title: String,
    /// Model of the unit.
    pub unit_model: String,
    /// Serial number of the unit.
    pub unit_serial: String,
    /// What the watch does.
    pub status: LiveStatus,
    /// What is waited for, or why the watch ended.
    pub note: Option<String>,
    /// The file that is waited for, if the note is of one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub awaited: Option<String>,
    /// When this was written.
    pub written: f64,
    /// Seconds between two looks at the folder.
    pub interval: f64,
    /// Plateaus that have arrived.
    pub arrived: usize,
    /// Plateaus of the schedule.
    pub plateaus: usize,
    /// Mounting on the arm, from 1.
    pub mounting: usize,
    /// Mountings of the schedule.
    pub mountings: usize,
    /// When the schedule is expected to end; null while the pace is unknown.
    pub ends: Option<f64>,
    /// Rank so far.
    pub rank: usize,
    /// Number of unknowns.
    pub unknowns: usize,
    /// The last plateau and its test.
    pub last: Option<LivePlateau>,
    /// Plateaus that do not fit.
    pub alarms: Vec<LivePlateau>,
    /// Groups of unknowns with their uncertainties and targets.
    pub groups: Vec<GroupProgress>,
    /// Combinations of unknowns that the plateaus so far do not determine, the first dozen.
    pub lost: Vec<LiveLost>,
    /// The next plateau of the schedule.
    pub next: Option<PlateauLabel>,
    /// The most useful plateau that remains in the mounting on the arm, and that of the other mountings.
    pub best: Vec<LiveBenefit>,
    /// Measured speeds of the plateaus that have arrived.
    pub speeds: Vec<LiveSpeed>,
    /// The record that grows, or the last one.
    pub record: Option<LiveRecord>,
    /// Effects outside the model that the residuals show, once the rank is full.
    pub rivals: Vec<RivalSummary>,
    /// Whether the calibration at the end is acceptable.
    pub acceptable: Option<bool>,
}

/// What a watch does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LiveStatus {
    /// It looks into the folder again and again.
    #[default]
    Following,
    /// It was stopped; the same command goes on.
    Stopped,
    /// Every plateau has arrived.
    Complete,
    /// It ended at an error.
    Failed,
}

/// A plateau of the schedule, as people name it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PlateauLabel {
    /// Index in the schedule of all mountings, from 0.
    pub set_point: usize,
    /// Mounting, from 1.
    pub mounting: usize,
    /// Plateau of the mounting, from 1.
    pub plateau: usize,
    /// Speed [rad/s]; 0 at rest.
    pub omega: f64,
    /// Carousel angle at rest [rad].
    pub angle: f64,
    /// Number of a rest in an attitude of its own, from 1; absent on the arm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rest: Option<usize>,
}

impl PlateauLabel {
    /// The plateau of a set point.
    pub fn of(session: &Session, set_point: usize) -> Self {
        let PlateauName { mounting, plateau } = PlateauName::of(session, set_point);
        let SetPoint { omega, angle, .. } = session.experiment.set_points[set_point];
        Self { set_point, mounting, plateau, omega, angle, rest: session.rest_of(mounting - 1) }
    }
}

/// A plateau that has arrived.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LivePlateau {
    /// Which.
    pub plateau: PlateauLabel,
    /// Its test against the plateaus before it.
    pub innovation: InnovationSummary,
    /// Whether it does not fit.
    pub alarm: bool,
    /// Whether it is held out.
    pub held_out: bool,
}

/// How a plateau agrees with those before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Agreement {
    /// It raises an alarm.
    DoesNotFit,
    /// Nothing before it predicts its readings.
    Untested,
    /// It fits, at a small chance.
    Improbable,
    /// It fits.
    Fits,
}

impl LivePlateau {
    /// How the plateau agrees with those before it.
    pub fn agreement(&self) -> Agreement {
        if self.alarm {
            Agreement::DoesNotFit
        } else if self.innovation.degrees_of_freedom == 0 {
            Agreement::Untested
        } else if Level::Reported.is_passed_by(self.innovation.probability) {
            Agreement::Improbable
        } else {
            Agreement::Fits
        }
    }
}

/// A group of unknowns: its largest standard uncertainty, in the customary unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GroupProgress {
    /// Which.
    #[serde(with = "crate::document::json")]
    pub group: Group,
    /// Names of its unknowns.
    pub names: Vec<String>,
    /// Customary unit.
    pub unit: String,
    /// Customary units in an SI unit.
    pub scale: f64,
    /// Number of its unknowns that are determined.
    pub determined: usize,
    /// Number of its unknowns.
    pub unknowns: usize,
    /// Largest standard uncertainty of those that are determined.
    pub largest: Option<f64>,
    /// Target.
    pub target: Option<f64>,
    /// Whether all are determined, to the target.
    pub is_met: Option<bool>,
    /// Largest standard uncertainty to be expected with the next plateau of the schedule.
    pub next: Option<f64>,
}

/// A combination that is not determined.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LiveLost {
    /// The combination.
    pub direction: String,
    /// Why it is lost, in English.
    pub reason: String,
    /// What would part its terms if it varied more.
    pub causes: Vec<LiveCause>,
    /// Parameters of the instrument among its terms.
    pub of_instrument: Vec<String>,
}

/// What does not vary enough.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LiveCause {
    /// The carousel angle at rest.
    Angle,
    /// The speed.
    Speed,
    /// The radius.
    Radius,
}

impl From<Cause> for LiveCause {
    fn from(cause: Cause) -> Self {
        match cause {
            Cause::Angle => Self::Angle,
            Cause::Speed => Self::Speed,
            Cause::Radius => Self::Radius,
        }
    }
}

/// What a plateau would bring.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LiveBenefit {
    /// Which.
    pub plateau: PlateauLabel,
    /// Mean uncertainty of the compensated reading with it over that without.
    pub factor: f64,
}

/// A measured speed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LiveSpeed {
    /// Which plateau.
    pub plateau: PlateauLabel,
    /// Measured speed [rad/s].
    pub measured: f64,
    /// Its relative standard uncertainty.
    pub uncertainty: f64,
}

impl LiveSpeed {
    /// Measured less set speed, relative; `None` of a plateau at rest.
    pub fn deviation(&self) -> Option<f64> {
        let set = self.plateau.omega.abs();
        (set > 0.0).then(|| self.measured.abs() / set - 1.0)
    }
}

/// A record as it stands.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LiveRecord {
    /// Its file.
    pub file: String,
    /// Its size [bytes].
    pub bytes: u64,
    /// When it changed last, by the clock of the watch.
    pub changed: Option<f64>,
    /// Whether it has stopped growing in the midst of its schedule.
    pub frozen: bool,
    /// Samples.
    pub samples: usize,
    /// Time by the recorder's clock [s] of the last minutes, thinned.
    pub t: Vec<f64>,
    /// Readings then [m/s^2].
    pub f: [Vec<f64>; 3],
    /// Offset of the speed's clock against the recorder's [s], with its standard uncertainty where ramps give one.
    pub clock_offset: Option<(f64, Option<f64>)>,
}

impl LiveReport {
    /// Reads what a watch saw last.
    ///
    /// # Errors
    /// [`Error`] when the file cannot be read or is of another form.
    pub fn read(file: &Path) -> Result<Self, Error> {
        let expected = "what a watch sees, watch-live.json";
        let live: Self = from_json(file, 1, &read_result(file, expected)?, expected)?;
        if live.schema == LIVE_SCHEMA {
            Ok(live)
        } else {
            Err(Error::content(file, Place::Whole, format!("schema {:?}", live.schema), format!("{LIVE_SCHEMA:?}")))
        }
    }

    /// Writes it, whole or not at all.
    ///
    /// # Errors
    /// [`Error::Json`] when a value has no place in JSON, [`Error::Table`] when the folder does not take it.
    pub fn write(&self, file: &Path) -> Result<(), Error> {
        json::write_line(LIVE_SCHEMA, self, file)
    }

    /// Age of the last sample at a time [s]: since the record changed.
    pub fn age(&self, now: f64) -> Option<f64> {
        let changed = self.record.as_ref()?.changed?;
        Some((now - changed).max(0.0))
    }

    /// Whether the watch itself has been silent for so long that it was probably killed.
    pub fn is_silent(&self, now: f64) -> bool {
        self.status == LiveStatus::Following && now - self.written > 3.0 * self.interval + 10.0
    }
}

/// Seconds since 1970, UTC.
pub fn seconds_since_1970(time: SystemTime) -> f64 {
    time.duration_since(UNIX_EPOCH).map_or(0.0, |time| time.as_secs_f64())
}
