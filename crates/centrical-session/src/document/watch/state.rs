//! `watch.json`: where a watched session stands, to go on from after a stop.

use std::path::Path;

use centrical::fit::{Follower, Progress};
use centrical::uncertainty::Test;
use centrical::{MeasurementModel, Observation, unwatched};
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

use super::history::{HistoryEntry, HistoryEstimate};
use crate::document::json::{self, rows};
use crate::error::{Error, Place};
use crate::experiment::{RestTable, Session};
use crate::record::Input;
use crate::settings::{from_json, read_result};

/// Name of the form's present version.
const SCHEMA: &str = "centrical-watch/1";

/// Where a watched session stands. Numbers are kept to the last bit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WatchState {
    /// `centrical-watch/1`.
    schema: String,
    /// The experiment file that the state belongs to.
    experiment: Input,
    /// Point reached, SI, in the order of the unknowns; empty where it is not known.
    pub point: Vec<f64>,
    /// Point of linearisation of the plateaus, where it is another.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    reference: Option<Vec<f64>>,
    /// Plateaus that had come when they were linearised there.
    #[serde(default, skip_serializing_if = "is_zero")]
    referenced: usize,
    /// Plateaus that have come, in their order.
    pub plateaus: Vec<WatchedPlateau>,
}

/// A plateau that has come.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WatchedPlateau {
    /// Index of the plateau in the schedule of all mountings, from 0.
    pub set_point: usize,
    /// Mean as it was reduced when it came [m/s^2].
    pub mean: [f64; 3],
    /// Its covariance [m^2/s^4].
    pub covariance: [[f64; 3]; 3],
    /// Its test.
    innovation: WatchedInnovation,
    /// Whether it does not fit.
    pub alarm: bool,
    /// Whether it is held out.
    pub held_out: bool,
}

/// The test of a plateau, without its probability: the last digit of a tail of chi^2 differs between processors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct WatchedInnovation {
    /// Normalised innovation squared.
    squared: f64,
    /// Combinations of the three readings that could be predicted.
    degrees_of_freedom: usize,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde's signature")]
fn is_zero(count: &usize) -> bool {
    *count == 0
}

/// Numbers beyond this are neither means of readings [m/s^2] nor their covariances.
const LARGEST: f64 = 1e12;

impl WatchState {
    /// The state before the first plateau.
    ///
    /// # Errors
    /// [`Error`] when the experiment file cannot be read.
    pub fn new(session: &Session) -> Result<Self, Error> {
        let folder = &session.folder;
        let experiment = folder.open(&session.file, Input::EXPECTED)?;
        let experiment = Input::of(folder.path(), &experiment, &unwatched)?;
        let (schema, point, plateaus) = (SCHEMA.to_owned(), Vec::new(), Vec::new());
        Ok(Self { schema, experiment, point, reference: None, referenced: 0, plateaus })
    }

