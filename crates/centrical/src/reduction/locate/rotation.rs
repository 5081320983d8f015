//! The sense of rotation and the unit of time, from the ramps: plateaus hardly show them, since the centripetal part goes with the
//! square of the speed. While the speed changes, a proof mass at the radius `R` has the tangential acceleration `dOmega/dt R`.

use std::ops::Range;

use nalgebra::Vector3;

use super::hypothesis::{Line, ODDS};
use crate::reduction::error::ReductionError;
use crate::reduction::plateau::ScheduledPlateau;
use crate::reduction::survey::Blocks;

/// Refuses a record whose ramps fit the other sense of rotation, or a smaller unit of time, decisively better.
///
/// For a ramp, `S` is the sum of squares of the readings across the line from one plateau to the next, less the
/// tangential part as expected or with the other sign. A ramp counts as two independent readings, the two directions
/// across the way, however many samples it has: then the odds of the two senses are `S- / S+`. Time in ms that is taken for s makes the
/// tangential part a thousand times as large as expected, and is refused by the same odds.
pub(super) fn check(
    blocks: &Blocks,
    schedule: &[ScheduledPlateau],
    cores: &[Range<usize>],
) -> Result<(), ReductionError> {
    let Some(tangential_z) = per_acceleration(schedule) else { return Ok(()) };
    let ramps: Vec<Ramp> =
        (1..cores.len()).filter_map(|k| Ramp::seen(blocks, schedule, cores, k, &tangential_z)).collect();
    let log_odds: f64 = ramps.iter().map(|ramp| (ramp.off_expected / ramp.off(-1.0)).ln()).sum();
    let (product, square) = ramps.iter().fold((0.0, 0.0), |(p, s), ramp| (p + ramp.product, s + ramp.square));
    let (ramps_seen, part) = (ramps.len(), product / square);
    if log_odds >= -ODDS.ln() {
        return Err(ReductionError::Rotation { ramps: ramps_seen, part });
    }
    // Readings that are not linear bend the way as a tangential part does, and as much as a thousand of it only in ramps of hours.
    for (unit, factor) in [("ms", 1e3), ("us", 1e6), ("ns", 1e9)] {
        let log_odds: f64 = ramps.iter().map(|ramp| (ramp.off(factor) / ramp.off_expected).ln()).sum();
        if log_odds < ODDS.ln() {
            return Err(ReductionError::TimeUnit { ramps: ramps_seen, part, unit });
        }
    }
    Ok(())
}

/// Nominal reading per angular acceleration about the third arm axis [m]: of the plumb line `up` and the pull
/// `f = a + Omega^2 c` it is `up x (-c)`.
fn per_acceleration(schedule: &[ScheduledPlateau]) -> Option<Vector3<f64>> {
    let line = Line::through(schedule.iter().map(|p| (p.omega, p.nominal_z)))?;
    let up = line.a.try_normalize(0.0)?;
    Some(up.cross(&-line.c))
}

/// The evidence of a ramp.
struct Ramp {
    /// Sum of squares less the expected tangential part [m^2/s^4].
    off_expected: f64,
    /// Product of the readings with the expected part, and its square [m^2/s^4].
    product: f64,
    square: f64,
}

impl Ramp {
    /// Sum of squares less `factor` times the expected tangential part: -1 for the other sense, 1000 for time in ms taken for s. Rounding leaves
    /// no less than nothing of a ramp that fits.
    fn off(&self, factor: f64) -> f64 {
        let off = self.off_expected + 2.0 * (1.0 - factor) * self.product + (factor * factor - 1.0) * self.square;
        off.max(f64::MIN_POSITIVE)
    }

    /// The ramp before plateau `k`; `None` if the speed does not change or changes its sign.
    fn seen(
        blocks: &Blocks,
        schedule: &[ScheduledPlateau],
        cores: &[Range<usize>],
        k: usize,
        tangential_z: &Vector3<f64>,
    ) -> Option<Self> {
        let (before, after) = (schedule[k - 1].omega, schedule[k].omega);
        let (from, to) = (blocks.level(&cores[k - 1]), blocks.level(&cores[k]));
        let way = to - from;
        if before * after < 0.0 || before == after || way == Vector3::zeros() {
            return None;
        }
        let part = |i: usize| (blocks.f_z[i] - from).dot(&way) / way.norm_squared();
        let square = |i: usize| before * before + part(i).clamp(0.0, 1.0) * (after * after - before * before);
        let omega = |i: usize| (before + after).signum() * square(i).sqrt();
        let mut ramp = Self { off_expected: 0.0, product: 0.0, square: 0.0 };
        for i in cores[k - 1].end..cores[k].start.min(blocks.len() - 1) {
            let (previous, next) = (i.checked_sub(1)?, i + 1);
            let acceleration = (omega(next) - omega(previous)) / (blocks.t[next] - blocks.t[previous]);
            let expected = tangential_z * acceleration;
            let across = blocks.f_z[i] - from - way * part(i);
            ramp.off_expected += (across - expected).norm_squared();
            ramp.product += across.dot(&expected);
            ramp.square += expected.norm_squared();
        }
        (ramp.off_expected > 0.0).then_some(ramp)
    }
}
