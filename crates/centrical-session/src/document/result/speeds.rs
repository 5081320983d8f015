//! How the speeds of plateaus are known, and what the telemetry shows against them.

use centrical::reduction::{ClockAgreement, MeasuredSpeed};
use centrical::uncertainty::{Extent, ShownSpeed, SpeedContradiction, StatedSpeeds};
use centrical::{Calibration, Data, Experiment, FitError, SetPoint, Termination};
use serde::{Deserialize, Serialize};

use crate::experiment::{PlateauName, Session, SpeedSource};
use crate::reduced::{Reduced, ReducedPlateau};

/// How the speeds are known; in a result only where they are measured or contradicted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SpeedsSummary {
    /// By what they are measured; none if they are set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measured_by: Option<SpeedSource>,
    /// Plateaus with a measured speed.
    pub measured: usize,
    /// Plateaus that spin.
    pub spinning: usize,
    /// Relative standard uncertainty with which a speed is set.
    pub set_uncertainty: f64,
    /// Relative standard uncertainty of the common scale of the speeds.
    pub scale_uncertainty: f64,
    /// What the telemetry shows against the schedule or the record, at a family-wise error of 5 %.
    pub findings: Vec<SpeedFinding>,
}

/// What the telemetry shows against the schedule or the record.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "finding", rename_all = "kebab-case")]
pub enum SpeedFinding {
    /// Speeds differ from those that were set.
    Difference(SpeedDifference),
    /// The ramps of the telemetry are not those of the record.
    Clock {
        /// What shows the speeds: telemetry or pulses.
        shown_by: SpeedSource,
        /// Mountings, counted from 1.
        mountings: Vec<usize>,
        /// Ramps of their records in the time of the telemetry.
        ramps: usize,
        /// Those that the telemetry has at the same time.
        agreeing: usize,
        /// Seconds of the record in a second of the telemetry, if all agree by another rate.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        rate: Option<f64>,
    },
    /// The telemetry does not cover plateaus.
    Missing {
        /// What shows the speeds: telemetry or pulses.
        shown_by: SpeedSource,
        /// Mounting, counted from 1.
        mounting: usize,
        /// Number of its plateaus that spin and are not in the telemetry.
        plateaus: usize,
        /// First and last time of the telemetry, the record's clock [s].
        span: [f64; 2],
    },
}

/// Speeds that differ from those that were set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SpeedDifference {
    /// What shows the speeds: telemetry or pulses.
    pub shown_by: SpeedSource,
    /// What the plateaus have in common.
    pub extent: DifferenceExtent,
    /// Mountings, counted from 1, where they have these in common.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mountings: Vec<usize>,
    /// Speeds that were set [rad/s], where they have these in common.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub speeds: Vec<f64>,
    /// The plateaus, as `mounting:plateau`, counted from 1.
    pub plateaus: Vec<String>,
    /// Plateaus with a speed in the telemetry.
    pub of: usize,
    /// Speed that was set on the plateau with the difference nearest to the mean one, or of single plateaus on the farthest off [rad/s].
    pub set: f64,
    /// Speed that the telemetry shows there [rad/s].
    pub shown: f64,
    /// Mean relative difference.
    pub difference: f64,
    /// Its standard uncertainty as stated.
    pub standard_uncertainty: f64,
    /// Family-wise probability of one so large by chance.
    pub probability: f64,
    /// Unit of the telemetry that would explain it, and the one it is read in.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub units: Option<[String; 2]>,
    /// Which the record follows; none if it does not decide.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub record_follows: Option<FollowedSpeeds>,
}

/// What plateaus with a difference have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DifferenceExtent {
    /// They are all plateaus, or all that are off are off alike.
    All,
    /// They are all plateaus of some mountings.
    Mountings,
    /// They are all plateaus of some speeds.
    Speeds,
    /// None of these.
    Plateaus,
}

/// Which of two contradicting speeds a record follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FollowedSpeeds {
    /// Those that are measured.
    Telemetry,
    /// Those that were set.
    Schedule,
}

/// chi^2 by which a fit is better before the record is said to follow its speeds: odds of 10,000.
const DECISIVE: f64 = 18.4;

/// Ramps that a record has at least before its telemetry is said to be of another.
const RAMPS: usize = 3;

/// Units of speed, in rad/s.
const UNITS: [(&str, f64); 4] = [
    ("rad/s", 1.0),
    ("rpm", std::f64::consts::TAU / 60.0),
    ("deg/s", std::f64::consts::TAU / 360.0),
    ("rev/s", std::f64::consts::TAU),
];

