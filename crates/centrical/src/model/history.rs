//! What came before each plateau of a session.

use std::collections::HashMap;

use nalgebra::Vector3;

use super::course::Law;
use super::experiment::{Experiment, History, STANDARD_GRAVITY, SetPoint};

/// The part of a plateau's force, or of a warm-up, that is left on the next.
const REMEMBERED: f64 = 0.5;

/// Fills in the history of every plateau of `experiment`, in the order of its set points.
pub(super) fn fill(experiment: &mut Experiment) {
    let last = experiment.set_points.len().saturating_sub(1).max(1) as f64;
    let (mut memory, mut rise, mut previous, mut force) = (Vector3::zeros(), 0.0, None, None);
    let (mut warm_up, mut heat) = (0.0, 0.0);
    for n in 0..experiment.set_points.len() {
        let set_point = experiment.set_points[n];
        let speed = set_point.omega.abs();
        // A mounting begins at rest.
        let before = previous.filter(|(mounting, _)| *mounting == set_point.mounting).map(|(_, speed)| speed);
        rise = match before {
            None => f64::from(u8::from(speed > 0.0)),
            Some(before) if speed > before => 1.0,
            Some(before) if speed < before => -1.0,
            Some(_) => rise,
        };
        warm_up = match before {
            _ if !experiment.is_on_arm(set_point.mounting) => 0.0,
            None => 1.0,
            Some(_) => REMEMBERED * warm_up,
        };
        let gathered = before.map_or(0.0, |_| heat);
        let given = speed.powi(3) / Law::Speed.full_scale().powf(1.5);
        heat = gathered + given;
        previous = Some((set_point.mounting, speed));
        let here = experiment.nominal(&set_point);
        // A unit that is mounted on the arm has been turned on the way there.
        let is_known = before.is_some() || !experiment.is_on_arm(set_point.mounting);
        let turn = force.filter(|_| is_known).map_or(Vector3::zeros(), |force: Vector3<f64>| (here - force).map(sense));
        force = Some(here);
        let time = n as f64 / last - 0.5;
        experiment.set_points[n].history =
            History { time, warm_up, heat: gathered + given / 2.0, rise, memory, turn, repeats: None };
        memory = (memory + here) * REMEMBERED;
    }
    mark_repeated_rests(&mut experiment.set_points);
}

/// Sense of a change [m/s^2] of a force: 1 or -1 where it is large.
fn sense(change: f64) -> f64 {
    const BY_INTENT: f64 = 0.05 * STANDARD_GRAVITY;
    change / change.hypot(BY_INTENT)
}

/// The first of the set points that are alike, for each: of the same mounting, speed and angle.
pub(super) fn alike(set_points: &[SetPoint]) -> Vec<usize> {
    let mut first = HashMap::new();
    let what = |s: &SetPoint| {
        let angle = if s.is_rest() { s.angle.to_bits() } else { 0 };
        (s.mounting, s.omega.to_bits(), angle, s.speed_uncertainty.map(f64::to_bits))
    };
    set_points.iter().enumerate().map(|(n, set_point)| *first.entry(what(set_point)).or_insert(n)).collect()
}

fn mark_repeated_rests(set_points: &mut [SetPoint]) {
    let mut rests: HashMap<(usize, u64), Vec<usize>> = HashMap::new();
    for (n, rest) in set_points.iter().enumerate().filter(|(_, set_point)| set_point.is_rest()) {
        rests.entry((rest.mounting, rest.angle.to_bits())).or_default().push(n);
    }
    for alike in rests.values().filter(|alike| alike.len() > 1) {
        for &n in alike {
            set_points[n].history.repeats = Some(alike[0]);
        }
    }
}
