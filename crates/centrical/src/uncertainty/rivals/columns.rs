//! Columns in the readings, and the part of them that no unknown of a fit can follow.

use nalgebra::{DMatrix, DVector, SymmetricEigen, Vector3};

use crate::fit::Gain;
use crate::model::Observation;

/// A combination of columns is seen when more than this part of its length is redundant.
const REDUNDANT: f64 = 1e-5;

/// Columns on the plateaus where they act.
pub(in crate::uncertainty) struct Columns {
    /// Observations, rising.
    acting: Vec<usize>,
    /// Whitened columns on these observations, each of unit length.
    z: DMatrix<f64>,
    /// `Z^T Z`.
    square: DMatrix<f64>,
    /// `Q^T Z`.
    pub followed: DMatrix<f64>,
    /// Lengths of the whitened columns.
    pub lengths: Vec<f64>,
    /// `Z^T e`.
    pub along: DVector<f64>,
}

/// A positive semidefinite matrix `s^T s` by its seen eigenvectors.
pub(in crate::uncertainty) struct Seen {
    values: Vec<f64>,
    vectors: DMatrix<f64>,
}

impl Columns {
    /// `count` columns that act on the observations `acting`, rising; `derivative` gives the change of observation `n` by one
    /// unit of column `c` [m/s^2]. A column without length stays zero.
    pub fn new(
        gain: &Gain,
        acting: Vec<usize>,
        count: usize,
        derivative: impl Fn(usize, usize) -> Vector3<f64>,
    ) -> Self {
        let mut z = DMatrix::zeros(3 * acting.len(), count);
        for (place, &n) in acting.iter().enumerate() {
            for c in 0..count {
                z.fixed_view_mut::<3, 1>(3 * place, c).copy_from(&gain.whitener(n).apply(&derivative(n, c)));
            }
        }
        let lengths: Vec<f64> = z.column_iter().map(|column| column.norm()).collect();
        let scaled = z.column_iter_mut().zip(&lengths).filter(|(_, length)| **length > 0.0);
        scaled.for_each(|(mut column, length)| column /= *length);
        let rows: Vec<usize> = acting.iter().flat_map(|n| 3 * n..3 * n + 3).collect();
        let followed = gain.basis().select_rows(&rows).tr_mul(&z);
        let along = z.tr_mul(&gain.whitened_residuals().select_rows(&rows));
        Self { acting, square: z.tr_mul(&z), z, followed, lengths, along }
    }

    /// A column for each rest, which acts there alone: a unit reading along its specific force.
    pub fn along_forces(gain: &Gain, rests: &[Observation]) -> Self {
        let count = rests.len();
        let (mut z, mut followed) = (DMatrix::zeros(3 * count, count), DMatrix::zeros(gain.basis().ncols(), count));
        let mut lengths = Vec::with_capacity(count);
        for (n, mut column) in followed.column_iter_mut().enumerate() {
            let mut whitened = gain.whitener(n).apply(&rests[n].mean.normalize());
            let length = whitened.norm();
            whitened.unscale_mut(if length > 0.0 { length } else { 1.0 });
            z.fixed_view_mut::<3, 1>(3 * n, n).copy_from(&whitened);
            gain.basis().rows(3 * n, 3).tr_mul_to(&whitened, &mut column);
            lengths.push(length);
        }
        let along = z.tr_mul(&gain.whitened_residuals());
        let square = DMatrix::from_diagonal(&DVector::from_fn(count, |n, _| z.column(n).norm_squared()));
        Self { acting: (0..count).collect(), z, square, followed, lengths, along }
    }

    /// Column `c` alone.
    pub fn only(&self, c: usize) -> Self {
        Self {
            acting: self.acting.clone(),
            z: self.z.columns(c, 1).into_owned(),
            square: self.square.view((c, c), (1, 1)).into_owned(),
            followed: self.followed.columns(c, 1).into_owned(),
            lengths: vec![self.lengths[c]],
            along: self.along.rows(c, 1).into_owned(),
        }
    }

