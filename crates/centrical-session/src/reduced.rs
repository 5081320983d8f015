//! The plateau means of a session, wherever they come from.

use centrical::reduction::{ClockAgreement, MeasuredSpeed, PlateauMean};
use centrical::uncertainty::BetweenRests;
use centrical::{MeasurementModel, Observation, SetPoint};
use nalgebra::{Matrix3, Vector3};

use crate::error::Error;
use crate::experiment::{PlateauRow, Session};
use crate::record::{Input, RecordOverview};

/// A session's plateau means, and the files they come from.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reduced {
    /// One for each of the experiment's set points, in the same order.
    pub plateaus: Vec<ReducedPlateau>,
    /// What each mounting's record tells beside; empty for a session that came already averaged.
    pub mountings: Vec<MountingFindings>,
    /// Indices of plateaus that are not to be fitted.
    pub held_out: Vec<usize>,
    /// The session's files.
    pub inputs: Vec<Input>,
    /// Speeds by the telemetry or a counter of revolutions, one for each of the set points; empty for a session that came
    /// already averaged.
    pub speeds: Vec<Option<MeasuredSpeed>>,
}

/// What a mounting's record tells beside its means.
#[derive(Debug, Clone, PartialEq)]
pub struct MountingFindings {
    /// What the record looks like.
    pub overview: RecordOverview,
    /// Time constant of the settling after a ramp [s]; none if no settling was seen.
    pub settling_time: Option<f64>,
    /// How the ramps of the telemetry agree with those of the record; none without telemetry.
    pub agreement: Option<ClockAgreement>,
    /// Readings of newtonometers 1, 2, 3 that were interpolated to the stamps of another one; none unless each has a file with stamps
    /// of its own.
    pub interpolated: Option<[u64; 3]>,
    /// Plateaus that the record shows and the schedule does not have, from and to, the record's clock [s].
    pub unscheduled: Vec<[f64; 2]>,
}

/// The mean reading of a plateau and what it was made of.
#[derive(Debug, Clone, PartialEq)]
pub struct ReducedPlateau {
    /// Samples used.
    pub samples: u64,
    /// Mean reading [m/s^2].
    pub mean: Vector3<f64>,
    /// Its covariance [m^2/s^4], with what differs between rests; that in `seen` is of the noise alone.
    pub covariance: Matrix3<f64>,
    /// What its record shows; none for a plateau that came already averaged.
    pub seen: Option<PlateauMean>,
}

impl Reduced {
    /// The plateaus on the arm as a table, from which the session is calibrated to the same numbers.
    pub fn table(&self, session: &Session) -> Vec<PlateauRow> {
        let sign = session.experiment.centrifuge.rotation.sign();
        let row = |(plateau, set_point): (&ReducedPlateau, &SetPoint)| PlateauRow {
            speed: sign * set_point.omega + 0.0,
            speed_uncertainty: set_point.speed_uncertainty,
            angle: set_point.angle,
            ..plateau.row(set_point.mounting)
        };
        let set_points = self.set_points(session);
        let plateaus = self.plateaus.iter().zip(&set_points);
        plateaus.filter(|(_, set_point)| session.experiment.is_on_arm(set_point.mounting)).map(row).collect()
    }

    /// With what differs between rests in the covariance of each plateau, a rest.
    pub(crate) fn scattered(mut self, between: &BetweenRests) -> Self {
        for rest in &mut self.plateaus {
            rest.covariance = between.scattered(&rest.covariance);
        }
        self
    }

    /// With rests in attitudes of their own behind the plateaus on the arm.
    pub(crate) fn with_rests(mut self, rests: Vec<ReducedPlateau>) -> Self {
        self.plateaus.extend(rests);
        if !self.speeds.is_empty() {
            self.speeds.resize(self.plateaus.len(), None);
        }
        self
    }

