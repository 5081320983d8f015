//! What all mountings together show.

use super::attitude::{Attitude, attitude};
use super::output_unit::OutputUnit;
use super::raw::Extremes;
use super::schedule::{Set, schedules};
use super::seats::seats;
use super::sighting::SeenMounting;
use super::tumbled::Tumbled;
use crate::error::Error;
use crate::quantity::Dimension;

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
        let radii = seats(&attitudes, &radii(&in_si));
        Ok(Self { unit, attitudes, radii, schedules: schedules(mountings) })
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

/// The unit in which the median radius is nearest to the usual one, from radii of speeds that count as in rad/s.
fn speed_unit(radii: &[Option<f64>]) -> Option<&'static str> {
    let mut radii: Vec<f64> = radii.iter().copied().flatten().filter(|radius| *radius > 0.0).collect();
    radii.sort_by(f64::total_cmp);
    let median = *radii.get(radii.len() / 2)?;
    let farness = |unit: &str| {
        let factor = Dimension::Speed.factor(unit).unwrap_or(f64::NAN);
        (median / factor.powi(2) / USUAL_RADIUS).ln().abs()
    };
    UNITS.into_iter().min_by(|a, b| farness(a).total_cmp(&farness(b)))
}
