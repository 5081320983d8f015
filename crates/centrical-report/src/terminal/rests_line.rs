//! The attitudes of all rests beside the arm in one line.

use crate::number::two_digits;

/// `theta of 26 rests`: the attitude of each rest is two angles.
pub(super) fn rests_name(angles: usize) -> String {
    format!("theta of {} rests", angles / 2)
}

/// `1.7 to 2.3`; `lost` if one of them is lost.
pub(super) fn extent(uncertainties: impl Iterator<Item = Option<f64>>) -> String {
    let extremes = uncertainties.map(|u| u.map(|u| (u, u)));
    match extremes.reduce(|a, b| a.zip(b).map(|((low, high), (u, _))| (low.min(u), high.max(u)))).flatten() {
        Some((low, high)) => format!("{} to {}", two_digits(low), two_digits(high)),
        None => "lost".to_owned(),
    }
}
