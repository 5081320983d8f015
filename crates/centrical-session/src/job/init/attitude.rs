//! The attitude of a unit from its readings.

use crate::experiment::axes_text;

/// A direction along an axis: which, from 0, and its sign.
pub(super) type Along = (usize, f64);

/// Arm axes along which the instrument axes 1, 2, 3 point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Attitude(pub [Along; 3]);

/// Part of the whole that an axis must read to lie along a direction: within 10 degrees of it.
const DOMINANT: f64 = 0.985;

/// The attitude of a unit that reads `at_rest` and, spinning, `spinning`, both without their bias as far as it is known. The
/// vertical axis reads `+g` upwards at rest, the axis along the arm `-Omega^2 R` outwards; the third completes a
/// right-handed frame. None where no axis lies along either.
pub(super) fn attitude(at_rest: &[f64; 3], spinning: &[f64; 3]) -> Option<Attitude> {
    let (up, up_sign) = dominant(at_rest)?;
    let change = [0, 1, 2].map(|j| spinning[j] - at_rest[j]);
    let (arm, pull_sign) = dominant(&change)?;
    if arm == up {
        return None;
    }
    let arm_sign = -pull_sign;
    let across = 3 - up - arm;
    // Rows of the attitude are instrument axes in arm axes: its determinant is 1.
    let mut attitude = [(0, 0.0); 3];
    (attitude[up], attitude[arm], attitude[across]) = ((2, up_sign), (0, arm_sign), (1, 1.0));
    let sign = determinant(&attitude);
    attitude[across].1 = sign;
    Some(Attitude(attitude))
}

/// The axis along which nearly all of `f` lies, and its sign.
fn dominant(f: &[f64; 3]) -> Option<Along> {
    let norm = f.iter().map(|x| x * x).sum::<f64>().sqrt();
    let axis = (0..3).max_by(|&i, &j| f[i].abs().total_cmp(&f[j].abs()))?;
    (norm > 0.0 && f[axis].abs() >= DOMINANT * norm).then(|| (axis, f[axis].signum()))
}

/// Determinant of the matrix whose rows are unit vectors along axes.
fn determinant(rows: &[Along; 3]) -> f64 {
    let [(a, s), (b, t), (c, u)] = *rows;
    let is_even = matches!((a, b, c), (0, 1, 2) | (1, 2, 0) | (2, 0, 1));
    s * t * u * if is_even { 1.0 } else { -1.0 }
}

impl Attitude {
    /// As an experiment file has it: `"+2 -3 +1"`.
    pub(super) fn axes(&self) -> String {
        axes_text(&self.0)
    }

    /// The instrument axis that is vertical, and its sign: the two positions of a pair share it.
    pub(super) fn vertical(&self) -> Option<(usize, bool)> {
        let axis = self.0.iter().position(|(arm_axis, _)| *arm_axis == 2)?;
        Some((axis, self.0[axis].1 > 0.0))
    }
}
