//! Set speeds from the speeds that were seen.

use std::f64::consts::PI;

use super::sighting::SeenMounting;

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
pub(super) fn schedules(mountings: &[SeenMounting]) -> Vec<Vec<Set>> {
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
