//! Readings in another unit, or with the other sign, whose means alone tell so.
//!
//! Records are asked whether other readings fit better; means have no samples to ask, and one channel of one record fits as poorly either way.

use std::path::PathBuf;

use centrical::{Calibration, Group, STANDARD_GRAVITY};
use nalgebra::Vector3;

use crate::error::{Error, Place};
use crate::experiment::{LARGEST_SCALE_ERROR, RestTable, Session};

/// Of readings in another unit or with the other sign: how many times too large, and what they are.
const OTHER_READINGS: [(f64, &str); 4] = [
    (-1.0, ", as if its sign were reversed"),
    (1.0 / STANDARD_GRAVITY, ", as if in g"),
    (1000.0 / STANDARD_GRAVITY, ", as if in mg"),
    (STANDARD_GRAVITY, ", as if m/s^2 stood for g"),
];

const EXPECTED: &str =
    "0.7 to 1.3 times: readings in the stated unit, with the sign of their axis, and the nominal scale of raw output";

/// Refuses a scale error beyond the largest by three standard uncertainties. Where the readings of some mountings are off and those of others on the
/// same axis are not, the fit shares the fault out among all scales: these mountings are named.
pub(super) fn refuse_scale(calibration: &Calibration, session: &Session) -> Result<(), Error> {
    let (model, fit) = (calibration.data().model(), calibration.fit());
    for (j, parameter) in model.parameters().iter().enumerate().filter(|(_, p)| p.group == Group::Scale) {
        let Some((error, variance)) = fit.value(j).zip(fit.covariance(j, j)) else { continue };
        if error.abs() - 3.0 * variance.sqrt() > LARGEST_SCALE_ERROR {
            refuse_mountings(calibration, session)?;
            let times = 1.0 + error;
            let found = format!(
                "readings of {times:.4} times the specific force ({} = {error:.4}){}",
                parameter.name,
                as_if(times)
            );
            let of_rests = session.rest_tables.iter().flat_map(RestTable::files).next();
            let file = of_rests.filter(|_| session.mountings.is_empty()).unwrap_or(&session.file);
            return Err(Error::content(file, Place::Whole, found, EXPECTED));
        }
    }
    Ok(())
}

/// Refuses the first mounting whose readings of one newtonometer are off, where another mounting shows that newtonometer sound.
fn refuse_mountings(calibration: &Calibration, session: &Session) -> Result<(), Error> {
    for axis in 0..3 {
        let shares = shares(calibration, axis);
        let is_off = |share: f64| (share - 1.0).abs() > LARGEST_SCALE_ERROR;
        if shares.iter().all(|(_, share)| is_off(*share)) {
            continue;
        }
        if let Some(&(mounting, times)) = shares.iter().find(|(_, share)| is_off(*share)) {
            let files = session.mountings.get(mounting);
            let record: Option<&PathBuf> = files.and_then(|files| files.records.get(axis).or(files.records.first()));
            let found = format!(
                "readings of newtonometer {} in mounting {} of {times:.4} times the nominal specific force{}",
                axis + 1,
                mounting + 1,
                as_if(times)
            );
            let expected = format!("{EXPECTED}; other mountings have them");
            return Err(Error::content(record.unwrap_or(&session.file), Place::Whole, found, expected));
        }
    }
    Ok(())
}

/// What readings that many times too large may be.
fn as_if(times: f64) -> &'static str {
    let is_near = |other: f64| (times / other - 1.0).abs() < LARGEST_SCALE_ERROR;
    OTHER_READINGS.iter().find(|(other, _)| is_near(*other)).map_or("", |(_, as_if)| as_if)
}

/// A nominal reading below this part of the whole force says nothing of a scale: the errors of other axes are in it.
const LEAST_PART: f64 = 0.3;

/// The reading of one newtonometer over its nominal one in each mounting on the arm, by least squares over the plateaus that load it.
fn shares(calibration: &Calibration, axis: usize) -> Vec<(usize, f64)> {
    let (data, experiment) = (calibration.data(), calibration.data().model().experiment());
    let share = |mounting: usize| {
        let of_mounting =
            data.observations().iter().filter(|o| experiment.set_points[o.set_point].mounting == mounting);
        let (mut square, mut product) = (0.0, 0.0);
        for observation in of_mounting {
            let force: Vector3<f64> = experiment.nominal(&experiment.set_points[observation.set_point]);
            if force[axis].abs() > LEAST_PART * force.norm() {
                square += force[axis].powi(2);
                product += force[axis] * observation.mean[axis];
            }
        }
        (square > 0.0).then_some((mounting, product / square))
    };
    experiment.mountings_on_arm().filter_map(share).collect()
}
