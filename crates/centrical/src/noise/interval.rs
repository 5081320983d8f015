//! Time-interval errors: how far the phase moves within a window.

use std::collections::VecDeque;

use super::Phase;

/// TIE rms: root mean square of `x_(i+m) - x_i` [SP 1065; ITU-T G.810].
///
/// In the phase's unit. It depends on the mean reading, which [`Phase::integrate`] takes off.
pub fn time_interval_rms(phase: &Phase, m: usize) -> Option<f64> {
    let x = phase.points();
    let terms = x.len().checked_sub(m).filter(|&terms| terms > 0)?;
    let square: f64 = (0..terms).map(|i| (x[i + m] - x[i]).powi(2)).sum();
    Some((square / terms as f64).sqrt())
}

/// MTIE: largest peak-to-peak of the phase within any m + 1 consecutive points [SP 1065; ITU-T G.810].
///
/// In the phase's unit, O(N): the extremes of the sliding window stand at the heads of two monotone queues.
pub fn maximum_time_interval(phase: &Phase, m: usize) -> Option<f64> {
    let x = phase.points();
    if m >= x.len() {
        return None;
    }
    let (mut highs, mut lows) = (VecDeque::new(), VecDeque::new());
    let mut largest: f64 = 0.0;
    for i in 0..x.len() {
        push(&mut highs, i, m, |&j| x[j] <= x[i]);
        push(&mut lows, i, m, |&j| x[j] >= x[i]);
        if i >= m {
            largest = largest.max(x[highs[0]] - x[lows[0]]);
        }
    }
    Some(largest)
}

/// Adds `i` behind those it does not outdo and drops what has left the window of m + 1.
fn push(queue: &mut VecDeque<usize>, i: usize, m: usize, outdone: impl Fn(&usize) -> bool) {
    while queue.back().is_some_and(&outdone) {
        queue.pop_back();
    }
    queue.push_back(i);
    while queue[0] + m < i {
        queue.pop_front();
    }
}
