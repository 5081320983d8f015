//! Rank and null space of a weighted design, and the uncertainties by its weights.

use std::sync::OnceLock;

use nalgebra::{DMatrix, DVector, RowDVector, SVD};

use super::combination::Combination;
use super::correlation::{self, CorrelatedGroup};
use super::direction::{self, NullDirection, TAKES_PART};
use crate::linalg::least_squares::{Elimination, Own};

/// A singular value within this factor of the tolerance makes the rank doubtful.
const DOUBTFUL: f64 = 100.0;

/// A null vector of unit length is known to this over the smallest relative singular value that counts: some thousand
/// roundings, spread by the gap that separates it from what is seen.
const NULL_ROUNDING: f64 = 1e3 * f64::EPSILON;

/// Observability of a design with `n` rows and `p` unknowns.
///
/// The attitude of a single rest is determined where all else is: it is eliminated, and the singular values are those of the other
/// unknowns.
#[derive(Debug, Clone)]
pub struct Observability {
    singular_values: Vec<f64>,
    /// Number of singular values that count.
    seen: usize,
    /// Right singular vectors of the scaled design as columns, in the order of the singular values, with the part of the eliminated
    /// unknowns that follows them. Then columns of a root of the covariance: what else the eliminated unknowns are uncertain by.
    vectors: DMatrix<f64>,
    /// Lengths of the columns of the design; 1 for a column of zeros.
    norms: DVector<f64>,
    /// Made when first asked for: most designs that are tried for a remedy never are.
    null_directions: OnceLock<Vec<NullDirection>>,
    /// Components of null vectors below this are rounding.
    rounding: f64,
}

/// Two are equal when they see the same; whether null directions have been asked for does not count.
impl PartialEq for Observability {
    fn eq(&self, other: &Self) -> bool {
        (&self.singular_values, &self.vectors, &self.norms) == (&other.singular_values, &other.vectors, &other.norms)
    }
}

impl Observability {
    /// Singular values below this part of the largest count as zero.
    ///
    /// Rounding in forming and decomposing a design of some thousand rows leaves zero singular values at about
    /// `1e-16` to `1e-14`; the smallest genuine ones of the field's experiments are at `1e-5` (one speed,
    /// docs/source-and-findings.md). The tolerance stands in the middle between `1e-15` and `1e-5`.
    pub const RANK_TOLERANCE: f64 = 1e-10;

    /// Analyses a weighted design matrix (`n x (p + q)`, any `n`, all entries finite) of `p` unknowns and `influences`, whose own equations
    /// stand last; `own` are unknowns of few equations.
    pub(crate) fn of(rows: DMatrix<f64>, own: &[Own], influences: usize) -> Self {
        let lengths = column_norms(&rows);
        let (own, rows) = Elimination::of(rows, own);
        let (unknowns, equations) = (rows.ncols() - influences, rows.nrows());
        let of_all = Own { columns: (unknowns..unknowns + influences).collect(), rows: (0..equations).collect() };
        let (stated, left) = Elimination::of(rows, &[of_all]);
        // What an elimination leaves of a column may be rounding, which the length of the whole column tells from a reading.
        let norms = if own.columns() > 0 { lengths.select_rows(&own.left()[..unknowns]) } else { column_norms(&left) };
        let mut all = Self::left_of(left, norms);
        if own.columns() > 0 {
            all.complete(&own, &stated, &lengths);
        }
        all
    }

    /// Analyses the equations that an elimination leaves of a design whose columns have these lengths, 1 for a column of zeros.
    pub(crate) fn left_of(mut rows: DMatrix<f64>, norms: DVector<f64>) -> Self {
        for (mut column, norm) in rows.column_iter_mut().zip(norms.iter()) {
            column /= *norm;
        }
        let (singular_values, vectors) = decompose(rows);
        let tolerance = Observability::RANK_TOLERANCE * singular_values.first().copied().unwrap_or(0.0);
        let seen = singular_values.iter().filter(|&&s| s > tolerance).count();
        let gap = if seen > 0 { singular_values[seen - 1] / singular_values[0] } else { 1.0 };
        let rounding = (NULL_ROUNDING / gap).min(TAKES_PART);
        Self { singular_values, seen, vectors, norms, null_directions: OnceLock::new(), rounding }
    }

