//! The fit of a plateau's window: the mean, the other terms, and the sums for the covariance.

use nalgebra::Vector3;

use super::cells::{CELLS, Cells};
use super::strips::Fitted;
use crate::reduction::locate::{Shape, Window};
use crate::reduction::plateau::LeftOut;
use crate::reduction::survey::Blocks;
use crate::reduction::triangle::{TERMS, Triangle};

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
    /// Variance of a sample about the fit [m^2/s^4].
    pub(in crate::reduction) variance: Vector3<f64>,
    /// Settling at the start of the window [m/s^2].
    pub(in crate::reduction) settling: Vector3<f64>,
    /// Residuals and design, summed by cell.
    pub(in crate::reduction) cells: Cells,
}

impl PlateauFit {
    /// The fit of all samples of a window.
    pub(super) fn new(
        window: &Window,
        blocks: &Blocks,
        fitted: &Fitted,
        left_out: LeftOut,
        coefficients: &[Vector3<f64>],
        triangle: &Triangle,
    ) -> Self {
        let Window { span, shape } = window;
        let kept = fitted.good();
        let squares: Vector3<f64> = fitted.sums(coefficients).map(|(_, sums)| sums.squares).sum();
        let columns = coefficients.len();
        let zero = Vector3::zeros();
        Self {
            window: *span,
            samples: kept,
            rejected: fitted.bad(),
            left_out,
            mean: coefficients[columns - 1],
            once_per_revolution: if shape.omega == 0.0 { [zero; 2] } else { [coefficients[0], coefficients[1]] },
            settling: shape.settling.map_or(zero, |_| coefficients[columns - 2]),
            shape: *shape,
            digit: blocks.digit,
            variance: squares / kept as f64,
            cells: cells(*span, blocks.interval, fitted, triangle, coefficients),
        }
    }

    /// Derivative of the settling's law by the logarithm of its time constant, one value a cell.
    pub(in crate::reduction) fn settling_rate(&self) -> Option<Vec<f64>> {
        let settling = self.shape.settling?;
        Some((0..CELLS).map(|cell| settling.rate((cell as f64 + 0.5) * self.cells.width)).collect())
    }
}

/// The strips' sums, gathered by cell.
fn cells(
    [from, to]: [f64; 2],
    interval: f64,
    fitted: &Fitted,
    triangle: &Triangle,
    coefficients: &[Vector3<f64>],
) -> Cells {
    let terms = coefficients.len();
    let mut cells = Cells::empty(triangle, terms, (to - from) / CELLS as f64, interval);
    let mut sums = vec![(0, Vector3::zeros(), [0.0; TERMS]); CELLS];
    for (cell, of_strip) in fitted.sums(coefficients) {
        let (count, residuals, columns) = &mut sums[cell];
        *count += of_strip.count;
        *residuals += of_strip.residuals;
        columns.iter_mut().zip(of_strip.columns).for_each(|(sum, of_strip)| *sum += of_strip);
    }
    for (cell, (count, residuals, columns)) in sums.into_iter().enumerate() {
        cells.fill(cell, count, residuals, &triangle.orthonormal(columns, terms)[..terms]);
    }
    cells
}
