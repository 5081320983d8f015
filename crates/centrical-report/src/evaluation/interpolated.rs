//! Interpolated readings.

use centrical_session::CalibrationResult;

/// Readings of newtonometers 1, 2, 3 that were interpolated in all mountings together, those without any left out: axis from 1 and
/// count.
pub(crate) fn interpolated(result: &CalibrationResult) -> Vec<(usize, u64)> {
    let of_axis = |axis: usize| result.mountings.iter().filter_map(|m| m.interpolated).map(|of| of[axis]).sum();
    (0..3).map(|axis| (axis + 1, of_axis(axis))).filter(|(_, count)| *count > 0).collect()
}
