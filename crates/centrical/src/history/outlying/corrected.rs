//! The errors of sessions as neighbouring sessions show them.
//!
//! Session `t` states errors of covariance `C_t = L_t L_t^T`. Its differences from its neighbours correct them in one of two forms:
//!
//! - beside, `C_t + T`: sessions differ by more than they state, as by what a switch-on changes;
//! - in proportion, `L_t W L_t^T`: they state too much or too little, or correlations that their errors do not have.
//!
//! `W` is the covariance of the differences in units of what is stated, shrunk towards independent ones. The more likely form is taken. For
//! that, a difference beyond the farthest of sound ones counts by its distance in place of the square (P. Huber, Ann. Math. Statist. 35,
//! 1964): a bad session does not decide, nor is a form likely that gives up many.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rayon::prelude::*;

use super::component::{Component, Known};
use super::rows::{Rows, add_scaled};
use crate::uncertainty::Estimates;

/// The sessions of units of one type.
pub struct UnitSessions<'a> {
    /// Number of sessions of each unit, one or more.
    pub counts: &'a [usize],
    /// Session `t` of a unit, in the order of time: `p` values and the covariance of their errors as it states them, made when it is asked for.
    pub session: &'a (dyn Fn(usize, usize) -> Estimates + Sync),
}

/// Fewer differences say nothing.
const FEWEST_DIFFERENCES: usize = 10;

/// As many differences, evenly taken, know a variance to 2 %.
const MOST_DIFFERENCES: usize = 5000;

/// What differences of sessions correct.
#[derive(Debug, Clone)]
pub enum Corrected {
    /// Nothing: there are too few, or they do not differ.
    AsStated,
    /// By `T`.
    Beside(DMatrix<f64>),
    /// By a root of `W`.
    InProportion(DMatrix<f64>),
}

impl Corrected {
    /// By the `sessions` of units, of `p` values.
    pub fn of(sessions: &UnitSessions, p: usize) -> Self {
        let pairs_of = |(unit, count): (usize, &usize)| (1..*count).map(move |t| (unit, t));
        let all: Vec<(usize, usize)> = sessions.counts.iter().enumerate().flat_map(pairs_of).collect();
        let pairs: Vec<(usize, usize)> =
            all.iter().step_by(all.len().div_ceil(MOST_DIFFERENCES).max(1)).copied().collect();
        if pairs.len() < FEWEST_DIFFERENCES {
            return Self::AsStated;
        }
        let differences = Differences { sessions, pairs: &pairs, p };
        match (differences.beside(), differences.in_proportion()) {
            (Some((_, unlikely)), Some((root, less))) if less < unlikely && have_factors(sessions) => {
                Self::InProportion(root)
            }
            (Some((beside, _)), _) => Self::Beside(beside),
            (None, _) => Self::AsStated,
        }
    }

    /// Adds the covariance of the errors of a session, times a weight, to a sum; not a number where a factor is missing.
    pub fn add_errors(&self, session: &Estimates, weight: f64, sum: &mut DMatrix<f64>) {
        match self {
            Self::AsStated => add_scaled(&session.covariance, weight, sum),
            Self::Beside(beside) => {
                add_scaled(&session.covariance, weight, sum);
                add_scaled(beside, weight, sum);
            }
            Self::InProportion(root) => match session.covariance.clone().cholesky() {
                Some(factor) => {
                    let root = factor.unpack() * root;
                    sum.gemm(weight, &root, &root.transpose(), 1.0);
                }
                None => sum.fill(f64::NAN),
            },
        }
    }
}

/// Whether all stated covariances are positive definite.
fn have_factors(sessions: &UnitSessions) -> bool {
    let has_factor = |unit: usize, t: usize| (sessions.session)(unit, t).covariance.cholesky().is_some();
    sessions.counts.par_iter().enumerate().all(|(unit, count)| (0..*count).all(|t| has_factor(unit, t)))
}

/// The differences of neighbouring sessions.
struct Differences<'a> {
    sessions: &'a UnitSessions<'a>,
    /// Units, and the numbers of the later sessions.
    pairs: &'a [(usize, usize)],
    p: usize,
}

impl Differences<'_> {
    /// A difference and the covariance that both sessions state for it.
    fn of_pair(&self, pair: usize) -> (DVector<f64>, DMatrix<f64>) {
        let (unit, t) = self.pairs[pair];
        let [before, after] = [t - 1, t].map(|t| (self.sessions.session)(unit, t));
        (after.values - before.values, after.covariance + before.covariance)
    }

    /// `T`, and twice the negative logarithm of the likelihood.
    fn beside(&self) -> Option<(DMatrix<f64>, f64)> {
        let mut values = DMatrix::zeros(self.pairs.len(), self.p);
        let mut variances = values.clone();
        for pair in 0..self.pairs.len() {
            let (difference, stated) = self.of_pair(pair);
            values.set_row(pair, &difference.transpose());
            variances.set_row(pair, &stated.diagonal().transpose());
        }
        let add_errors =
            |pair: usize, weight: f64, sum: &mut DMatrix<f64>| add_scaled(&self.of_pair(pair).1, weight, sum);
        let (of_difference, unlikely) = scatter(&Rows { values, variances, add_errors: &add_errors })?;
        Some((of_difference * 0.5, unlikely))
    }

    /// A root of `W`, and the same of the likelihood.
    fn in_proportion(&self) -> Option<(DMatrix<f64>, f64)> {
        let mut values = DMatrix::zeros(self.pairs.len(), self.p);
        let mut of_units = 0.0;
        for pair in 0..self.pairs.len() {
            let (mut difference, stated) = self.of_pair(pair);
            let factor: Cholesky<f64, Dyn> = stated.cholesky()?;
            factor.l_dirty().solve_lower_triangular_mut(&mut difference);
            values.set_row(pair, &difference.transpose());
            of_units += factor.ln_determinant();
        }
        let no_errors = |_: usize, _: f64, _: &mut DMatrix<f64>| ();
        let variances = DMatrix::zeros(self.pairs.len(), self.p);
        let (in_proportion, unlikely) = scatter(&Rows { values, variances, add_errors: &no_errors })?;
        Some((in_proportion.cholesky()?.unpack(), of_units + unlikely))
    }
}

/// What `rows` scatter by beside their errors, and twice the negative logarithm of the likelihood.
fn scatter(rows: &Rows) -> Option<(DMatrix<f64>, f64)> {
    let known = Known::of(rows.values.nrows(), rows.values.ncols())?;
    let found = Component::of(rows, &known)?;
    let bounded = |square: f64| {
        if square <= known.farthest { square } else { 2.0 * (known.farthest * square).sqrt() - known.farthest }
    };
    let terms = rows.likelihoods(&found.centre, &found.between)?;
    let unlikely = terms.iter().map(|(square, log_det)| bounded(*square) + log_det).sum();
    Some((found.between, unlikely))
}