    /// `s^T s = Z^T Z - (Q^T Z)^T Q^T Z`.
    pub fn redundancy(&self) -> DMatrix<f64> {
        &self.square - self.followed.tr_mul(&self.followed)
    }

    /// The trace of `s^T s`: expectation of the squared length of `Z^T e`.
    pub fn redundant_length(&self) -> f64 {
        self.square.trace() - self.followed.norm_squared()
    }

    /// The square `s^T s` above which a combination is seen: [`REDUNDANT`] squared, and what the uncertainty of attitudes makes. A
    /// turn of observation `n` by its standard uncertainty `u_n` [rad] changes its rows by up to that part: such a rest of a column
    /// follows the noise, and so would its test.
    pub fn least(&self, u: impl Fn(usize) -> f64) -> DMatrix<f64> {
        let mut least = DMatrix::identity(self.z.ncols(), self.z.ncols()) * REDUNDANT.powi(2);
        for (place, n) in self.acting.iter().enumerate() {
            let rows = self.z.rows(3 * place, 3);
            least += rows.tr_mul(&rows) * u(*n).powi(2);
        }
        least
    }

    /// `s_a^T s_b`.
    pub fn redundancy_with(&self, other: &Self) -> DMatrix<f64> {
        let mut product = DMatrix::zeros(self.z.ncols(), other.z.ncols());
        let mut there = 0;
        for (here, n) in self.acting.iter().enumerate() {
            there += other.acting[there..].partition_point(|m| m < n);
            if other.acting.get(there) == Some(n) {
                product += self.z.rows(3 * here, 3).tr_mul(&other.z.rows(3 * there, 3));
            }
        }
        product - self.followed.tr_mul(&other.followed)
    }

    /// `s^T s` and `s^T e` with what `other`, whose `(s^T s)^+` is `inverse`, explains taken off both.
    pub fn beside(&self, other: &Self, inverse: &DMatrix<f64>) -> (DMatrix<f64>, DVector<f64>) {
        let across = self.redundancy_with(other);
        let explained = &across * inverse;
        (self.redundancy() - &explained * across.transpose(), &self.along - &explained * &other.along)
    }
}

impl Seen {
    /// What of `s^T s` is above the square `least`.
    pub fn of(square: DMatrix<f64>, least: &DMatrix<f64>) -> Self {
        let eigen = SymmetricEigen::new(square);
        let is_seen = |k: &usize| {
            let direction = eigen.eigenvectors.column(*k);
            eigen.eigenvalues[*k] > direction.dot(&(least * direction))
        };
        let seen: Vec<usize> = (0..eigen.eigenvalues.len()).filter(is_seen).collect();
        let values = seen.iter().map(|&k| eigen.eigenvalues[k]).collect();
        Self { values, vectors: eigen.eigenvectors.select_columns(&seen) }
    }

    pub fn rank(&self) -> usize {
        self.values.len()
    }

    /// `t^T S^+ t`.
    pub fn statistic(&self, t: &DVector<f64>) -> f64 {
        self.vectors.tr_mul(t).iter().zip(&self.values).map(|(component, value)| component * component / value).sum()
    }

    /// The part of `t` outside the directions whose square is above `least`.
    pub fn beyond(&self, t: &DVector<f64>, least: f64) -> DVector<f64> {
        let mut rest = t.clone();
        for (direction, _) in self.vectors.column_iter().zip(&self.values).filter(|(_, value)| **value > least) {
            rest.axpy(-direction.dot(t), &direction, 1.0);
        }
        rest
    }

    /// `S^+`.
    pub fn inverse(&self) -> DMatrix<f64> {
        let mut root = self.vectors.clone();
        root.column_iter_mut().zip(&self.values).for_each(|(mut column, value)| column /= value.sqrt());
        &root * root.transpose()
    }
}
