//! The square-root information form `R x = b` and its update by Givens rotations.
//!
//! `R` is upper triangular, `R^T R` is the information (inverse covariance) and `R^-1 b` the estimate. An update forms
//! neither a covariance nor an inverse, so there is no symmetry or definiteness to lose. A state that is still unknown
//! is a row of zeros.
//!
//! We use rotations because rows differ greatly in weight. A rotation changes each row by a multiple of the other, of
//! the size of the lighter one. So it preserves the digits of a weak prior beside a strong reading; a reflection would
//! replace them by rounding errors of the strong one.

use nalgebra::{DMatrix, DVector, Vector3};

/// Triangular equations `R x = b` with independent errors of unit variance.
#[derive(Debug, Clone, PartialEq)]
pub struct Factor {
    states: usize,
    /// Row-major, `states` rows of `states + 1`, the last column `b`; zero below the diagonal.
    rows: Vec<f64>,
    /// Three readings on their way through the triangle, as rows like those of `rows`.
    incoming: [Vec<f64>; 3],
    /// Sum of squares of the misfit that the equations could not take up.
    rest: f64,
}

impl Factor {
    /// No information about any of `states` unknowns.
    pub fn new(states: usize) -> Self {
        let width = states + 1;
        Self { states, rows: vec![0.0; states * width], incoming: [(); 3].map(|()| vec![0.0; width]), rest: 0.0 }
    }

    /// Number of unknowns.
    pub fn states(&self) -> usize {
        self.states
    }

    /// Row `j` of `[R b]` from the diagonal on, `states - j + 1` numbers.
    pub fn row(&self, j: usize) -> &[f64] {
        let start = j * (self.states + 1);
        &self.rows[start + j..=start + self.states]
    }

    /// Sum of the squared whitened residuals: chi^2 of the equations so far.
    pub fn rest(&self) -> f64 {
        self.rest
    }

    /// Takes up three whitened readings `sum_j a_j x_j = misfit` given by their non-zero columns (state, `a`), and
    /// returns by how much chi^2 grows. Equations fewer than three are filled up with zeros.
    ///
    /// Exact zeros in front of a row's first entry cost nothing. No memory is allocated.
    ///
    /// # Panics
    /// If a state is not below [`Factor::states`].
    pub fn update(&mut self, columns: &[(usize, Vector3<f64>)], misfit: &Vector3<f64>) -> f64 {
        for (i, row) in self.incoming.iter_mut().enumerate() {
            row.fill(0.0);
            row[self.states] = misfit[i];
            for (state, column) in columns {
                row[*state] = column[i];
            }
        }
        let width = self.states + 1;
        let first = columns.iter().map(|(state, _)| *state).min().unwrap_or(self.states);
        for j in first..self.states {
            rotate(&mut self.rows[j * width + j..(j + 1) * width], &mut self.incoming, j);
        }
        let growth = self.incoming.iter().map(|row| row[self.states].powi(2)).sum();
        self.rest += growth;
        growth
    }

    /// Estimate `R^-1 b` and covariance `R^-1 R^-T`; `None` while a state is not determined.
    ///
    /// Only an exact zero on the diagonal counts: whether rounding stands for one is for the caller to decide.
    pub fn solve(&self) -> Option<(DVector<f64>, DMatrix<f64>)> {
        let n = self.states;
        let mut inverse = DMatrix::identity(n, n);
        if !self.triangle().solve_upper_triangular_mut(&mut inverse) {
            return None;
        }
        Some((&inverse * self.right_side(), &inverse * inverse.transpose()))
    }

    /// `R`.
    pub(crate) fn triangle(&self) -> DMatrix<f64> {
        DMatrix::from_fn(self.states, self.states, |i, j| self.rows[i * (self.states + 1) + j])
    }

    /// `b`.
    pub(crate) fn right_side(&self) -> DVector<f64> {
        DVector::from_fn(self.states, |i, _| self.rows[i * (self.states + 1) + self.states])
    }

    /// The equations of the states from `first` on among `states` of a new order, old state `first + n` being
    /// `slots[n]` there; `slots` rises, so that the triangle stays one.
    pub(crate) fn rearranged(&self, first: usize, slots: &[usize], states: usize) -> Self {
        let mut next = Self::new(states);
        next.rest = self.rest;
        for (i, &slot) in slots.iter().enumerate() {
            let old = self.row(first + i);
            let start = slot * (states + 1);
            for (value, &column) in old.iter().zip(&slots[i..]) {
                next.rows[start + column] = *value;
            }
            next.rows[start + states] = old[old.len() - 1];
        }
        next
    }
}

/// Rotates the leading entries (at `j`) of three rows into the diagonal of `row`, which starts there.
fn rotate(row: &mut [f64], incoming: &mut [Vec<f64>; 3], j: usize) {
    let [u, v, w] = incoming;
    let (u, v, w) = (&mut u[j..], &mut v[j..], &mut w[j..]);
    let (c_u, s_u, diagonal) = rotation(row[0], u[0]);
    let (c_v, s_v, diagonal) = rotation(diagonal, v[0]);
    let (c_w, s_w, _) = rotation(diagonal, w[0]);
    for (((r, u), v), w) in row.iter_mut().zip(u).zip(v).zip(w) {
        (*r, *u) = (c_u * *r + s_u * *u, c_u * *u - s_u * *r);
        (*r, *v) = (c_v * *r + s_v * *v, c_v * *v - s_v * *r);
        (*r, *w) = (c_w * *r + s_w * *w, c_w * *w - s_w * *r);
    }
}

/// Cosine and sine that turn `(r, a)` into `(rho, 0)`, and `rho`, which takes the sign of the larger; no square of
/// either is formed, so none can overflow or vanish.
fn rotation(r: f64, a: f64) -> (f64, f64, f64) {
    if a == 0.0 {
        (1.0, 0.0, r)
    } else if a.abs() > r.abs() {
        let t = r / a;
        let u = (1.0 + t * t).sqrt();
        (t / u, 1.0 / u, a * u)
    } else {
        let t = a / r;
        let u = (1.0 + t * t).sqrt();
        (1.0 / u, t / u, r * u)
    }
}
