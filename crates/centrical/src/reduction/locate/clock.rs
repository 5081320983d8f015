//! The centrifuge's clock against the unit's, from the ramps that both recorded.

use std::ops::Range;

use crate::reduction::plateau::ScheduledPlateau;
use crate::reduction::survey::Blocks;
use crate::statistics::{MAD, median};

/// Telemetry of the centrifuge, on its own clock.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SpeedTrace {
    /// Time on the centrifuge's clock [s], not decreasing.
    pub t: Vec<f64>,
    /// Speed [rad/s], either sign.
    pub omega: Vec<f64>,
}

/// The unit's time less the centrifuge's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClockOffset {
    /// Median over the ramps [s].
    pub seconds: f64,
    /// Standard uncertainty, from the scatter of the ramps [s]; infinite for a single ramp.
    pub standard_uncertainty: f64,
    /// Ramps that agree.
    pub ramps: usize,
}

/// Estimates the offset: on every ramp the square of the speed, and with it the force, passes the middle between
/// two plateaus at one instant. `None` if no ramp of the record is in the telemetry.
pub(super) fn offset(
    blocks: &Blocks,
    schedule: &[ScheduledPlateau],
    cores: &[Range<usize>],
    telemetry: &SpeedTrace,
) -> Option<ClockOffset> {
    let ramps = (1..cores.len()).filter_map(|k| Ramp::find(blocks, schedule, cores, k));
    let offsets: Vec<Vec<f64>> = ramps.map(|ramp| ramp.offsets(telemetry)).collect();
    // One passage may have several partners (the same speeds run twice): the right offset is the one most ramps have.
    let near = |guess: f64| -> Vec<f64> {
        let closest =
            |of_ramp: &Vec<f64>| of_ramp.iter().copied().min_by(|a, b| (a - guess).abs().total_cmp(&(b - guess).abs()));
        offsets.iter().filter_map(closest).filter(|offset| (offset - guess).abs() < blocks.width).collect()
    };
    let guesses = offsets.iter().flatten().copied();
    let best = guesses.max_by(|a, b| near(*a).len().cmp(&near(*b).len()).then(b.abs().total_cmp(&a.abs())))?;
    let mut agreeing = near(best);
    let seconds = median(&mut agreeing);
    let mut scatter: Vec<f64> = agreeing.iter().map(|offset| (offset - seconds).abs()).collect();
    let ramps = agreeing.len();
    // Standard deviation of a median of normal values: sqrt(pi / 2) of the mean's.
    let one = (std::f64::consts::FRAC_PI_2).sqrt() * MAD * median(&mut scatter);
    let standard_uncertainty = if ramps > 1 { one / (ramps as f64).sqrt() } else { f64::INFINITY };
    Some(ClockOffset { seconds, standard_uncertainty, ramps })
}

/// Median speed by the telemetry in a window of the unit's time [rad/s].
pub(super) fn median_speed(telemetry: &SpeedTrace, offset: &ClockOffset, window: [f64; 2]) -> Option<f64> {
    let [from, to] = window.map(|t| t - offset.seconds);
    let inside = telemetry.t.partition_point(|t| *t < from)..telemetry.t.partition_point(|t| *t <= to);
    let mut speeds: Vec<f64> = telemetry.omega.get(inside)?.iter().copied().filter(|omega| omega.is_finite()).collect();
    (!speeds.is_empty()).then(|| median(&mut speeds))
}

/// A passage through the middle between two plateaus.
struct Ramp {
    /// Square of the speed in the middle [rad^2/s^2].
    square: f64,
    rising: bool,
    /// Instant on the unit's clock [s].
    t: f64,
}

impl Ramp {
    /// The ramp before plateau `k`.
    fn find(blocks: &Blocks, schedule: &[ScheduledPlateau], cores: &[Range<usize>], k: usize) -> Option<Self> {
        let (before, after) = (schedule[k - 1].omega.powi(2), schedule[k].omega.powi(2));
        let level = |core: &Range<usize>| blocks.f_z[usize::midpoint(core.start, core.end)];
        let (from, to) = (level(&cores[k - 1]), level(&cores[k]));
        let way = to - from;
        let part = |i: usize| (blocks.f_z[i] - from).dot(&way) / way.norm_squared() - 0.5;
        let ramp = cores[k - 1].end - 1..cores[k].start + 1;
        let t = passages(ramp.map(|i| (blocks.t[i], part(i))), true).next();
        // Plateaus of one speed have no middle.
        t.filter(|_| before != after).map(|t| Self { square: 0.5 * (before + after), rising: after > before, t })
    }

    fn offsets(&self, telemetry: &SpeedTrace) -> Vec<f64> {
        let over = |omega: &f64| omega * omega - self.square;
        let trace = telemetry.t.iter().zip(&telemetry.omega).map(|(t, omega)| (*t, over(omega)));
        passages(trace, self.rising).map(|t| self.t - t).collect()
    }
}

/// Times at which a function passes zero, upwards or downwards, by linear interpolation.
fn passages(values: impl Iterator<Item = (f64, f64)>, upwards: bool) -> impl Iterator<Item = f64> {
    let sign = if upwards { 1.0 } else { -1.0 };
    let mut before: Option<(f64, f64)> = None;
    values.filter(|(t, value)| t.is_finite() && value.is_finite()).filter_map(move |(t, value)| {
        let (t_0, value_0) = before.replace((t, value))?;
        let passes = sign * value_0 < 0.0 && sign * value >= 0.0;
        passes.then(|| t_0 + (t - t_0) * value_0 / (value_0 - value))
    })
}