impl SpeedsSummary {
    /// The speeds of a calibration; none where they are set and nothing contradicts them.
    ///
    /// # Errors
    /// [`FitError`] when numbers overflow.
    pub(crate) fn of(
        calibration: &Calibration,
        session: &Session,
        reduced: &Reduced,
    ) -> Result<Option<Self>, FitError> {
        let (scheduled, used) = (&session.experiment.set_points, &calibration.data().model().experiment().set_points);
        let mut findings: Vec<SpeedFinding> = clocks(session, reduced);
        let shown = shown(scheduled, &reduced.speeds);
        for contradiction in stated(session).contradictions(&shown) {
            findings.push(SpeedFinding::Difference(SpeedDifference {
                record_follows: record_follows(calibration, &shown, &contradiction, session.speeds.is_in_files())?,
                ..SpeedDifference::new(session, &contradiction, shown.len())
            }));
        }
        let measured = session.speeds.measured;
        if measured.is_none() && findings.is_empty() {
            return Ok(None);
        }
        let is_measured = |(n, s): &(usize, &SetPoint)| {
            !session.speeds.is_in_files() || reduced.speeds.get(*n).is_some_and(Option::is_some) && !s.is_rest()
        };
        let spinning = used.iter().enumerate().filter(|(_, s)| !s.is_rest());
        Ok(Some(Self {
            measured_by: measured.map(|measured| measured.source),
            measured: measured.map_or(0, |_| spinning.clone().filter(is_measured).count()),
            spinning: spinning.count(),
            set_uncertainty: session.speeds.set_uncertainty,
            scale_uncertainty: session.type_b.speed_scale,
            findings,
        }))
    }
}

impl SpeedDifference {
    fn new(session: &Session, found: &SpeedContradiction, of: usize) -> Self {
        let name = |n: &usize| PlateauName::of(session, *n).to_string();
        let (extent, mountings, speeds) = match &found.extent {
            Extent::All => (DifferenceExtent::All, Vec::new(), Vec::new()),
            Extent::Mountings(mountings) => {
                (DifferenceExtent::Mountings, mountings.iter().map(|m| m + 1).collect(), Vec::new())
            }
            Extent::Speeds(speeds) => (DifferenceExtent::Speeds, Vec::new(), speeds.clone()),
            Extent::Plateaus => (DifferenceExtent::Plateaus, Vec::new(), Vec::new()),
        };
        Self {
            shown_by: shown_by(session),
            extent,
            mountings,
            speeds,
            plateaus: found.set_points.iter().map(name).collect(),
            of,
            set: found.set,
            shown: found.shown,
            difference: found.difference,
            standard_uncertainty: found.standard_uncertainty,
            probability: found.probability,
            units: other_units(1.0 + found.difference),
            record_follows: None,
        }
    }
}

impl SpeedFinding {
    /// Probability by chance: what decides whether it is an objection. A clock that is not the record's never comes by
    /// chance; telemetry that is missing contradicts nothing.
    pub fn probability(&self) -> f64 {
        match self {
            Self::Difference(difference) => difference.probability,
            Self::Clock { .. } => 0.0,
            Self::Missing { .. } => 1.0,
        }
    }
}

/// What shows the speeds that are compared.
fn shown_by(session: &Session) -> SpeedSource {
    let source = session.speeds.measured.map(|measured| measured.source);
    source.filter(|source| *source == SpeedSource::Pulses).unwrap_or(SpeedSource::Telemetry)
}

/// What is stated of the speeds of the telemetry against those that were set. Without a stated uncertainty, the scale of a
/// tachometer is taken to be as uncertain as a speed that is set: the speeds are set by it.
fn stated(session: &Session) -> StatedSpeeds {
    let speeds = &session.speeds;
    let measured = speeds.measured.filter(|_| speeds.is_in_files());
    let tachometer = speeds.tachometer_uncertainty.or(measured.and_then(|measured| measured.scale));
    StatedSpeeds {
        plateau: speeds.set_uncertainty.hypot(measured.map_or(0.0, |measured| measured.uncertainty)),
        scale: tachometer.unwrap_or(speeds.set_uncertainty).hypot(session.type_b.speed_scale),
    }
}

/// The plateaus with a speed in the telemetry.
fn shown(scheduled: &[SetPoint], speeds: &[Option<MeasuredSpeed>]) -> Vec<ShownSpeed> {
    let pairs = scheduled.iter().zip(speeds).enumerate();
    let shown = |(set_point, (s, shown)): (usize, (&SetPoint, &Option<MeasuredSpeed>))| {
        let shown = (*shown).filter(|_| !s.is_rest())?;
        Some(ShownSpeed { set_point, mounting: s.mounting, set: s.omega.abs(), shown })
    };
    pairs.filter_map(shown).collect()
}

