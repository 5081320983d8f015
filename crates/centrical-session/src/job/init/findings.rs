//! What all mountings together show: the unit of the readings, attitudes, radii of the seats, and set speeds.

use std::f64::consts::PI;

use super::output_unit::OutputUnit;
use super::sighting::{Extremes, SeenMounting};
use super::tumbled::Tumbled;
use crate::error::Error;
use crate::experiment::axes_text;
use crate::units::Dimension;

/// An arm is longer than a sixth of this and shorter than six times this [m]; units of speed differ by six at least, their squares by 36.
const USUAL_RADIUS: f64 = 0.5;

/// Units of speeds that a file may leave unnamed.
const UNITS: [&str; 4] = ["rad/s", "rpm", "deg/s", "rev/s"];

/// The unit of the readings, and what follows from it.
pub(super) struct Findings {
    pub unit: OutputUnit,
    /// Of each mounting: the attitude, and the radius [m].
    pub attitudes: Vec<Option<Attitude>>,
    pub radii: Vec<Option<f64>>,
    /// Why no radius is of an arm, if there are any.
    pub no_arm: Option<String>,
    pub schedules: Vec<Vec<Set>>,
}

impl Findings {
    /// Those of `mountings`, whose speeds are taken to the unit in which the arm is nearest to the usual radius, where the files name none.
    ///
    /// # Errors
    /// If the records are in another unit than the tumble, or in several.
    pub fn of(mountings: &mut [SeenMounting], tumbled: Option<&Tumbled>) -> Result<Self, Error> {
        let extremes = extremes(mountings);
        let mut unit = OutputUnit::of(mountings, &extremes)?;
        if let Some(tumbled) = tumbled {
            unit.agree_with(tumbled, mountings)?;
        }
        if let Some(speed_unit) = speed_unit(&radii(&in_si(&extremes, &unit))) {
            for mounting in mountings.iter_mut() {
                mounting.take_speed_unit(speed_unit);
            }
        }
        let in_si = in_si(&self::extremes(mountings), &unit);
        let attitudes: Vec<Option<Attitude>> =
            in_si.iter().map(|e| e.as_ref().and_then(|e| attitude(&e.rest, &e.fast))).collect();
        let mut seen = radii(&in_si);
        let no_arm = median(&seen).filter(|radius| !is_arm(*radius)).map(|radius| no_arm(radius, mountings));
        if no_arm.is_some() {
            seen.fill(None);
        }
        let radii = seats(&attitudes, &seen);
        Ok(Self { unit, attitudes, radii, no_arm, schedules: schedules(mountings) })
    }
}

fn extremes(mountings: &[SeenMounting]) -> Vec<Option<Extremes>> {
    mountings.iter().map(SeenMounting::extremes).collect()
}

fn in_si(extremes: &[Option<Extremes>], unit: &OutputUnit) -> Vec<Option<Extremes>> {
    extremes.iter().map(|e| e.as_ref()?.in_si(&unit.raw()?)).collect()
}

fn radii(in_si: &[Option<Extremes>]) -> Vec<Option<f64>> {
    in_si.iter().map(|e| e.as_ref().map(Extremes::radius)).collect()
}

/// The unit in which the median radius is nearest to the usual one, if it is one of an arm then, from radii of speeds that count as in rad/s.
fn speed_unit(radii: &[Option<f64>]) -> Option<&'static str> {
    let median = median(radii)?;
    let radius = |unit: &str| median / Dimension::Speed.factor(unit).unwrap_or(f64::NAN).powi(2);
    let farness = |unit: &str| (radius(unit) / USUAL_RADIUS).ln().abs();
    UNITS.into_iter().min_by(|a, b| farness(a).total_cmp(&farness(b))).filter(|unit| is_arm(radius(unit)))
}

/// The median of radii that are above zero.
fn median(radii: &[Option<f64>]) -> Option<f64> {
    let mut radii: Vec<f64> = radii.iter().copied().flatten().filter(|radius| *radius > 0.0).collect();
    radii.sort_by(f64::total_cmp);
    radii.get(radii.len() / 2).copied()
}

