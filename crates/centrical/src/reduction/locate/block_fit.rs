//! A plateau fitted through its block levels, over any range of blocks.

use std::ops::Range;

use nalgebra::Vector3;
use pulp::{Simd, WithSimd};

use crate::reduction::simd::{subtract, subtract_all, widest};
use crate::reduction::survey::Blocks;
use crate::reduction::terms::{Rows, Shape, TERMS, Triangle};
use crate::statistics::{MAD, median};

/// Blocks that are orthogonalised once for all ranges.
const SEGMENT: usize = 64;

/// The levels of the blocks about a plateau, with the design of its reading.
pub(super) struct Levels {
    /// The first of the blocks.
    first: usize,
    /// The design, column by column.
    columns: Vec<Vec<f64>>,
    /// The levels, less a reference near them [m/s^2].
    f_z: [Vec<f64>; 3],
    /// The triangle of every `SEGMENT` of them.
    segments: Vec<Triangle>,
    /// Smallest spread that the sampling allows [m/s^2].
    floor: Vector3<f64>,
}

/// The fit over a range of blocks.
pub(super) struct BlockFit<'a> {
    of: &'a Levels,
    /// The blocks, counted from the first of the levels.
    range: Range<usize>,
    triangle: Triangle,
    coefficients: Vec<Vector3<f64>>,
}

impl Levels {
    /// The levels of some blocks, and their design.
    pub fn new(blocks: &Blocks, range: Range<usize>, shape: &Shape) -> Self {
        let reference = blocks.f_z[usize::midpoint(range.start, range.end)];
        let levels = [0, 1, 2].map(|axis| -> Vec<f64> {
            blocks.f_z[range.clone()].iter().map(|level| level[axis] - reference[axis]).collect()
        });
        // Rounded readings may leave no spread at all.
        let floor = blocks.sample_noise_in(&range) * (blocks.interval / blocks.width).sqrt() + blocks.digit / MAD;
        let columns = shape.columns(&blocks.t[range.clone()]);
        let mut all = Self { first: range.start, columns, f_z: levels, segments: Vec::new(), floor };
        all.segments = (0..range.len() / SEGMENT).map(|k| all.triangle(k * SEGMENT..(k + 1) * SEGMENT)).collect();
        all
    }

    /// The fit over a range of blocks; `None` if their design is rank-deficient.
    pub fn fit(&self, range: Range<usize>) -> Option<BlockFit<'_>> {
        let range = range.start - self.first..range.end - self.first;
        let whole = range.start.div_ceil(SEGMENT)..range.end / SEGMENT;
        let parts = if whole.is_empty() {
            vec![self.triangle(range.clone())]
        } else {
            vec![self.triangle(range.start..whole.start * SEGMENT), self.triangle(whole.end * SEGMENT..range.end)]
        };
        let segments = self.segments.get(whole).unwrap_or_default();
        let triangle = Triangle::joined(&parts.iter().chain(segments).collect::<Vec<_>>(), self.columns.len());
        let coefficients = triangle.solve(self.columns.len())?;
        Some(BlockFit { of: self, range, triangle, coefficients })
    }

    /// The triangle of some blocks, fewer than two segments.
    fn triangle(&self, range: Range<usize>) -> Triangle {
        let n = range.len();
        let (mut columns, mut levels) = ([[0.0; 2 * SEGMENT]; TERMS], [[0.0; 2 * SEGMENT]; 3]);
        let rooms = columns[..self.columns.len()].iter_mut().chain(&mut levels);
        for (room, column) in rooms.zip(self.columns.iter().chain(&self.f_z)) {
            room[..n].copy_from_slice(&column[range.clone()]);
        }
        let mut columns = columns.each_mut().map(|column| &mut column[..n]);
        let columns = &mut columns[..self.columns.len()];
        let mut levels = levels.each_mut().map(|level| &mut level[..n]);
        widest(Rows { terms: columns, readings: &mut levels })
    }
}