    /// Takes up the eliminated unknowns, whose columns have these `lengths`.
    fn complete(&mut self, own: &Elimination, stated: &Elimination, lengths: &DVector<f64>) {
        let (c, q, m) = (self.singular_values.len(), stated.columns(), own.columns());
        let mut vectors = self.vectors.clone().resize_horizontally(c + q + m, 0.0);
        vectors.row_iter_mut().zip(self.norms.iter()).for_each(|(mut row, norm)| row /= *norm);
        let unit = |count: usize, first: usize| {
            let mut u = DMatrix::zeros(count, c + q + m);
            u.columns_mut(first, count).fill_with_identity();
            u
        };
        let vectors = own.completed(&unit(m, c + q), stated.completed(&unit(q, c), vectors));
        self.vectors = vectors.rows(0, c + m).into_owned();
        self.norms = lengths.rows(0, c + m).into_owned();
        self.vectors.row_iter_mut().zip(self.norms.iter()).for_each(|(mut row, norm)| row *= *norm);
        let null = self.vectors.columns(self.seen, self.lost()).into_owned();
        if self.lost() > 0 {
            self.vectors.columns_mut(self.seen, self.lost()).copy_from(&null.qr().q());
        }
    }

    /// Singular values of the column-scaled design, falling; as many as there are unknowns that are not eliminated.
    pub fn singular_values(&self) -> &[f64] {
        &self.singular_values
    }

    /// Number of singular values above [`Observability::RANK_TOLERANCE`] times the largest, and of unknowns that are eliminated.
    pub fn rank(&self) -> usize {
        self.columns() - self.lost()
    }

    /// Number of unknowns.
    pub fn columns(&self) -> usize {
        self.norms.len()
    }

    /// Number of lost combinations, `p - rank`.
    pub fn lost(&self) -> usize {
        self.singular_values.len() - self.seen
    }

    /// Whether a singular value lies within two decades of the tolerance, on either side: the rank is then a
    /// matter of rounding and must not be relied on.
    pub fn is_doubtful(&self) -> bool {
        let tolerance = Observability::RANK_TOLERANCE * self.singular_values.first().copied().unwrap_or(0.0);
        self.singular_values.iter().any(|&s| s > tolerance / DOUBTFUL && s < tolerance * DOUBTFUL)
    }

    /// Smallest singular value that counts over the largest; `None` when nothing is seen.
    pub fn smallest_relative(&self) -> Option<f64> {
        Some(self.singular_values.get(self.seen.checked_sub(1)?)? / self.singular_values[0])
    }

    /// Condition number of the part of the scaled design that is seen: the largest singular value over the
    /// smallest that counts. `None` when nothing is seen.
    pub fn condition_number(&self) -> Option<f64> {
        self.smallest_relative().map(f64::recip)
    }

    /// The lost combinations in their simplest form, `p - rank` of them.
    pub fn null_directions(&self) -> &[NullDirection] {
        self.null_directions.get_or_init(|| {
            let basis = self.vectors.columns(self.seen, self.lost()).into_owned();
            direction::simplest(&basis, &self.norms, self.rounding)
        })
    }

    /// Whether the data determine unknown `j`: it takes part in no null direction.
    pub fn is_estimable(&self, j: usize) -> bool {
        !self.takes_part(self.null_row(j).norm())
    }