/// Whether a radius is one of an arm.
fn is_arm(radius: f64) -> bool {
    (USUAL_RADIUS / 10.0..=USUAL_RADIUS * 10.0).contains(&radius)
}

/// Why a radius of speeds in the unit of the telemetry is not one of an arm: another unit may make it one.
fn no_arm(radius: f64, mountings: &[SeenMounting]) -> String {
    let telemetry = mountings.iter().find_map(|mounting| mounting.group.telemetry.as_ref());
    let stated = telemetry.and_then(|file| file.speed.as_ref()?.unit).unwrap_or("rad/s");
    let in_rad = radius * Dimension::Speed.factor(stated).unwrap_or(1.0).powi(2);
    let other = speed_unit(&[Some(in_rad)]).map_or(String::new(), |unit| {
        let own = in_rad / Dimension::Speed.factor(unit).unwrap_or(1.0).powi(2);
        format!("; with speeds in {unit} it would be {own:.3} m")
    });
    format!("readings and speeds in {stated} make {radius:.3} m, which is no arm{other}")
}

/// A direction along an axis: which, from 0, and its sign.
type Along = (usize, f64);

/// Arm axes along which the instrument axes 1, 2, 3 point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Attitude(pub [Along; 3]);

/// Part of the whole that an axis must read to lie along a direction: within 10 degrees of it.
const DOMINANT: f64 = 0.985;

/// The attitude of a unit that reads `at_rest` and, spinning, `spinning`, both without their bias as far as it is known. The
/// vertical axis reads `+g` upwards at rest, the axis along the arm `-Omega^2 R` outwards; the third completes a
/// right-handed frame. None where no axis lies along either.
fn attitude(at_rest: &[f64; 3], spinning: &[f64; 3]) -> Option<Attitude> {
    let (up, up_sign) = dominant(at_rest)?;
    let change = [0, 1, 2].map(|j| spinning[j] - at_rest[j]);
    let (arm, pull_sign) = dominant(&change)?;
    if arm == up {
        return None;
    }
    let arm_sign = -pull_sign;
    let across = 3 - up - arm;
    // Rows of the attitude are instrument axes in arm axes: its determinant is 1.
    let mut attitude = [(0, 0.0); 3];
    (attitude[up], attitude[arm], attitude[across]) = ((2, up_sign), (0, arm_sign), (1, 1.0));
    let sign = determinant(&attitude);
    attitude[across].1 = sign;
    Some(Attitude(attitude))
}

/// The axis along which nearly all of `f` lies, and its sign.
fn dominant(f: &[f64; 3]) -> Option<Along> {
    let norm = f.iter().map(|x| x * x).sum::<f64>().sqrt();
    let axis = (0..3).max_by(|&i, &j| f[i].abs().total_cmp(&f[j].abs()))?;
    (norm > 0.0 && f[axis].abs() >= DOMINANT * norm).then(|| (axis, f[axis].signum()))
}

/// Determinant of the matrix whose rows are unit vectors along axes.
fn determinant(rows: &[Along; 3]) -> f64 {
    let [(a, s), (b, t), (c, u)] = *rows;
    let is_even = matches!((a, b, c), (0, 1, 2) | (1, 2, 0) | (2, 0, 1));
    s * t * u * if is_even { 1.0 } else { -1.0 }
}

impl Attitude {
    /// As an experiment file has it: `"+2 -3 +1"`.
    pub(super) fn axes(&self) -> String {
        axes_text(&self.0)
    }

    /// The instrument axis that is vertical, and its sign: the two positions of a pair share it.
    pub(super) fn vertical(&self) -> Option<(usize, bool)> {
        let axis = self.0.iter().position(|(arm_axis, _)| *arm_axis == 2)?;
        Some((axis, self.0[axis].1 > 0.0))
    }
}

/// What radii are rounded to [m].
const ROUND: f64 = 5e-3;

/// Without the same number of mountings in all positions: the relative gap between radii of two seats.
const GAP: f64 = 0.15;