impl BlockFit<'_> {
    /// The coefficient of the settling, of a shape that has one [m/s^2].
    pub fn settling(&self) -> Vector3<f64> {
        self.coefficients[self.coefficients.len() - 2]
    }

    /// The smallest spread that the sampling allows [m/s^2].
    pub fn floor(&self) -> &Vector3<f64> {
        &self.of.floor
    }

    /// Standard deviation of a block about the fit, robust [m/s^2].
    pub fn scale(&self) -> Vector3<f64> {
        spread(&self.residuals(), &self.of.floor)
    }

    /// Residuals of the levels, per axis [m/s^2].
    pub fn residuals(&self) -> [Vec<f64>; 3] {
        [0, 1, 2].map(|axis| {
            let mut residuals = self.of.f_z[axis][self.range.clone()].to_vec();
            let terms = self.of.columns.iter().zip(&self.coefficients);
            subtract_all(&mut residuals, terms.map(|(column, b)| (b[axis], &column[self.range.clone()])));
            residuals
        })
    }

    /// Orthonormal columns that span the design.
    pub fn orthonormal(&self) -> Vec<Vec<f64>> {
        let mut columns = vec![Vec::new(); self.of.columns.len()];
        for i in self.range.clone() {
            let mut row = [0.0; TERMS];
            row.iter_mut().zip(&self.of.columns).for_each(|(x, column)| *x = column[i]);
            let row = self.triangle.orthonormal(row, columns.len());
            columns.iter_mut().zip(row).for_each(|(column, q)| column.push(q));
        }
        columns
    }

    /// The blocks that are off the fit by more than noise of the given scale: `r^2 > c^2 s^2 (1 - h)`, the leverage `h` being
    /// the part of the noise that the fit absorbs.
    pub fn off(&self, scale: &Vector3<f64>, cut: f64) -> Vec<bool> {
        self.off_among(self.range.clone(), scale, cut)
    }

    /// Whether two neighbouring blocks are off. A ramp shows at an end: the ends are searched first.
    pub fn has_two_off(&self, scale: &Vector3<f64>, cut: f64) -> bool {
        let Range { start, end } = self.range;
        let near = SEGMENT.min(self.range.len());
        let parts = [end - near..end, start..start + near, self.range.clone()];
        let two_off = |part| self.off_among(part, scale, cut).windows(2).any(|pair| pair == [true, true]);
        parts.into_iter().any(two_off)
    }

    fn off_among(&self, range: Range<usize>, scale: &Vector3<f64>, cut: f64) -> Vec<bool> {
        let mut off = vec![false; range.len()];
        for (from, verdicts) in range.clone().step_by(SEGMENT).zip(off.chunks_mut(SEGMENT)) {
            widest(Off { fit: self, from, verdicts, scale, cut });
        }
        off
    }
}

/// Verdicts on the blocks from `from` on, a segment at most.
struct Off<'a> {
    fit: &'a BlockFit<'a>,
    from: usize,
    verdicts: &'a mut [bool],
    scale: &'a Vector3<f64>,
    cut: f64,
}

impl WithSimd for Off<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { fit, from, verdicts, scale, cut } = self;
        let n = verdicts.len();
        let piece = from..from + n;
        let (terms, r) = (fit.coefficients.len(), &fit.triangle.r);
        // The columns of Q, one after another, and the share of the noise that they leave.
        let mut q = [[0.0; SEGMENT]; TERMS];
        let mut left = [1.0; SEGMENT];
        for j in 0..terms {
            let (done, rest) = q.split_at_mut(j);
            let column = &mut rest[0][..n];
            column.copy_from_slice(&fit.of.columns[j][piece.clone()]);
            for (i, q) in done.iter().enumerate() {
                subtract(column, r[j][i], &q[..n]);
            }
            let scale = 1.0 / r[j][j];
            for (q, left) in column.iter_mut().zip(&mut left) {
                *q *= scale;
                *left -= *q * *q;
            }
        }
        // The largest squared residual of the levels, in units of the limit.
        let mut worst = [0.0_f64; SEGMENT];
        for axis in 0..3 {
            let mut residuals = [0.0; SEGMENT];
            let residuals = &mut residuals[..n];
            residuals.copy_from_slice(&fit.of.f_z[axis][piece.clone()]);
            for (column, b) in fit.of.columns.iter().zip(&fit.coefficients) {
                subtract(residuals, b[axis], &column[piece.clone()]);
            }
            let share = 1.0 / (cut * scale[axis]);
            for (worst, r) in worst.iter_mut().zip(residuals) {
                *worst = worst.max((*r * share) * (*r * share));
            }
        }
        for ((off, worst), left) in verdicts.iter_mut().zip(&worst).zip(&left) {
            *off = *worst > left.max(0.0);
        }
    }
}

/// Robust standard deviation about zero per axis, not below the floor.
pub(super) fn spread(residuals: &[Vec<f64>; 3], floor: &Vector3<f64>) -> Vector3<f64> {
    let of = |axis: usize| MAD * median(&mut residuals[axis].iter().map(|r| r.abs()).collect::<Vec<f64>>());
    Vector3::from_fn(|axis, _| of(axis).max(floor[axis]))
}
