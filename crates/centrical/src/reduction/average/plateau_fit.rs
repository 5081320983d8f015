//! The fit of a plateau's window: the mean, the other terms, and the sums for the covariance.

use nalgebra::{Matrix3, Vector3};

use super::cells::Cells;
use super::samples::CELLS;
use crate::model::Position;
use crate::reduction::locate::{Shape, TURNING};
use crate::reduction::plateau::{Arc, LeftOut};

/// The fit of one plateau; the cells hold what its covariance needs.
#[derive(Debug, Clone)]
pub struct PlateauFit {
    pub(in crate::reduction) window: [f64; 2],
    pub(in crate::reduction) samples: usize,
    pub(in crate::reduction) rejected: usize,
    pub(in crate::reduction) left_out: LeftOut,
    pub(in crate::reduction) mean: Vector3<f64>,
    pub(in crate::reduction) once_per_revolution: [Vector3<f64>; 2],
    pub(in crate::reduction) shape: Shape,
    /// Last digit of the readings [m/s^2].
    pub(in crate::reduction) digit: Vector3<f64>,
    /// Variance of a sample about the fit [m^2/s^4]; zero where the readings show rounding alone.
    pub(in crate::reduction) variance: Vector3<f64>,
    /// Settling at the start of the window [m/s^2].
    pub(in crate::reduction) settling: Vector3<f64>,
    /// Coefficients of the Legendre polynomials 1 to 3 where the unit turns [m/s^2].
    pub(in crate::reduction) turning: [Vector3<f64>; TURNING],
    /// Residuals and design, summed by cell.
    pub(in crate::reduction) cells: Cells,
    /// Takes readings to the axes and the unit in which the noise is alike on all plateaus: the identity on an arm.
    pub(in crate::reduction) noise_axes: Matrix3<f64>,
}

impl PlateauFit {
    /// The fit of a rest in a hand or on a soft table, of readings whose white noise is `sample_noise` [m/s^2]: noise in the direction `along`
    /// of the readings changes the size of the force. What trembles is the attitude: it moves the reading across that direction, and is in
    /// other axes of the instrument in every attitude. So the noise is alike in axes along and across, and along in units of that
    /// white noise which falls there, `sum u_i^2 sigma_i^2` for the direction `u`.
    pub(in crate::reduction) fn of_rest(self, along: &Vector3<f64>, sample_noise: &Vector3<f64>) -> Self {
        let noise = along.component_mul(sample_noise).norm();
        let upright = Position::free("", along).p_zy.transpose();
        let noise_axes = if noise > 0.0 { upright / noise } else { upright };
        Self { noise_axes, ..self }
    }

    /// Whether the unit turns slowly.
    pub(in crate::reduction) fn turns(&self) -> bool {
        self.shape.turning.is_some()
    }

    /// How the unit turns: derivatives of the reading by those of the polynomials, over the size of the reading. With the half length `h`, in
    /// the middle `P_1' = 1/h`, `P_3' = -3/2h`; on average `P_2'' = 3/h^2`, `P_3'' = 0`.
    pub(in crate::reduction) fn arc(&self) -> Option<Arc> {
        let half = self.shape.turning?.half;
        let ([p1, p2, p3], size) = (self.turning, self.mean.norm());
        Some(Arc { rate: (p1 - p3 * 1.5).norm() / (half * size), bend_z: p2 * (3.0 / (half * half * size)) })
    }

    /// A covariance in the axes of the noise, as one of readings.
    pub(in crate::reduction) fn in_readings(&self, covariance: &Matrix3<f64>) -> Matrix3<f64> {
        // The axes are a rotation and a unit.
        let unit = self.noise_axes.row(0).norm_squared();
        let back = self.noise_axes.transpose() / unit;
        let covariance = back * covariance * back.transpose();
        // Symmetric to the last digit, as a table of plateaus holds it.
        (covariance + covariance.transpose()) * 0.5
    }

    /// Derivative of the settling's law by the logarithm of its time constant, one value a cell.
    pub(in crate::reduction) fn settling_rate(&self) -> Option<Vec<f64>> {
        let settling = self.shape.settling?;
        Some((0..CELLS).map(|cell| settling.rate((cell as f64 + 0.5) * self.cells.width)).collect())
    }
}