/// What the clocks of the telemetry show, mounting by mounting.
fn clocks(session: &Session, reduced: &Reduced) -> Vec<SpeedFinding> {
    let mut findings: Vec<SpeedFinding> = Vec::new();
    for (m, mounting) in reduced.mountings.iter().enumerate() {
        let Some(agreement) = mounting.agreement else { continue };
        let rate = (agreement.rate != 1.0).then_some(agreement.rate);
        if !agreement.is_of_the_record() {
            if agreement.ramps >= RAMPS {
                add_clock(&mut findings, shown_by(session), m + 1, &agreement, rate);
            }
            continue;
        }
        let plateaus = session.experiment.set_points.iter().zip(&reduced.plateaus).zip(&reduced.speeds);
        let is_missing = |plateau: &ReducedPlateau| {
            let Some(seen) = &plateau.seen else { return true };
            seen.measured_speed.is_none() || share(seen.window, agreement.span) < 0.5
        };
        let missing = plateaus
            .filter(|((s, plateau), speed)| s.mounting == m && !s.is_rest() && speed.is_none() && is_missing(plateau))
            .count();
        if missing > 0 {
            let shown_by = shown_by(session);
            findings.push(SpeedFinding::Missing { shown_by, mounting: m + 1, plateaus: missing, span: agreement.span });
        }
    }
    findings
}

/// Part of a window that the telemetry covers.
fn share(window: [f64; 2], span: [f64; 2]) -> f64 {
    (window[1].min(span[1]) - window[0].max(span[0])) / (window[1] - window[0])
}

/// Adds the clock of a mounting to those that are off alike, the rates within a percent.
fn add_clock(
    findings: &mut Vec<SpeedFinding>,
    shown_by: SpeedSource,
    mounting: usize,
    agreement: &ClockAgreement,
    own: Option<f64>,
) {
    let is_alike = |rate: Option<f64>| match (rate, own) {
        (Some(rate), Some(own)) => (rate / own - 1.0).abs() < 0.01,
        (rate, own) => rate == own,
    };
    for finding in &mut *findings {
        if let SpeedFinding::Clock { mountings, ramps, agreeing, rate, .. } = finding
            && is_alike(*rate)
        {
            mountings.push(mounting);
            *ramps += agreement.ramps;
            *agreeing += agreement.agreeing;
            return;
        }
    }
    let (ramps, agreeing) = (agreement.ramps, agreement.agreeing);
    findings.push(SpeedFinding::Clock { shown_by, mountings: vec![mounting], ramps, agreeing, rate: own });
}

/// The pair of units whose mistake makes speeds `ratio` times as large, within a percent: the telemetry's own, and that which
/// it is read in.
fn other_units(ratio: f64) -> Option<[String; 2]> {
    let pairs = UNITS.iter().flat_map(|own| UNITS.iter().map(move |read| (own, read)));
    let mut pairs = pairs.filter(|(own, read)| own.0 != read.0 && (ratio * own.1 / read.1 - 1.0).abs() < 0.01);
    pairs.next().map(|(own, read)| [own.0.to_owned(), read.0.to_owned()])
}

/// Which speeds the record follows: those of the plateaus in question as shown, or as set. The fits are compared. Of a scale
/// common to all plateaus a record says no more than the radii are known to, which is for the laboratory to judge. Plateaus
/// that differ alike are taken to differ by the mean, which has little of the scatter of the telemetry.
fn record_follows(
    calibration: &Calibration,
    shown: &[ShownSpeed],
    found: &SpeedContradiction,
    is_measured: bool,
) -> Result<Option<FollowedSpeeds>, FitError> {
    // Nor does a fit by speeds in another unit say anything.
    if found.extent == Extent::All
        || calibration.fit().termination == Termination::Linear
        || found.difference.abs() > 0.1
    {
        return Ok(None);
    }
    let mut squares = [0.0; 2];
    for (is_shown, square) in [true, false].into_iter().zip(&mut squares) {
        let model = calibration.data().model();
        let mut set_points = model.experiment().set_points.clone();
        for speed in shown.iter().filter(|speed| found.set_points.contains(&speed.set_point)) {
            let difference = match found.extent {
                Extent::Plateaus => speed.shown.speed / speed.set - 1.0,
                _ => found.difference,
            };
            match (is_shown, is_measured) {
                (true, false) => set_points[speed.set_point].omega *= 1.0 + difference,
                (false, true) => set_points[speed.set_point].omega /= 1.0 + difference,
                _ => {}
            }
        }
        let other = model.in_experiment(Experiment { set_points, ..model.experiment().clone() });
        let data = Data::new(&other, calibration.data().observations().to_vec())?;
        *square = Calibration::exact(&data)?.fit().chi_squared;
    }
    let [by_shown, by_set] = squares;
    Ok(match by_set - by_shown {
        gain if gain > DECISIVE => Some(FollowedSpeeds::Telemetry),
        gain if gain < -DECISIVE => Some(FollowedSpeeds::Schedule),
        _ => None,
    })
}
