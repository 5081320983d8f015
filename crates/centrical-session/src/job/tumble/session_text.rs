//! The experiment file of rests that were found in records.

use std::fmt::Write as _;

use centrical::reduction::{CoarseScale, PlateauMean, Rests};

use super::request::TumbleRequest;
use crate::experiment::Turning;

/// Name of the table of rests.
pub(super) const TABLE: &str = "rests.csv";

/// Name of the table of their attitudes.
pub(super) const ATTITUDES: &str = "attitudes.csv";

/// The experiment file of rests in a table beside it, of readings with this coarse scale where they are in no unit of acceleration.
pub(super) fn session_text(request: &TumbleRequest, coarse: Option<&CoarseScale>, rests: &Rests) -> String {
    let mut text = String::new();
    let mut line = |line: String| {
        // Writing to a String does not fail.
        let _ = writeln!(text, "{line}");
    };
    let names: Vec<String> = request.files.iter().map(|file| file.display().to_string()).collect();
    line("# Rests in attitudes of their own, found by `centrical tumble`.".to_owned());
    line(format!("[session]\ntitle = {:?}\ndate = {:?}\n", format!("Rests of {}", names.join(", ")), request.date));
    line(format!("[site]\ngravity = \"{:?} m/s^2\"\n", request.gravity));
    line(format!("[uncertainty]\ngravity = \"{:?} m/s^2\"\n", request.gravity_uncertainty));
    line(format!("[unit]\nserial = {:?}", request.serial));
    match coarse {
        Some(CoarseScale { scale, bias }) => {
            let key = if request.unit == "V" { "volts" } else { "counts" };
            line(format!("output_unit = {:?}", if key == "volts" { "V" } else { "counts" }));
            line(format!("{key} = {{ scale = {:?}, bias = {:?} }}\n", scale.as_slice(), bias.as_slice()));
        }
        None => line(format!("output_unit = {:?}\n", request.unit)),
    }
    line(format!("[model]\nerror_model = {:?}\n", request.terms));
    line(format!("[[tumble]]\nrests = {TABLE:?}"));
    if rests.noise_at_most > 1.0 {
        line(format!("noise_at_most = {:?}", rests.noise_at_most));
    }
    if let Some(Turning { arcs, share, rate, radius, acceleration }) = turning(request, rests) {
        line(format!(
            "turning = {{ arcs = {arcs}, share = {share:?}, rate = \"{rate:?} rad/s\", radius = \"{radius:?} m\", acceleration = \"{acceleration:?} m/s^2\" }}"
        ));
    }
    if let Some(attitudes) = &request.attitudes {
        let uncertainty = attitudes.uncertainty;
        line(format!("attitudes = {ATTITUDES:?}\nattitude_uncertainty = \"{uncertainty:?} rad\""));
    }
    text
}

/// Slow rotation among the rests. The acceleration of a proof mass at the distance `r` from the axis is `(omega^2 + d omega/dt) r` at most, and
/// its direction stays in axes of the unit: a rectangular distribution in each.
fn turning(request: &TumbleRequest, rests: &Rests) -> Option<Turning> {
    let (found, radius) = (rests.turning?, request.turning_radius?);
    let weight = |rest: &&PlateauMean| {
        let along = rest.mean.normalize();
        1.0 / along.dot(&(rest.covariance * along))
    };
    let all = || rests.means.iter().flatten();
    let share = all().filter(|rest| rest.turns).map(|rest| weight(&rest)).sum::<f64>()
        / all().map(|rest| weight(&rest)).sum::<f64>();
    Some(Turning {
        arcs: found.arcs,
        share,
        rate: found.rate,
        radius,
        acceleration: radius * found.spin / 3_f64.sqrt(),
    })
}
