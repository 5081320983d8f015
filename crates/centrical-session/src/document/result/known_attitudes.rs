//! What known attitudes show beside their own errors.

use nalgebra::Vector3;

use super::schema::{CalibrationResult, PositionSummary};

/// Attitudes nearer than this are taken for one: a rest takes the nearest.
const NEAR: f64 = 0.1;

impl CalibrationResult {
    /// Whether the known attitudes show the sign of each axis and which column is which. Gravity alone does not; nor do attitudes
    /// that another sign or order of the columns takes to one another, as it does the faces of a cube.
    pub fn attitudes_show_columns(&self) -> bool {
        let is_known = |position: &&PositionSummary| position.attitude_uncertainty.is_some();
        let ups: Vec<Vector3<f64>> = self.model.positions.iter().filter(is_known).map(up).collect();
        let is_near = |up: &Vector3<f64>| ups.iter().any(|other| (up - other).norm() < NEAR);
        !ups.is_empty() && !columns_otherwise().any(|columns| ups.iter().all(|up| is_near(&columns(up))))
    }
}

/// The vertical in instrument axes, which the matrix of a position takes from the third axis.
fn up(position: &PositionSummary) -> Vector3<f64> {
    Vector3::from_fn(|axis, _| position.matrix[axis][2])
}

/// What another order of three columns, or other signs, make of readings.
fn columns_otherwise() -> impl Iterator<Item = impl Fn(&Vector3<f64>) -> Vector3<f64>> {
    const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    let signs = (0..8_usize).map(|bits| [0, 1, 2].map(|axis| if bits >> axis & 1 == 1 { -1.0 } else { 1.0 }));
    let all = signs.flat_map(|signs| ORDERS.iter().map(move |order| (signs, order)));
    // The first is the order and the signs as they are.
    all.skip(1).map(|(signs, order)| move |up: &Vector3<f64>| Vector3::from_fn(|axis, _| signs[axis] * up[order[axis]]))
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::columns_otherwise;

    #[test]
    fn all_other_signs_and_orders_are_tried() {
        let up = Vector3::new(1.0, 2.0, 3.0);
        let all: Vec<Vector3<f64>> = columns_otherwise().map(|columns| columns(&up)).collect();
        assert_eq!(all.len(), 47);
        assert!(!all.contains(&up));
        assert!(all.iter().enumerate().all(|(n, one)| !all[..n].contains(one)));
    }
}
