//! The centrifuge's own report of its speed, by its own clock: telemetry, and pulses of an index mark or an encoder on the axis.

use super::draw::Draw;
use super::equipment::{Counter, Tachometer};
use super::motion::Motion;
use crate::reduction::SpeedTrace;

/// The centrifuge's clock less the unit's as the record begins [s], and its rate against the unit's, less 1.
pub(super) fn clock(tachometer: &Tachometer, seed: u64, mounting: usize) -> [f64; 2] {
    let mut random = Draw::Clock.stream(seed, mounting);
    let offset = tachometer.clock_offset * (2.0 * random.uniform() - 1.0);
    [offset, tachometer.clock_drift * random.normal()]
}

/// The telemetry of one mounting, its times by the centrifuge's clock: `offset + (1 + drift) t`, `t` on the unit's clock.
pub(super) fn telemetry(motion: &Motion, tachometer: &Tachometer, seed: u64, mounting: usize) -> SpeedTrace {
    let [offset, drift] = clock(tachometer, seed, mounting);
    let mut random = Draw::Tachometer.stream(seed, mounting);
    let times = (0_u64..).map(|n| n as f64 / tachometer.rate).take_while(|t| *t <= motion.duration());
    let errors = motion.measured_errors(tachometer.plateau_error, seed, mounting);
    let mut trace = SpeedTrace { t: Vec::new(), omega: Vec::new() };
    for t in times {
        let noise = if tachometer.noise > 0.0 { tachometer.noise * random.normal() } else { 0.0 };
        let speed = if tachometer.measures {
            let (speed, segment) = motion.true_speed(t);
            speed * (1.0 + errors.get(segment).copied().unwrap_or(0.0))
        } else {
            motion.believed_speed(t)
        };
        let omega = speed * (1.0 + tachometer.scale_error) + noise;
        let quantum = tachometer.quantum;
        trace.t.push(offset + (1.0 + drift) * t);
        trace.omega.push(if quantum > 0.0 { (omega / quantum).round() * quantum } else { omega });
    }
    trace
}

/// Times of all pulses [s] on a clock that is `offset` from the unit's as the record begins.
///
/// An error of the counter's speed on a plateau is an error of its time base there.
pub(super) fn pulses(motion: &Motion, counter: &Counter, offset: f64, seed: u64, mounting: usize) -> Vec<f64> {
    let errors = motion.measured_errors(counter.plateau_error, seed, mounting);
    let mut random = Draw::Counter.stream(seed, mounting);
    let step = std::f64::consts::TAU / counter.per_revolution;
    let mut shown = offset;
    let mut times = Vec::new();
    for (segment, error) in errors.iter().enumerate() {
        let (passages, duration) = motion.passages(segment, step);
        let rate = 1.0 / ((1.0 + counter.scale_error) * (1.0 + error));
        times.extend(passages.into_iter().map(|since| {
            let jitter = if counter.jitter > 0.0 { counter.jitter * random.normal() } else { 0.0 };
            shown + rate * since + jitter
        }));
        shown += rate * duration;
    }
    times.sort_by(f64::total_cmp);
    times
}