/// The radius of the seat of every mounting [m], from the radii of the proof masses along the arm. They differ from that of the reference
/// point by the place of the proof mass, which turns its sign from position to position. So the mean over the mountings of a seat is that of
/// the seat to a few millimetres, and drawings have round numbers.
fn seats(attitudes: &[Option<Attitude>], radii: &[Option<f64>]) -> Vec<Option<f64>> {
    let seen: Vec<usize> = (0..radii.len()).filter(|&m| radii[m].is_some() && attitudes[m].is_some()).collect();
    let radius = |m: usize| radii[m].unwrap_or_default();
    let fellows = |m: usize| seen.iter().filter(move |&&n| attitudes[n] == attitudes[m]);
    let rank = |m: usize| fellows(m).filter(|&&n| (radius(n), n) < (radius(m), m)).count();
    let is_regular = seen.iter().all(|&m| fellows(m).count() == fellows(seen[0]).count());
    let groups = if is_regular { seen.iter().map(|&m| rank(m)).collect() } else { by_gaps(&seen, radius) };
    let mut seats = vec![None; radii.len()];
    for (&m, group) in seen.iter().zip(&groups) {
        let same: Vec<f64> = seen.iter().zip(&groups).filter(|(_, g)| *g == group).map(|(&n, _)| radius(n)).collect();
        let mean = same.iter().sum::<f64>() / same.len() as f64;
        seats[m] = Some((mean / ROUND).round() * ROUND);
    }
    seats
}

/// Groups of radii that follow each other without a gap.
fn by_gaps(seen: &[usize], radius: impl Fn(usize) -> f64) -> Vec<usize> {
    let mut sorted: Vec<usize> = (0..seen.len()).collect();
    sorted.sort_by(|&a, &b| radius(seen[a]).total_cmp(&radius(seen[b])));
    let mut groups = vec![0; seen.len()];
    for pair in sorted.windows(2) {
        let (small, large) = (radius(seen[pair[0]]), radius(seen[pair[1]]));
        groups[pair[1]] = groups[pair[0]] + usize::from(large - small > GAP * large);
    }
    groups
}

const RPM: f64 = PI / 30.0;

/// A set point as a schedule has it.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Set {
    /// At rest, at an angle that no file shows.
    Rest,
    /// A speed as text, such as `133.8 rpm`.
    Speed(String),
    /// A plateau in the readings whose speed no file states.
    Unknown,
}

/// The schedules of the mountings. People set round numbers: the speed is the one with the fewest digits that all
/// observations of it allow.
fn schedules(mountings: &[SeenMounting]) -> Vec<Vec<Set>> {
    let speeds: Vec<[f64; 2]> =
        mountings.iter().flat_map(|m| &m.plateaus).filter_map(|plateau| plateau.speed).collect();
    let set = |plateau: &super::sighting::SeenPlateau| match (plateau.is_rest(), plateau.speed) {
        (Some(true), _) => Set::Rest,
        (_, Some([omega, _])) => Set::Speed(rounded(omega, &alike(omega, &speeds))),
        (_, None) => Set::Unknown,
    };
    mountings.iter().map(|mounting| mounting.plateaus.iter().map(set).collect()).collect()
}

/// The observations of the same set speed: within a thousandth.
fn alike(omega: f64, speeds: &[[f64; 2]]) -> Vec<[f64; 2]> {
    speeds.iter().filter(|[other, _]| (other - omega).abs() <= 1e-3 * omega.abs()).copied().collect()
}

/// The speed with the fewest digits, in revolutions a minute, that the observations allow; else with eight digits.
fn rounded(omega: f64, alike: &[[f64; 2]]) -> String {
    /// What machines hold, and a tachometer resolves, at best.
    const HELD: f64 = 2e-5;
    let count = alike.len().max(1) as f64;
    let mean = if alike.is_empty() { omega } else { alike.iter().map(|[omega, _]| omega).sum::<f64>() / count };
    let own = alike.iter().map(|[_, u]| u * u).sum::<f64>().sqrt() / count;
    let tolerance = (3.0 * own).max(HELD * mean.abs());
    let rpm = mean / RPM;
    (0..=3)
        .map(|digits| format!("{rpm:.digits$}"))
        .find(|text| text.parse::<f64>().is_ok_and(|value| (value * RPM - mean).abs() <= tolerance))
        .map_or_else(|| format!("{mean:.6} rad/s"), |text| format!("{text} rpm"))
}
