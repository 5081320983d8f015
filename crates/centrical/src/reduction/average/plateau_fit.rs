//! The fit of a plateau's window: the mean, the other terms, and the sums for the covariance.

use nalgebra::Vector3;

use super::cells::Cells;
use super::samples::CELLS;
use crate::reduction::locate::Shape;
use crate::reduction::plateau::LeftOut;

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
    /// Residuals and design, summed by cell.
    pub(in crate::reduction) cells: Cells,
}

impl PlateauFit {
    /// Derivative of the settling's law by the logarithm of its time constant, one value a cell.
    pub(in crate::reduction) fn settling_rate(&self) -> Option<Vec<f64>> {
        let settling = self.shape.settling?;
        Some((0..CELLS).map(|cell| settling.rate((cell as f64 + 0.5) * self.cells.width)).collect())
    }
}