    /// Whether the data determine the linear combination: it does not change along any null direction.
    pub fn sees(&self, combination: &Combination) -> bool {
        let mut along = RowDVector::zeros(self.lost());
        let mut size = 0.0;
        for &(j, coefficient) in combination.terms().iter().filter(|(j, _)| !self.is_estimable(*j)) {
            let change = self.null_row(j) * (coefficient / self.norms[j]);
            size += change.norm();
            along += change;
        }
        along.norm() <= TAKES_PART * size
    }

    /// Standard uncertainty of a linear combination by the weights of the design, if the data determine it.
    pub fn standard_uncertainty(&self, combination: &Combination) -> Option<f64> {
        if !self.sees(combination) {
            return None;
        }
        let mut scaled = DVector::zeros(self.columns());
        for &(j, coefficient) in combination.terms() {
            scaled[j] += coefficient / self.norms[j];
        }
        Some((self.root().transpose() * scaled).norm())
    }

    /// Groups of estimable parameters that the data hardly separate: see [`CorrelatedGroup`].
    pub fn correlated_groups(&self) -> Vec<CorrelatedGroup> {
        correlation::groups(&self.covariance_scaled(), |j| self.is_estimable(j))
    }

    /// Whether a component of a null vector, in scaled columns, is one.
    pub(crate) fn takes_part(&self, component: f64) -> bool {
        component > self.rounding
    }

    /// A basis of the null space in physical units, `p x (p - rank)`; its scale is arbitrary.
    pub(crate) fn null_basis(&self) -> DMatrix<f64> {
        let mut basis = self.vectors.columns(self.seen, self.lost()).into_owned();
        basis.row_iter_mut().zip(self.norms.iter()).for_each(|(mut row, norm)| row /= *norm);
        basis
    }

    /// Covariance of the unknowns `i` and `j` by the weights of the design; of meaning for estimable ones.
    pub(crate) fn covariance(&self, i: usize, j: usize) -> f64 {
        let product = |k: usize| self.vectors[(i, k)] * self.vectors[(j, k)];
        let squares = self.singular_values[..self.seen].iter().map(|s| s * s).enumerate();
        let others = (self.singular_values.len()..self.vectors.ncols()).map(|k| (k, 1.0));
        squares.chain(others).map(|(k, square)| product(k) / square).sum::<f64>() / (self.norms[i] * self.norms[j])
    }

    /// Covariance in scaled columns.
    fn covariance_scaled(&self) -> DMatrix<f64> {
        let root = self.root();
        &root * root.transpose()
    }

    /// A root of the covariance in scaled columns: `V S^-1`, and what else the eliminated unknowns are uncertain by.
    fn root(&self) -> DMatrix<f64> {
        let mut root = self.vectors.clone().remove_columns(self.seen, self.lost());
        root.column_iter_mut().zip(&self.singular_values[..self.seen]).for_each(|(mut column, s)| column /= *s);
        root
    }

    /// Components of unknown `j` in the null space, scaled columns.
    fn null_row(&self, j: usize) -> RowDVector<f64> {
        self.vectors.row(j).columns(self.seen, self.lost()).into_owned()
    }
}

/// Length of each column; 1 for a column of zeros, which stays one.
fn column_norms(rows: &DMatrix<f64>) -> DVector<f64> {
    let norm = |column: nalgebra::DVectorView<'_, f64>| Some(column.norm()).filter(|n| *n > 0.0).unwrap_or(1.0);
    DVector::from_iterator(rows.ncols(), rows.column_iter().map(norm))
}

/// Singular values, falling, and right singular vectors as columns, `p` of each.
fn decompose(scaled: DMatrix<f64>) -> (Vec<f64>, DMatrix<f64>) {
    let columns = scaled.ncols();
    let square = if scaled.nrows() > columns { scaled.qr().r() } else { scaled.resize_vertically(columns, 0.0) };
    let svd = SVD::new(square, false, true);
    let vectors = svd.v_t.map_or_else(|| DMatrix::identity(columns, columns), |v_t| v_t.transpose());
    (svd.singular_values.as_slice().to_vec(), vectors)
}
