//! Columns in the readings, and the part of them that no unknown of a fit can follow.

use nalgebra::{DMatrix, DVector, SymmetricEigen, Vector3};

use crate::fit::Gain;
use crate::model::{FitError, MeasurementModel, Observation};
use crate::progress::{OnProgress, advance};

/// A combination of columns is seen when more than this part of its length is redundant.
const REDUNDANT: f64 = 1e-5;

/// A column: the observations where it acts, rising, each with its change [m/s^2] or, whitened, without a unit.
pub(in crate::uncertainty) type Column = Vec<(usize, Vector3<f64>)>;

/// Columns on the plateaus where they act.
pub(in crate::uncertainty) struct Columns {
    /// `Z`: whitened columns, each of unit length.
    z: Vec<Column>,
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
    /// Columns from the changes of observations by one unit of each [m/s^2]. A column without length stays zero.
    pub fn new(gain: &Gain, columns: impl IntoIterator<Item = Column>) -> Self {
        let mut z: Vec<Column> = columns.into_iter().collect();
        let mut lengths = Vec::with_capacity(z.len());
        for column in &mut z {
            for (n, change) in column.iter_mut() {
                *change = gain.whitener(*n).apply(change);
            }
            let length = column.iter().map(|(_, change)| change.norm_squared()).sum::<f64>().sqrt();
            for (_, change) in column.iter_mut().filter(|_| length > 0.0) {
                *change /= length;
            }
            lengths.push(length);
        }
        let (q, e) = (gain.basis(), gain.whitened_residuals());
        let followed = DMatrix::from_fn(q.ncols(), z.len(), |j, c| along(&z[c], q.column(j).as_slice()));
        let along = DVector::from_fn(z.len(), |c, _| along(&z[c], e.as_slice()));
        Self { square: products(&z, &z, |_| 1.0), z, followed, lengths, along }
    }

    /// A column for each rest, which acts there alone: a unit reading along its specific force.
    pub fn along_forces(gain: &Gain, rests: &[Observation]) -> Self {
        Self::new(gain, rests.iter().enumerate().map(|(n, rest)| vec![(n, rest.mean.normalize())]))
    }

    /// Column `c` alone.
    pub fn only(&self, c: usize) -> Self {
        Self {
            z: vec![self.z[c].clone()],
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
        let count = self.z.len();
        DMatrix::identity(count, count) * REDUNDANT.powi(2) + products(&self.z, &self.z, |n| u(n).powi(2))
    }

    /// `s_a^T s_b`.
    pub fn redundancy_with(&self, other: &Self) -> DMatrix<f64> {
        products(&self.z, &other.z, |_| 1.0) - self.followed.tr_mul(&other.followed)
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

/// The columns of `unknowns`, rising, of a model in its state `x`. `progress` is called for each observation.
///
/// # Errors
/// [`FitError`] when the caller stops.
pub(in crate::uncertainty) fn columns_of(
    unknowns: &[usize],
    (model, x): (&MeasurementModel, &[f64]),
    observations: &[Observation],
    progress: OnProgress<()>,
) -> Result<Vec<Column>, FitError> {
    let mut columns = vec![Column::new(); unknowns.len()];
    for (n, observation) in observations.iter().enumerate() {
        advance(progress, ())?;
        let set_point = &model.experiment().set_points[observation.set_point];
        for (index, change) in model.linearise(set_point, x).columns {
            if let Ok(c) = unknowns.binary_search(&index)
                && change.amax() > 0.0
            {
                columns[c].push((n, change));
            }
        }
    }
    Ok(columns)
}

/// `z^T y`.
fn along(z: &[(usize, Vector3<f64>)], y: &[f64]) -> f64 {
    let mut sums = Vector3::zeros();
    for (n, change) in z {
        sums += change.component_mul(&Vector3::from_column_slice(&y[3 * n..3 * n + 3]));
    }
    sums.sum()
}

/// `A^T W B`, where `W` weighs observation `n` with `weight(n)`.
fn products(a: &[Column], b: &[Column], weight: impl Fn(usize) -> f64) -> DMatrix<f64> {
    DMatrix::from_fn(a.len(), b.len(), |i, j| product(&a[i], &b[j], &weight))
}

/// `a^T W b`, over the observations where both columns act.
fn product(a: &[(usize, Vector3<f64>)], b: &[(usize, Vector3<f64>)], weight: impl Fn(usize) -> f64) -> f64 {
    let (mut a, mut b) = (from(a, b), from(b, a));
    let mut sum = 0.0;
    while let ([(n, here), rest_a @ ..], [(m, there), rest_b @ ..]) = (a, b) {
        if n == m {
            sum += weight(*n) * here.dot(there);
        }
        (a, b) = (if n <= m { rest_a } else { a }, if m <= n { rest_b } else { b });
    }
    sum
}

/// A column from the first observation of another on.
fn from<'a>(column: &'a [(usize, Vector3<f64>)], other: &[(usize, Vector3<f64>)]) -> &'a [(usize, Vector3<f64>)] {
    let first = other.first().map_or(0, |(n, _)| *n);
    &column[column.partition_point(|(n, _)| *n < first)..]
}
