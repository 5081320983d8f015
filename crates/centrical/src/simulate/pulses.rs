//! Times of the pulses of an index mark or an encoder on the axis.

use super::draw::Draw;
use super::equipment::Counter;
use super::motion::Motion;

/// Times of all pulses [s] on a clock that is `offset` from the unit's as the record begins.
///
/// An error of the counter's speed on a plateau is an error of its time base there.
pub(super) fn times(motion: &Motion, counter: &Counter, offset: f64, seed: u64, mounting: usize) -> Vec<f64> {
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