    /// The set points of the session, with measured speeds where it measures them. A plateau that spins without a measured
    /// speed keeps the one that was set, as uncertain as speeds are set.
    pub fn set_points(&self, session: &Session) -> Vec<SetPoint> {
        let scheduled = session.experiment.set_points.iter();
        let Some(measured) = session.speeds.measured.filter(|_| session.speeds.is_in_files()) else {
            return scheduled.copied().collect();
        };
        let taken = |(n, set_point): (usize, &SetPoint)| match self.speeds.get(n).copied().flatten() {
            _ if set_point.is_rest() => *set_point,
            Some(speed) => SetPoint {
                omega: speed.speed.copysign(set_point.omega),
                speed_uncertainty: Some(speed.uncertainty.hypot(measured.uncertainty)),
                ..*set_point
            },
            None => SetPoint { speed_uncertainty: Some(session.speeds.set_uncertainty), ..*set_point },
        };
        scheduled.enumerate().map(taken).collect()
    }

    /// The measurement model of the session at [`Reduced::set_points`], with the uncertainties that the session states.
    ///
    /// # Errors
    /// As [`Session::model`].
    pub fn model(&self, session: &Session) -> Result<MeasurementModel, Error> {
        session.model_at(self.set_points(session), self.reading_noise())
    }

    /// Standard deviation of a single reading on the axis and the plateau with the least [m/s^2]; none where some plateau came already averaged.
    pub(crate) fn reading_noise(&self) -> Option<f64> {
        let least = |plateau: &ReducedPlateau| {
            let seen = plateau.seen.as_ref()?;
            Some((seen.white_variance * seen.samples as f64).min().sqrt())
        };
        self.plateaus.iter().map(least).reduce(|a, b| Some(a?.min(b?))).flatten()
    }

    /// Readings of newtonometers 1, 2, 3 that were interpolated in all mountings together; none where none were.
    pub fn interpolated(&self) -> Option<[u64; 3]> {
        let mountings = self.mountings.iter().filter_map(|mounting| mounting.interpolated);
        mountings.reduce(|sum, of| [0, 1, 2].map(|axis: usize| sum[axis] + of[axis]))
    }

    /// Plateaus that came already averaged.
    pub(crate) fn of_table(rows: &[PlateauRow]) -> Self {
        Self { plateaus: rows.iter().map(ReducedPlateau::from).collect(), ..Self::default() }
    }

    /// The means as data of a fit, those held out left out.
    pub fn observations(&self) -> Vec<Observation> {
        let fitted = self.plateaus.iter().enumerate().filter(|(set_point, _)| !self.held_out.contains(set_point));
        fitted.map(|(set_point, plateau)| plateau.observation(set_point)).collect()
    }
}

/// Rests in attitudes of their own as rows of a table, a mounting each.
pub(crate) fn rest_rows(rests: &[ReducedPlateau]) -> Vec<PlateauRow> {
    rests.iter().enumerate().map(|(mounting, rest)| rest.row(mounting)).collect()
}

impl ReducedPlateau {
    /// The mean as data of a fit, of that set point.
    pub(crate) fn observation(&self, set_point: usize) -> Observation {
        Observation { set_point, mean: self.mean, covariance: self.covariance }
    }

    /// First and last instant used, the record's clock [s]; none for a plateau that came already averaged.
    pub fn window(&self) -> Option<[f64; 2]> {
        Some(self.seen.as_ref()?.window)
    }

    /// What its record shows of changes within it: nothing of an arc of slow rotation, whose slope is its turn.
    pub(crate) fn steady(&self) -> Option<&PlateauMean> {
        self.seen.as_ref().filter(|seen| seen.arc.is_none())
    }

    /// The mean as a row of a table, at rest.
    fn row(&self, mounting: usize) -> PlateauRow {
        PlateauRow {
            mounting,
            speed: 0.0,
            speed_uncertainty: None,
            angle: 0.0,
            mean: self.mean,
            covariance: self.covariance,
            samples: self.samples,
            bend_z: self.seen.as_ref().and_then(|seen| seen.arc).map(|arc| arc.bend_z),
        }
    }
}

impl From<PlateauMean> for ReducedPlateau {
    fn from(seen: PlateauMean) -> Self {
        Self { samples: seen.samples as u64, mean: seen.mean, covariance: seen.covariance, seen: Some(seen) }
    }
}

impl From<&PlateauRow> for ReducedPlateau {
    fn from(row: &PlateauRow) -> Self {
        Self { samples: row.samples, mean: row.mean, covariance: row.covariance, seen: None }
    }
}