    /// The state in `file`; without that file the one before the first plateau. `unknowns` are those of a fit: parameters and influences. Where
    /// it has rests that the session still waits for, the number of plateaus that have come.
    ///
    /// # Errors
    /// [`Error`] when the file is of another form or belongs to another experiment file.
    pub fn resume(session: &Session, unknowns: usize, file: &Path) -> Result<Result<Self, usize>, Error> {
        let fresh = Self::new(session)?;
        if !file.exists() {
            return Ok(Ok(fresh));
        }
        let expected = "the state of a watched session";
        let text = read_result(file, expected)?;
        let mut state: Self = from_json(file, 1, &text, expected)?;
        let refuse = |found: String, expected: &str| Err(Error::content(file, Place::Whole, found, expected));
        if state.schema != fresh.schema || state.experiment != fresh.experiment {
            let expected = format!("that of {}, or no such file to begin anew", session.file.display());
            return refuse("the state of another experiment file".to_owned(), &expected);
        }
        let count = session.experiment.set_points.len();
        let largest = state.plateaus.iter().map(|plateau| plateau.set_point + 1).max().unwrap_or(0);
        if largest > count && session.rest_tables.iter().any(RestTable::is_awaited) {
            return Ok(Err(state.plateaus.len()));
        }
        if largest > count {
            let expected =
                format!("{count}, as many as the session has now with its rests, or no such file to begin anew");
            return refuse(format!("the state of a session of {largest} plateaus or more"), &expected);
        }
        // What the program writes is always so; what another hand wrote is blamed here, not where it is used.
        let lengths: Vec<usize> = [&state.point].into_iter().chain(&state.reference).map(Vec::len).collect();
        if let Some(length) = lengths.into_iter().find(|length| *length > 0 && *length != unknowns) {
            if session.rest_tables.is_empty() {
                return refuse(format!("a point of {length} unknowns"), &format!("one of {unknowns}"));
            }
            // Rests have joined since: their unknowns have no place in it, and the next plateau brings another point.
            (state.point, state.reference) = (Vec::new(), None);
        }
        let mut come = vec![false; count];
        for plateau in &state.plateaus {
            if std::mem::replace(&mut come[plateau.set_point], true) {
                return refuse(format!("set point {} a second time", plateau.set_point), "every set point once");
            }
            let numbers = plateau.mean.iter().chain(plateau.covariance.iter().flatten());
            if numbers.into_iter().any(|number| !number.is_finite() || number.abs() >= LARGEST) || !plateau.covers() {
                let found = format!("a mean and covariance of set point {} that cannot be", plateau.set_point);
                return refuse(found, "numbers, and a symmetric positive definite covariance");
            }
        }
        Ok(Ok(state))
    }

    /// Writes the state, whole or not at all; after a power cut it may be lost, and is made anew from the session's records.
    ///
    /// # Errors
    /// [`Error::Json`] when a value has no place in JSON, [`Error::Table`] when the folder does not take it.
    pub fn write(&self, file: &Path) -> Result<(), Error> {
        json::write_line(SCHEMA, self, file)
    }

    /// Notes the point, and where the plateaus are linearised.
    pub fn move_to(&mut self, follower: &Follower) {
        let (point, reference) = (follower.point(), follower.reference());
        self.point = point.to_vec();
        self.reference = (reference != point).then(|| reference.to_vec());
        self.referenced = follower.referenced();
    }

    /// Point of linearisation of the plateaus, and how many there were when it was set.
    pub fn reference(&self) -> (&[f64], usize) {
        (self.reference.as_ref().unwrap_or(&self.point), self.referenced)
    }

    /// The plateaus that are not held out, as data of a fit.
    pub fn taken(&self) -> Vec<Observation> {
        self.plateaus.iter().filter(|plateau| !plateau.held_out).map(WatchedPlateau::observation).collect()
    }
}

impl WatchedPlateau {
    /// The entry of the history after this plateau, the number `plateau` of those that have come: what is known `now`.
    pub fn entry(&self, plateau: usize, model: &MeasurementModel, now: &Progress) -> HistoryEntry {
        HistoryEntry {
            plateau,
            set_point: self.set_point,
            innovation: self.innovation().into(),
            alarm: self.alarm,
            held_out: self.held_out,
            rank: now.rank,
            estimates: HistoryEstimate::all(model, now),
        }
    }

    /// A plateau that has come.
    pub fn new(observation: &Observation, innovation: Test, alarm: bool, held_out: bool) -> Self {
        Self {
            set_point: observation.set_point,
            mean: observation.mean.into(),
            covariance: rows(&observation.covariance),
            innovation: WatchedInnovation {
                squared: innovation.statistic,
                degrees_of_freedom: innovation.degrees_of_freedom,
            },
            alarm,
            held_out,
        }
    }

    /// Its test against the plateaus before it.
    pub fn innovation(&self) -> Test {
        Test::chi_squared(self.innovation.squared, self.innovation.degrees_of_freedom)
    }

    /// Whether the covariance is one.
    fn covers(&self) -> bool {
        let covariance = self.observation().covariance;
        let asymmetry = (covariance - covariance.transpose()).norm();
        asymmetry <= 1e-9 * covariance.norm() && covariance.cholesky().is_some()
    }

    /// As data of a fit.
    pub fn observation(&self) -> Observation {
        Observation {
            set_point: self.set_point,
            mean: Vector3::from(self.mean),
            covariance: Matrix3::from_fn(|i, j| self.covariance[i][j]),
        }
    }
}
