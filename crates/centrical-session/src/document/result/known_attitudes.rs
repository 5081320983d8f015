//! What known attitudes show beside their own errors.

use centrical::reduction::Mistake;
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
        !ups.is_empty() && !Mistake::of_columns().any(|columns| ups.iter().all(|up| is_near(&columns.reading(up))))
    }
}

/// The vertical in instrument axes, which the matrix of a position takes from the third axis.
fn up(position: &PositionSummary) -> Vector3<f64> {
    Vector3::from_fn(|axis, _| position.matrix[axis][2])
}
