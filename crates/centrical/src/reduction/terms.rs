//! The terms of a plateau's reading in time, and their least squares over many samples.
//!
//! By strips: each strip's design is orthogonalised separately, and the resulting triangles are orthogonalised together (tall
//! and skinny QR; Demmel, Grigori, Hoemmen, Langou 2012). Only a strip that loses a sample is repeated.

use nalgebra::Vector3;
use pulp::{Simd, WithSimd};

use super::simd::{cos_sin, dot, exp, product, subtract, widest};

/// Time constants after which the settling is below the rounding of a reading.
pub(super) const FADED: f64 = 40.0;

/// Terms of a unit that turns, beside the constant.
pub(super) const TURNING: usize = 3;

/// Most columns of a design: two of the revolution, settling, constant; in a slow rotation three of the turning, constant.
pub(super) const TERMS: usize = 4;

/// A remainder of this length, relative to the column, is rounding.
const ROUNDING: f64 = 1e-12;

/// The part of the record that a mean is taken over.
#[derive(Debug, Clone, Copy)]
pub(super) struct Window {
    /// From, to [s].
    pub span: [f64; 2],
    /// The fitted terms.
    pub shape: Shape,
}

/// The terms of a plateau: `[cos, sin,] [settling,] 1`, or `P_1, P_2, P_3, 1` of a unit that turns. The constant stands last.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shape {
    /// Origin of phase and settling [s].
    pub start: f64,
    /// Speed [rad/s]; 0 for no once-per-revolution term.
    pub omega: f64,
    /// The remaining settling.
    pub settling: Option<Settling>,
    /// The unit turns slowly: Legendre polynomials in its place, no other terms.
    pub turning: Option<Interval>,
}

/// An interval of time, on which Legendre polynomials are orthogonal.
#[derive(Debug, Clone, Copy)]
pub(super) struct Interval {
    /// Its middle [s].
    pub middle: f64,
    /// Half of its length [s].
    pub half: f64,
}

/// Settling of the speed by `epsilon exp(-x)`, `x = (t - start) / time`: the force, that goes with the square of the
/// speed, settles by
/// `2 epsilon (exp(-x) + epsilon/2 exp(-2x))`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Settling {
    /// Time constant [s].
    pub time: f64,
    /// `epsilon / 2`: a quarter of the relative error of the force at the start.
    pub bend: f64,
}

impl Settling {
    /// The same counted from `delay` later.
    pub fn after(self, delay: f64) -> Self {
        Self { bend: self.bend * (-delay / self.time).exp(), ..self }
    }

    /// Derivative of the value by the logarithm of the time constant.
    pub fn rate(self, since: f64) -> f64 {
        let x = since / self.time;
        let fading = (-x).exp();
        x * fading * (1.0 + 2.0 * self.bend * fading)
    }

    /// The settling after a time, relative to its linear part at the start.
    #[inline(always)]
    pub fn value(self, since: f64) -> f64 {
        let fading = exp(-since / self.time);
        fading * (1.0 + self.bend * fading)
    }

    /// The same at many instants.
    #[inline(always)]
    fn values(self, start: f64, t: &[f64], values: &mut [f64]) {
        if t.first().is_some_and(|first| first - start > FADED * self.time) {
            values.fill(0.0);
        } else {
            for (t, value) in t.iter().zip(values) {
                *value = self.value(t - start);
            }
        }
    }
}

impl Shape {
    /// Terms of the reading.
    pub fn terms(&self) -> usize {
        let turning = if self.turning.is_some() { TURNING } else { 0 };
        2 * usize::from(self.omega != 0.0) + usize::from(self.settling.is_some()) + turning + 1
    }

    /// The design at the times `t`, one column a term.
    pub fn columns(&self, t: &[f64]) -> Vec<Vec<f64>> {
        let mut columns = vec![vec![0.0; t.len()]; self.terms()];
        let mut rooms = columns.iter_mut().map(Vec::as_mut_slice).collect::<Vec<_>>();
        widest(Design { shape: self, t, columns: &mut rooms });
        columns
    }

