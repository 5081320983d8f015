//! Frames, small turns and exact rotations, in the source's sign [section 1 of the notation].
//!
//! | suffix | frame | axes |
//! |---|---|---|
//! | `_x` | reference, Earth-fixed | 1 East, 2 North, 3 Up |
//! | `_y` | arm, rotates with the centrifuge | 1 along the arm, 3 along the rotation axis, 2 right-handed |
//! | `_z` | instrument | 1 along newtonometer 1; 2 in the plane of axes 1, 2; 3 right-handed |
//!
//! `c_zy` takes coordinates in `y` to coordinates in `z`.

use nalgebra::{Matrix3, Vector3};

/// Cross-product matrix in the source's sign, the transpose of the usual one:
/// `hat(v) = [[0, v3, -v2], [-v3, 0, v1], [v2, -v1, 0]]`, so that `hat(v) u = u x v`.
///
/// A frame turned by the small vector `v` [rad] sees the coordinates `(E + hat(v)) u`.
pub fn hat(v: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::new(0.0, v.z, -v.y, -v.z, 0.0, v.x, v.y, -v.x, 0.0)
}

/// Exact rotation whose linear part is `E + hat(v)`: `exp(hat(v))`, Rodrigues' formula.
///
/// `v` is a rotation vector [rad]; the result takes coordinates in a frame to coordinates in the
/// frame turned from it by `v`.
pub fn rotation(v: &Vector3<f64>) -> Matrix3<f64> {
    let (s, c) = series(v.norm());
    let h = hat(v);
    Matrix3::identity() + h * s + h * h * c
}

/// The matrix `J(v)` of the exact differential `d rotation(v) = hat(J(v) dv) rotation(v)`.
///
/// `J = E + c hat(v) + (1 - s)/v^2 hat(v)^2` with `s = sin v / v`, `c = (1 - cos v) / v^2`.
pub fn rotation_rate(v: &Vector3<f64>) -> Matrix3<f64> {
    let angle = v.norm();
    let (s, c) = series(angle);
    let third = if angle < SMALL { (1.0 - angle * angle / 20.0) / 6.0 } else { (1.0 - s) / (angle * angle) };
    let h = hat(v);
    Matrix3::identity() + h * c + h * h * third
}

/// Turn about the third axis by the carousel angle `alpha_3` [rad].
pub fn carousel(alpha_3: f64) -> Matrix3<f64> {
    let (s, c) = alpha_3.sin_cos();
    Matrix3::new(c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0)
}

/// Whether `c` is a right-handed rotation: `c c^T = E` and `det c = +1` to `1e-9`.
pub fn is_rotation(c: &Matrix3<f64>) -> bool {
    // Nine digits: what a matrix keeps that was typed or printed with ten.
    const TYPED: f64 = 1e-9;
    (c * c.transpose() - Matrix3::identity()).amax() < TYPED && (c.determinant() - 1.0).abs() < TYPED
}

/// Below this angle [rad] the series of `sin v / v` and its kin are exact to rounding with two terms.
const SMALL: f64 = 1e-4;

/// `(sin v / v, (1 - cos v) / v^2)`.
fn series(angle: f64) -> (f64, f64) {
    if angle < SMALL {
        let square = angle * angle;
        return (1.0 - square / 6.0, 0.5 - square / 24.0);
    }
    let half = 0.5 * angle;
    let (sin_half, cos_half) = half.sin_cos();
    let sinc_half = sin_half / half;
    (sinc_half * cos_half, 0.5 * sinc_half * sinc_half)
}
