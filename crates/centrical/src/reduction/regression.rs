//! Least squares by orthogonal columns, for tall designs of few columns.

use nalgebra::Vector3;

pub(super) use super::lanes::product as dot;

/// `X = Q R`: columns orthonormalised one after another (modified Gram-Schmidt), the constant last.
#[derive(Debug, Clone)]
pub(super) struct Regression {
    /// Orthonormal columns.
    pub q: Vec<Vec<f64>>,
    /// Upper triangle: `r[j][i]`, i <= j, so that `x_j = sum_i q_i r[j][i]`.
    pub r: Vec<Vec<f64>>,
}

impl Regression {
    /// Orthonormalises the columns `x`. `None` if one of them hangs on the others to within `1e-6` of its length.
    pub fn new(mut x: Vec<Vec<f64>>) -> Option<Self> {
        // Half the digits of f64: below this a column is rounding.
        const DEPENDENT: f64 = 1e-6;
        let mut r = Vec::with_capacity(x.len());
        for j in 0..x.len() {
            let (done, rest) = x.split_at_mut(j);
            let column = &mut rest[0];
            let length = norm(column);
            let mut row = Vec::with_capacity(j + 1);
            for q in done.iter() {
                let projection = dot(q, column);
                column.iter_mut().zip(q).for_each(|(c, q)| *c -= projection * q);
                row.push(projection);
            }
            let left = norm(column);
            if left.is_nan() || left <= DEPENDENT * length {
                return None;
            }
            for c in column.iter_mut() {
                *c /= left;
            }
            row.push(left);
            r.push(row);
        }
        Some(Self { q: x, r })
    }

    /// Coefficients of `y` by the columns `x`, per axis.
    pub fn solve(&self, y: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let mut b: Vec<Vector3<f64>> = self.q.iter().map(|q| q.iter().zip(y).map(|(q, y)| y * *q).sum()).collect();
        for j in (0..b.len()).rev() {
            b[j] /= self.r[j][j];
            for i in 0..j {
                let known = b[j] * self.r[j][i];
                b[i] -= known;
            }
        }
        b
    }
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}