    /// The same into existing `columns`, each as long as `t`.
    #[inline(always)]
    pub fn design(&self, t: &[f64], columns: &mut [&mut [f64]]) {
        let mut columns = columns.iter_mut();
        if self.omega != 0.0
            && let (Some(cos), Some(sin)) = (columns.next(), columns.next())
        {
            cos_sin(self.omega, self.start, t, cos, sin);
        }
        if let Some(settling) = self.settling
            && let Some(column) = columns.next()
        {
            settling.values(self.start, t, column);
        }
        if let Some(Interval { middle, half }) = self.turning
            && let (Some(p1), Some(p2), Some(p3)) = (columns.next(), columns.next(), columns.next())
        {
            for (((t, p1), p2), p3) in t.iter().zip(p1.iter_mut()).zip(p2.iter_mut()).zip(p3.iter_mut()) {
                let x = (t - middle) / half;
                (*p1, *p2, *p3) = (x, 1.5 * x * x - 0.5, (2.5 * x * x - 1.5) * x);
            }
        }
        if let Some(constant) = columns.next() {
            constant.fill(1.0);
        }
    }
}

/// A design to be filled in.
struct Design<'a, 'b> {
    shape: &'a Shape,
    t: &'a [f64],
    columns: &'a mut [&'b mut [f64]],
}

impl WithSimd for Design<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.shape.design(self.t, self.columns);
    }
}

/// `X = Q R` and `Z = Q^T F` of a strip or of all: the information of its samples about the coefficients.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Triangle {
    /// Upper triangle: `r[j][i]`, i <= j, so that `x_j = sum_i q_i r[j][i]`.
    pub r: [[f64; TERMS]; TERMS],
    /// `q_j^T f`, per axis.
    pub z: [[f64; 3]; TERMS],
}

impl Triangle {
    /// The triangle of some rows: the columns `terms` of a design become those of `Q`, and the three columns of readings
    /// become their residuals `F - Q Z`. For a [`widest`] work.
    #[inline(always)]
    pub fn of<S: Simd>(simd: S, terms: &mut [&mut [f64]], readings: &mut [&mut [f64]; 3]) -> Self {
        let mut triangle = Self::default();
        for j in 0..terms.len() {
            let (done, rest) = terms.split_at_mut(j);
            let column = &mut *rest[0];
            let mut taken = 0.0;
            for (i, q) in done.iter().enumerate() {
                // The column of a faded settling is zero.
                if triangle.r[i][i] == 0.0 {
                    continue;
                }
                let projection = dot(simd, q, column);
                subtract(column, projection, q);
                triangle.r[j][i] = projection;
                taken += projection * projection;
            }
            let square = dot(simd, column, column);
            // A column that depends on those before it within a strip adds no direction; rounding must not make one up.
            if square.is_nan() || square <= ROUNDING * ROUNDING * taken {
                column.fill(0.0);
                continue;
            }
            let left = square.sqrt();
            triangle.r[j][j] = left;
            let scale = 1.0 / left;
            for c in column.iter_mut() {
                *c *= scale;
            }
            for (axis, f) in readings.iter_mut().enumerate() {
                let projection = dot(simd, column, f);
                subtract(f, projection, column);
                triangle.z[j][axis] = projection;
            }
        }
        triangle
    }

    /// The triangle of all rows from those of the strips.
    pub fn joined(strips: &[&Self], terms: usize) -> Self {
        let rows = strips.len() * terms;
        let mut room = vec![0.0; rows * (terms + 3)];
        let (design, readings) = room.split_at_mut(rows * terms);
        for (s, strip) in strips.iter().enumerate() {
            for j in 0..terms {
                design[j * rows + s * terms..][..=j].copy_from_slice(&strip.r[j][..=j]);
                for axis in 0..3 {
                    readings[axis * rows + s * terms + j] = strip.z[j][axis];
                }
            }
        }
        let mut columns: Vec<&mut [f64]> = design.chunks_exact_mut(rows).collect();
        let (first, rest) = readings.split_at_mut(rows);
        let (second, third) = rest.split_at_mut(rows);
        widest(Rows { terms: &mut columns, readings: &mut [first, second, third] })
    }

    /// Coefficients per axis of the readings by the columns of a design. `None` if these are dependent.
    pub fn fit(mut columns: Vec<Vec<f64>>, mut readings: [Vec<f64>; 3]) -> Option<Vec<Vector3<f64>>> {
        let mut terms: Vec<&mut [f64]> = columns.iter_mut().map(Vec::as_mut_slice).collect();
        let readings = &mut readings.each_mut().map(Vec::as_mut_slice);
        widest(Rows { terms: &mut terms, readings }).solve(columns.len())
    }

    /// The residuals of the readings in the directions of `Q`, for coefficients per axis: `Z - R B`.
    #[inline(always)]
    pub fn left(&self, coefficients: &[[f64; 3]]) -> [[f64; 3]; TERMS] {
        let mut left = self.z;
        for (column, b) in self.r.iter().zip(coefficients) {
            for (left, r) in left.iter_mut().zip(column) {
                left.iter_mut().zip(b).for_each(|(left, b)| *left -= r * b);
            }
        }
        left
    }

    /// Coefficients per axis. `None` if a column depends on those before it to within `1e-6` of its length.
    pub fn solve(&self, terms: usize) -> Option<Vec<Vector3<f64>>> {
        // Half the digits of f64: below this a column is rounding.
        const DEPENDENT: f64 = 1e-6;
        let mut b: Vec<Vector3<f64>> = self.z[..terms].iter().map(|z| Vector3::from(*z)).collect();
        for j in (0..terms).rev() {
            let (own, length) = (self.r[j][j], product(&self.r[j], &self.r[j]).sqrt());
            if own.is_nan() || own <= DEPENDENT * length {
                return None;
            }
            b[j] /= own;
            for i in 0..j {
                let known = b[j] * self.r[j][i];
                b[i] -= known;
            }
        }
        Some(b)
    }

    /// Sums of the orthonormal columns over some rows from the sums of the design's columns: `R^-T` of them.
    pub fn orthonormal(&self, mut sums: [f64; TERMS], terms: usize) -> [f64; TERMS] {
        for j in 0..terms {
            for i in 0..j {
                sums[j] -= sums[i] * self.r[j][i];
            }
            sums[j] /= self.r[j][j];
        }
        sums
    }
}

/// Rows to be made a triangle of.
pub(super) struct Rows<'a, 'b> {
    /// Columns of a design.
    pub terms: &'a mut [&'b mut [f64]],
    /// Three columns of readings.
    pub readings: &'a mut [&'b mut [f64]; 3],
}

impl WithSimd for Rows<'_, '_> {
    type Output = Triangle;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Triangle {
        Triangle::of(simd, self.terms, self.readings)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The coefficients and the triangle of all rows at once, and by strips.
    #[test]
    fn strips_are_the_whole() {
        let rows = 1000;
        let x: [Vec<f64>; 3] = [
            (0..rows).map(|i| (0.37 * i as f64).cos()).collect(),
            (0..rows).map(|i| (-0.05 * i as f64).exp()).collect(),
            vec![1.0; rows],
        ];
        let f = [0, 1, 2].map(|a| -> Vec<f64> {
            let noise = |i: usize| ((i * i * 7919 + a) % 101) as f64 / 101.0;
            (0..rows).map(|i| 3.0 * x[0][i] - 0.5 * x[1][i] + a as f64 + noise(i)).collect()
        });
        let of = |range: std::ops::Range<usize>| {
            let (mut x, mut f) =
                (x.clone().map(|x| x[range.clone()].to_vec()), f.clone().map(|f| f[range.clone()].to_vec()));
            let (terms, readings) =
                (&mut x.each_mut().map(Vec::as_mut_slice), &mut f.each_mut().map(Vec::as_mut_slice));
            widest(Rows { terms, readings })
        };
        let whole = of(0..rows);
        // The settling is over in the later strips: a column that rounds to the span of the others.
        let strips: Vec<Triangle> = (0..10).map(|s| of(100 * s..100 * s + 100)).collect();
        let joined = Triangle::joined(&strips.iter().collect::<Vec<_>>(), 3);
        for j in 0..3 {
            for i in 0..=j {
                assert!((joined.r[j][i].abs() - whole.r[j][i].abs()).abs() < 1e-12 * rows as f64);
            }
        }
        let (a, b) = (whole.solve(3).unwrap(), joined.solve(3).unwrap());
        for (a, b) in a.iter().zip(&b) {
            assert!((a - b).amax() < 1e-12, "{a} {b}");
        }
        assert!((a[0].x - 3.0).abs() < 0.1);
    }

    #[test]
    fn dependent_columns_are_refused() {
        let (mut a, mut b) = (vec![1.0, 2.0, 3.0], vec![2.0, 4.0, 6.0]);
        let mut f = [vec![1.0; 3], vec![2.0; 3], vec![3.0; 3]];
        let triangle =
            widest(Rows { terms: &mut [&mut a, &mut b], readings: &mut f.each_mut().map(Vec::as_mut_slice) });
        assert!(triangle.solve(2).is_none());
    }
}
